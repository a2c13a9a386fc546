#include "studies/keys/combination_table.h"

#include "processors/machine/combinations.h"

namespace marti::studies::keys {

namespace {

using processors::machine::Feature;
using processors::machine::feature_texts;
using processors::machine::features;
using processors::machine::RefusedPair;

std::string name_of(Feature feature) {
  return std::string(feature_texts[static_cast<std::size_t>(feature)].name);
}

// "yes", or the number of the pair that is refused, from 1.
std::string cell_of(Feature one, Feature other) {
  const auto pairs = processors::machine::refused_pairs();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const RefusedPair& pair = pairs[i];
    if ((pair.first == one && pair.second == other) || (pair.first == other && pair.second == one)) {
      return (pair.setting.empty() ? "no: " : "in part: ") + std::to_string(i + 1);
    }
  }
  return "yes";
}

}  // namespace

std::string combinations_as_markdown() {
  std::string text =
      "\n## What combines\n\nWhich features of a machine may be had together: yes, no, or in part, for the "
      "reason of that number. What is not\nnamed here combines with everything, except where a key says "
      "otherwise.\n\n| feature | asked for by |";
  std::string rule = "|---|---|";
  for (std::size_t column = 1; column < features; ++column) {
    text += " " + name_of(static_cast<Feature>(column)) + " |";
    rule += "---|";
  }
  text += "\n" + rule + "\n";
  for (std::size_t row = 0; row < features; ++row) {
    text +=
        "| " + name_of(static_cast<Feature>(row)) + " | " + std::string(feature_texts[row].setting) + " |";
    for (std::size_t column = 1; column < features; ++column) {
      text += column <= row ? "  |"
                            : " " + cell_of(static_cast<Feature>(row), static_cast<Feature>(column)) + " |";
    }
    text += "\n";
  }
  text += "\n";
  std::size_t number = 0;
  for (const RefusedPair& pair : processors::machine::refused_pairs()) {
    text += std::to_string(++number) + ". " + name_of(pair.first) +
            (pair.setting.empty() ? "" : " (only " + std::string(pair.setting) + ")") + ", " +
            name_of(pair.second) + ": " + std::string(pair.reason) + ".\n";
  }
  return text;
}

}  // namespace marti::studies::keys
