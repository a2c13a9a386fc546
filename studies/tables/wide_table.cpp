#include "studies/tables/wide_table.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "sim/error.h"
#include "sim/mapped.h"

namespace marti::studies::tables {

namespace {

std::string plain_text(const Cell& cell) {
  if (const auto* integer = std::get_if<std::int64_t>(&cell)) {
    return std::to_string(*integer);
  }
  const auto* text = std::get_if<std::string>(&cell);
  sim::ensure(text != nullptr, "a table is widened by integers or texts");
  return *text;
}

/// Index of `wanted`, which is added when it is new.
template <class T>
std::size_t index_of(std::vector<T>& known, T wanted) {
  const auto at = std::ranges::find(known, wanted);
  if (at != known.end()) {
    return static_cast<std::size_t>(at - known.begin());
  }
  known.push_back(std::move(wanted));
  return known.size() - 1;
}

}  // namespace

Table widen(const Table& table, std::span<const std::string_view> keys, std::string_view spread,
            std::string_view prefix, std::string_view value) {
  std::vector<std::vector<Cell>> rows;
  std::vector<std::string> names;
  std::vector<std::vector<Cell>> cells;
  for (std::size_t row = 0; row < table.rows().size(); ++row) {
    std::vector<Cell> key =
        sim::mapped(keys, [&](const std::string_view name) { return table.at(row, name); });
    const std::size_t to = index_of(rows, std::move(key));
    const std::size_t column = index_of(names, std::string(prefix) + plain_text(table.at(row, spread)));
    cells.resize(rows.size());
    cells[to].resize(std::max(cells[to].size(), column + 1));
    cells[to][column] = table.at(row, value);
  }
  std::vector<Column> columns =
      sim::mapped(keys, [&](const std::string_view name) { return table.columns()[table.column(name)]; });
  for (const std::string& name : names) {
    Column column = table.columns()[table.column(value)];
    column.name = name;
    columns.push_back(std::move(column));
  }
  Table wide(table.name(), table.title(), std::move(columns));
  for (std::size_t row = 0; row < rows.size(); ++row) {
    std::vector<Cell> line = rows[row];
    cells[row].resize(names.size());
    line.insert(line.end(), cells[row].begin(), cells[row].end());
    wide.add_row(std::move(line));
  }
  return wide;
}

}  // namespace marti::studies::tables
