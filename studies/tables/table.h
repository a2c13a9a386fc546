// A table of results: what a study found, with name, unit and description of every column. It knows no
// output format; the writers beside this file turn it into CSV, SQLite, aligned text and charts.
#pragma once

#include <concepts>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "sim/error.h"
#include "sim/time.h"

namespace marti::studies::tables {

/// A boolean is 0 or 1 in SQLite and in a cell, false or true in JSON, CSV and texts.
enum class ColumnType : std::uint8_t { integer, real, text, boolean };

struct Column {
  /// Lower-case letters, digits and '_'; of a key of the configuration also '.'. Unique in the table.
  std::string name;
  ColumnType type = ColumnType::integer;  ///< an integer of 2^63 or more is the nearest real
  /// "1" for a count, else "ps", "byte", "fraction", "s", ...; empty for a text.
  std::string unit;
  std::string description;  ///< for people, without the full stop
};

/// Whether it may name a table or, with `dots`, a column: lower-case letters, digits, '_', and '.' as in a
/// key.
[[nodiscard]] bool is_plain_name(std::string_view name, bool dots = false);

[[nodiscard]] Column text_column(std::string_view name, std::string_view description);
/// Of unit "1".
[[nodiscard]] Column count_column(std::string_view name, std::string_view description);
[[nodiscard]] Column integer_column(std::string_view name, std::string_view unit,
                                    std::string_view description);
[[nodiscard]] Column real_column(std::string_view name, std::string_view unit, std::string_view description);

using CellValue = std::variant<std::monostate, std::int64_t, double, std::string>;

/// No value, an integer, a real or a text. A real may be NaN or infinite. Whatever has such a value is a
/// cell: a count, a flag, any text, and what may have no value.
class Cell : public CellValue {
 public:
  Cell() = default;
  /// Throws InternalError for a number that does not fit.
  template <std::integral Number>
  Cell(Number number) : CellValue(static_cast<std::int64_t>(number)) {
    sim::ensure(std::is_signed_v<Number> || static_cast<std::int64_t>(number) >= 0,
                "a count does not fit a table");
  }
  Cell(double number) : CellValue(number) {}
  /// An integer; a sum that does not fit in 64 bits is the nearest real.
  Cell(sim::Sum number);
  Cell(std::string text) : CellValue(std::move(text)) {}
  Cell(std::string_view text) : CellValue(std::string(text)) {}
  Cell(const char* text) : CellValue(std::string(text)) {}
  template <std::integral Number>
  Cell(const std::optional<Number>& number)
      : Cell(number ? std::optional<std::int64_t>(*number) : std::nullopt) {}
  // These are defined elsewhere: GCC 12, where it inlines them, warns of a text that is not there.
  Cell(const std::optional<std::int64_t>& number);
  Cell(const std::optional<double>& number);
  Cell(const std::optional<sim::Sum>& number);
  Cell(const Cell& other);
  Cell(Cell&& other) noexcept;
  Cell& operator=(const Cell& other);
  Cell& operator=(Cell&& other) noexcept;
  ~Cell();
};

class Table {
 public:
  /// Throws InternalError for a name that is not made of the characters that it may have, for two columns of
  /// one name, and for no column.
  Table(std::string name, std::string title, std::vector<Column> columns);

  /// Throws InternalError when the number of cells or a cell's type is not that of the columns.
  void add_row(std::vector<Cell> cells);

  /// Adds columns behind the others; `cells_of` gives the cells of a row in them, from its other cells.
  /// Throws InternalError like the constructor, and like add_row, after which the table is of no use.
  void add_columns(std::span<const Column> columns,
                   const std::function<std::vector<Cell>(std::span<const Cell>)>& cells_of);

  [[nodiscard]] const std::string& name() const { return name_; }
  /// One line for people.
  [[nodiscard]] const std::string& title() const { return title_; }
  [[nodiscard]] std::span<const Column> columns() const { return columns_; }
  [[nodiscard]] std::span<const std::vector<Cell>> rows() const { return rows_; }

  /// Index of a column. Throws InternalError when there is none of this name.
  [[nodiscard]] std::size_t column(std::string_view name) const;
  [[nodiscard]] const Cell& at(std::size_t row, std::string_view column_name) const;

 private:
  std::string name_;
  std::string title_;
  std::vector<Column> columns_;
  std::vector<std::vector<Cell>> rows_;
};

/// The sentences with which a study answers: its page begins with them. The name ends in "_answer".
[[nodiscard]] Table answer_table(std::string name, std::string title, std::span<const std::string> sentences);

/// The table "columns": table, name, unit and description of every column of `tables`.
[[nodiscard]] Table describe_columns(std::span<const Table> tables);

}  // namespace marti::studies::tables
