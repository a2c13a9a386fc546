#include "studies/report/model/verdicts.h"

#include <fmt/format.h>

#include <string_view>

#include "sim/joined.h"
#include "studies/tables/text_units.h"

namespace marti::studies::report {

std::vector<std::string> verdict_sentences(const tables::Table& table) {
  const bool claims = table.name() == "claims";
  const auto text = [&](std::size_t row, std::string_view column) {
    const auto* found = std::get_if<std::string>(&table.at(row, column));
    return found == nullptr ? std::string("-") : *found;
  };
  std::size_t holding = 0;
  std::vector<std::string> not_measured;
  std::vector<std::string> others;
  std::vector<std::string> sentences;
  for (std::size_t row = 0; row < table.rows().size(); ++row) {
    const std::string verdict = text(row, "verdict");
    const std::string subject = text(row, claims ? "subject" : "case");
    if (verdict == "agrees" || verdict == "pass") {
      ++holding;
    } else if (verdict == "not measured") {
      not_measured.push_back(subject);
    } else {
      others.push_back(fmt::format("{}: {} ({}).", subject, text(row, claims ? "here" : "figure"), verdict));
    }
  }
  if (const std::size_t measured = holding + others.size(); measured > 0) {
    const bool one = holding == 1 || measured == 1;
    sentences.push_back(fmt::format("{} of {} {}{}", holding,
                                    tables::counted(measured, claims ? "statement" : "case"),
                                    claims ? (one ? "is reproduced" : "are reproduced")
                                    : one  ? "passes"
                                           : "pass",
                                    others.empty()       ? "."
                                    : others.size() == 1 ? "; the other:"
                                                         : "; the others:"));
  }
  sentences.insert(sentences.end(), others.begin(), others.end());
  if (!not_measured.empty()) {
    sentences.push_back("Not measured here: " + sim::joined(not_measured, "; ") + ".");
  }
  return sentences;
}

}  // namespace marti::studies::report
