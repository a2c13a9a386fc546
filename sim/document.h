// A part of a TOML file as it was written, with the line of each value: the content of a free section of a
// schema (sim/schema.h), and the source of a key's values.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace marti::sim {

struct DocumentEntry;

/// One value. In a free section there are no dates and times, and reals are finite.
struct DocumentValue {
  using List = std::vector<DocumentValue>;
  using Table = std::vector<DocumentEntry>;
  /// std::monostate: a date or time.
  using Content = std::variant<std::monostate, bool, std::int64_t, double, std::string, List, Table>;

  Content content;
  int line = 0;  ///< in the file, from 1; 0 if it comes from no file

  [[nodiscard]] const List* list() const { return std::get_if<List>(&content); }
  [[nodiscard]] const Table* table() const { return std::get_if<Table>(&content); }
  [[nodiscard]] const std::string* text() const { return std::get_if<std::string>(&content); }
};

/// A value and its name, one part of a dotted name, in the order of the file.
struct DocumentEntry {
  std::string name;
  int line = 0;  ///< of the name
  DocumentValue value;
};

/// In words: "the integer 3", "a table".
[[nodiscard]] std::string describe(const DocumentValue& value);

/// The value as TOML in one line; equal values give equal texts: `['a.obj', {source = 'b.obj', scale = 2}]`.
/// Texts stand in single quotation marks where they can, so that quoting all of it needs no escapes. A date
/// or time becomes an empty text.
[[nodiscard]] std::string print_in_line(const DocumentValue& value);

/// The entry with that name; null if no entry has it.
[[nodiscard]] const DocumentEntry* find(const DocumentValue::Table& table, std::string_view name);

}  // namespace marti::sim
