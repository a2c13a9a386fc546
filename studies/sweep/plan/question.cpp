#include "studies/sweep/plan/question.h"

#include <algorithm>
#include <functional>
#include <span>
#include <string_view>

#include "sim/config_errors.h"
#include "sim/nearest.h"
#include "studies/tables/table.h"

namespace marti::studies::sweep {

namespace {

using sim::DocumentEntry;
using sim::DocumentValue;

constexpr std::size_t longest_line = 200;

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
    const Texts texts(*this, section, config_.free_section_line("question"), "question", {"asks", "answer"},
                      lists);
    question.asks = texts.line("asks");
    question.answer = texts.query("answer");
    return question;
  }

 private:
  // The texts of a table that has these keys, and perhaps `others`, and no more.
  class Texts {
   public:
    Texts(const QuestionReader& reader, const DocumentValue::Table& table, int line, std::string place,
          std::vector<std::string> keys, std::span<const std::string_view> others = {})
        : reader_(reader), table_(table), line_(std::max(1, line)), place_(std::move(place)) {
      for (const DocumentEntry& entry : table) {
        if (std::ranges::find(keys, entry.name) == keys.end() &&
            std::ranges::find(others, entry.name) == others.end()) {
          reader_.fail(entry.line, place_ + "." + entry.name,
                       "unknown key" + sim::did_you_mean(entry.name, keys));
        }
      }
    }

    [[nodiscard]] std::string line(std::string_view key) const {
      const DocumentEntry& entry = given(key);
      const std::string& text = *entry.value.text();
      const bool plain = std::ranges::none_of(
          text, [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; });
      if (text.empty() || text.size() > longest_line || !plain) {
        reader_.fail(entry.line, name(key),
                     "must be a line of 1 to " + std::to_string(longest_line) + " characters");
      }
      return text;
    }

    [[nodiscard]] std::string plain_name(std::string_view key) const {
      std::string text = line(key);
      if (!tables::is_plain_name(text)) {
        reader_.fail(given(key).line, name(key), "must be of lower-case letters, digits and '_'");
      }
      return text;
    }

    [[nodiscard]] Query query(std::string_view key) const {
      const DocumentEntry& entry = given(key);
      return {*entry.value.text(), sim::place_in_file(reader_.config_.name(), entry.line, name(key))};
    }

   private:
    [[nodiscard]] std::string name(std::string_view key) const { return place_ + "." + std::string(key); }

    [[nodiscard]] const DocumentEntry& given(std::string_view key) const {
      const DocumentEntry* const entry = sim::find(table_, key);
      if (entry == nullptr) {
        reader_.fail(line_, name(key), "is missing");
      }
      if (entry->value.text() == nullptr || entry->value.text()->empty()) {
        reader_.fail(entry->line, name(key), "must be a text, not " + describe(entry->value));
      }
      return *entry;
    }

    const QuestionReader& reader_;
    const DocumentValue::Table& table_;
    int line_;
    std::string place_;
  };

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
    const Texts texts(*this, *value.table(), value.line, "question.table", {"name", "title", "sql"});
    return {texts.plain_name("name"), texts.line("title"), texts.query("sql")};
  }

  [[nodiscard]] QuestionClaim claim_of(const DocumentValue& value) const {
    const Texts texts(*this, *value.table(), value.line, "question.claim",
                      {"subject", "says", "here", "agrees"});
    return {texts.line("subject"), texts.line("says"), texts.query("here"), texts.query("agrees")};
  }

  const sim::Config& config_;
};

}  // namespace

Question read_question(const sim::Config& config) { return QuestionReader(config).read(); }

}  // namespace marti::studies::sweep
