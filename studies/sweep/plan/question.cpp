#include "studies/sweep/plan/question.h"

#include <algorithm>
#include <functional>
#include <span>
#include <string_view>

#include "sim/config_errors.h"
#include "studies/sweep/plan/table_texts.h"
#include "studies/tables/table.h"

namespace marti::studies::sweep {

namespace {

using sim::DocumentEntry;
using sim::DocumentValue;

class QuestionReader {
 public:
  explicit QuestionReader(const sim::Config& config) : config_(config) {}

  Question read() const {
    Question question;
    const DocumentValue::Table& section = config_.free_section("question");
    if (section.empty() && config_.free_section_line("question") == 0) {
      return question;
    }
    for (const DocumentEntry& entry : section) {
      if (entry.name == "table") {
        for_each(entry, [&](const DocumentValue& value) {
          const QuestionTable table = table_of(value);
          if (std::ranges::find(question.tables, table.name, &QuestionTable::name) != question.tables.end()) {
            fail(value.line, "question.table.name", "is that of another table, " + table.name);
          }
          question.tables.push_back(table);
        });
      } else if (entry.name == "claim") {
        for_each(entry, [&](const DocumentValue& value) { question.claims.push_back(claim_of(value)); });
      }
    }
    constexpr std::string_view lists[] = {"table", "claim"};
    const TableTexts texts(config_, section, config_.free_section_line("question"), "question",
                           {"asks", "answer"}, lists);
    question.asks = texts.line("asks");
    question.answer = query(texts, "answer");
    return question;
  }

 private:
  [[noreturn]] void fail(int line, std::string_view key, const std::string& message) const {
    sim::fail_at(config_, line, key, message);
  }

  void for_each(const DocumentEntry& entry, const std::function<void(const DocumentValue&)>& visit) const {
    const DocumentValue::List* const list = entry.value.list();
    if (list == nullptr ||
        std::ranges::any_of(*list, [](const DocumentValue& each) { return each.table() == nullptr; })) {
      fail(entry.line, "question." + entry.name,
           "must be tables, each under [[question." + entry.name + "]]");
    }
    std::ranges::for_each(*list, visit);
  }

  [[nodiscard]] QuestionTable table_of(const DocumentValue& value) const {
    const TableTexts texts(config_, *value.table(), value.line, "question.table", {"name", "title", "sql"});
    const std::string& name = texts.line("name");
    if (!tables::is_plain_name(name)) {
      texts.fail("name", "must be of lower-case letters, digits and '_'");
    }
    return {name, texts.line("title"), query(texts, "sql")};
  }

  [[nodiscard]] QuestionClaim claim_of(const DocumentValue& value) const {
    const TableTexts texts(config_, *value.table(), value.line, "question.claim",
                           {"subject", "says", "here", "agrees"});
    return {texts.line("subject"), texts.line("says"), query(texts, "here"), query(texts, "agrees")};
  }

  static Query query(const TableTexts& texts, std::string_view key) {
    return {texts.text(key), texts.place(key)};
  }

  const sim::Config& config_;
};

}  // namespace

Question read_question(const sim::Config& config) { return QuestionReader(config).read(); }

}  // namespace marti::studies::sweep
