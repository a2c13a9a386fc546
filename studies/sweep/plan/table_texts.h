// The texts of a table in a free section of a configuration, which this program reads itself.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/config.h"
#include "sim/error.h"

namespace marti::studies::sweep {

/// A table that may have these keys, and `others`, and no more. What throws, throws a UserError with file,
/// line and key. What it is made of must outlive it.
class TableTexts {
 public:
  /// `place`: the table's name, "question.table"; `line`: where it begins.
  TableTexts(const sim::Config& config, const sim::DocumentValue::Table& table, int line, std::string place,
             const std::vector<std::string>& keys, std::span<const std::string_view> others = {});

  /// A text that is not empty. The second: empty if there is no such key.
  [[nodiscard]] const std::string& text(std::string_view key) const;
  [[nodiscard]] std::string text_or_none(std::string_view key) const;
  /// A text of 1 to 200 characters in one line.
  [[nodiscard]] const std::string& line(std::string_view key) const;
  /// The key's entry, with a value of any type. Throws if the table has no such key.
  [[nodiscard]] const sim::DocumentEntry& entry(std::string_view key) const;
  /// Where the key's value is.
  [[nodiscard]] sim::Place place(std::string_view key) const;

  /// Throws for the key's value, or for the table where it has none.
  [[noreturn]] void fail(std::string_view key, const std::string& message) const;
  /// Throws for the table as a whole.
  [[noreturn]] void fail(const std::string& message) const;

 private:
  const sim::Config& config_;
  const sim::DocumentValue::Table& table_;
  int line_;
  std::string place_;
};

}  // namespace marti::studies::sweep
