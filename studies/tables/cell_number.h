// A cell's value as a number, as the type that its column declares, and in words.
#pragma once

#include <optional>

#include "studies/tables/table.h"

namespace marti::studies::tables {

/// An integer or a real as a real; std::nullopt for a text and for a cell without value.
[[nodiscard]] inline std::optional<double> number_of(const Cell& cell) {
  if (const auto* integer = std::get_if<std::int64_t>(&cell)) {
    return static_cast<double>(*integer);
  }
  const auto* real = std::get_if<double>(&cell);
  return real == nullptr ? std::nullopt : std::optional(*real);
}

/// The cell as a value of that type; without a value where it cannot be one. SQLite stores a value of any
/// type, whatever type the column declares.
[[nodiscard]] inline Cell as_type(const Cell& cell, ColumnType type) {
  if (type == ColumnType::text) {
    return std::holds_alternative<std::string>(cell) ? cell : Cell();
  }
  if (type == ColumnType::boolean) {
    return cell == Cell(std::int64_t{0}) || cell == Cell(std::int64_t{1}) ? cell : Cell();
  }
  if (type == ColumnType::integer) {
    return std::holds_alternative<std::int64_t>(cell) ? cell : Cell();
  }
  const std::optional<double> number = number_of(cell);
  return number ? Cell(*number) : Cell();
}

/// The type that a column of so many cells needs, cell_of(i) being each: text if any is one, else integer if
/// all values are, else real.
template <class CellOf>
[[nodiscard]] ColumnType common_type(std::size_t cells, const CellOf& cell_of) {
  bool integer = false;
  bool real = false;
  for (std::size_t i = 0; i < cells; ++i) {
    const Cell& cell = cell_of(i);
    if (std::holds_alternative<std::string>(cell)) {
      return ColumnType::text;
    }
    integer = integer || std::holds_alternative<std::int64_t>(cell);
    real = real || std::holds_alternative<double>(cell);
  }
  return integer && !real ? ColumnType::integer : ColumnType::real;
}

/// The cell as a text has it: of a boolean "true" or "false".
[[nodiscard]] inline Cell in_words(const Cell& cell, ColumnType type) {
  const auto* flag = std::get_if<std::int64_t>(&cell);
  return flag != nullptr && type == ColumnType::boolean ? Cell(std::string(*flag != 0 ? "true" : "false"))
                                                        : cell;
}

}  // namespace marti::studies::tables
