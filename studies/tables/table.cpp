#include "studies/tables/table.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "sim/error.h"

namespace marti::studies::tables {

namespace {

// A sum that does not fit in 64 bits.
bool is_large_sum(const Cell& cell) {
  const auto* real = std::get_if<double>(&cell);
  return real != nullptr && std::abs(*real) >= 0x1p63;
}

bool fits(const Cell& cell, ColumnType type) {
  if (std::holds_alternative<std::monostate>(cell)) {
    return true;
  }
  switch (type) {
    case ColumnType::integer:
      return std::holds_alternative<std::int64_t>(cell) || is_large_sum(cell);
    case ColumnType::real:
      return std::holds_alternative<double>(cell);
    case ColumnType::text:
      return std::holds_alternative<std::string>(cell);
    case ColumnType::boolean: {
      const auto* flag = std::get_if<std::int64_t>(&cell);
      return flag != nullptr && (*flag == 0 || *flag == 1);
    }
  }
  return false;
}

}  // namespace

bool is_plain_name(std::string_view name, bool dots) {
  return !name.empty() && std::ranges::all_of(name, [dots](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || (dots && c == '.');
  });
}

Column text_column(std::string_view name, std::string_view description) {
  return {std::string(name), ColumnType::text, "", std::string(description)};
}

Column count_column(std::string_view name, std::string_view description) {
  return integer_column(name, "1", description);
}

Column integer_column(std::string_view name, std::string_view unit, std::string_view description) {
  return {std::string(name), ColumnType::integer, std::string(unit), std::string(description)};
}

Column real_column(std::string_view name, std::string_view unit, std::string_view description) {
  return {std::string(name), ColumnType::real, std::string(unit), std::string(description)};
}

Cell::Cell(const std::optional<std::int64_t>& number) {
  if (number) {
    *this = *number;
  }
}

Cell::Cell(sim::Sum number) : CellValue(static_cast<double>(number)) {
  if (const auto fits = static_cast<std::int64_t>(number); fits == number) {
    emplace<std::int64_t>(fits);
  }
}

Cell::Cell(const std::optional<sim::Sum>& number) {
  if (number) {
    *this = Cell(*number);
  }
}

Cell::Cell(const std::optional<double>& number) {
  if (number) {
    *this = *number;
  }
}

Cell::Cell(const Cell& other) = default;
Cell::Cell(Cell&& other) noexcept = default;
Cell& Cell::operator=(const Cell& other) = default;
Cell& Cell::operator=(Cell&& other) noexcept = default;
Cell::~Cell() = default;

Table::Table(std::string name, std::string title, std::vector<Column> columns)
    : name_(std::move(name)), title_(std::move(title)), columns_(std::move(columns)) {
  sim::ensure(is_plain_name(name_) && !columns_.empty(), "a table needs a plain name and a column");
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    sim::ensure(is_plain_name(columns_[i].name, true), "the name of a table's column is not plain");
    for (std::size_t j = 0; j < i; ++j) {
      sim::ensure(columns_[i].name != columns_[j].name, "two columns of a table have one name");
    }
  }
}

void Table::add_row(std::vector<Cell> cells) {
  sim::ensure(cells.size() == columns_.size(), "a row has another number of cells than its table columns");
  for (std::size_t i = 0; i < cells.size(); ++i) {
    sim::ensure(fits(cells[i], columns_[i].type), "a cell is not of its column's type");
  }
  rows_.push_back(std::move(cells));
}

void Table::add_columns(std::span<const Column> columns,
                        const std::function<std::vector<Cell>(std::span<const Cell>)>& cells_of) {
  std::vector<Column> all = columns_;
  all.insert(all.end(), columns.begin(), columns.end());
  Table wider(name_, title_, std::move(all));
  wider.rows_.reserve(rows_.size());
  for (std::vector<Cell>& row : rows_) {
    std::vector<Cell> added = cells_of(row);
    // Each row is freed before the next one is made: a large table does not stand in memory twice.
    std::vector<Cell> old = std::exchange(row, {});
    std::vector<Cell> cells;
    cells.reserve(wider.columns_.size());
    std::ranges::move(old, std::back_inserter(cells));
    std::ranges::move(added, std::back_inserter(cells));
    wider.add_row(std::move(cells));
  }
  *this = std::move(wider);
}

std::size_t Table::column(std::string_view name) const {
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    if (columns_[i].name == name) {
      return i;
    }
  }
  throw sim::InternalError("table " + name_ + " has no column " + std::string(name));
}

const Cell& Table::at(std::size_t row, std::string_view column_name) const {
  sim::ensure(row < rows_.size(), "a table has no such row");
  return rows_[row][column(column_name)];
}

Table answer_table(std::string name, std::string title, std::span<const std::string> sentences) {
  Table table(std::move(name), std::move(title), {text_column("answer", "a sentence")});
  for (const std::string& sentence : sentences) {
    table.add_row({sentence});
  }
  return table;
}

Table describe_columns(std::span<const Table> tables) {
  Table described(
      "columns", "Every column of every table",
      {text_column("table_name", "table"), text_column("column_name", "column"),
       text_column("unit", "unit; 1 for a count, empty for a text"), text_column("description", "meaning")});
  for (const Table& table : tables) {
    for (const Column& column : table.columns()) {
      described.add_row({table.name(), column.name, column.unit, column.description});
    }
  }
  return described;
}

}  // namespace marti::studies::tables
