#include "studies/tables/csv.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "sim/units.h"
#include "studies/tables/cell_number.h"
#include "studies/tables/json_table.h"

namespace marti::studies::tables {

namespace {

std::string real_text(double value) {
  if (std::isnan(value)) {
    return "nan";
  }
  return std::isinf(value) ? (value > 0.0 ? "inf" : "-inf") : sim::print_real(value);
}

// Quoted where the RFC asks for it, and when it is empty.
std::string quoted(const std::string& text) {
  if (!text.empty() && text.find_first_of(",\"\r\n") == std::string::npos) {
    return text;
  }
  std::string quoted = "\"";
  for (const char c : text) {
    quoted += c == '"' ? "\"\"" : std::string(1, c);
  }
  return quoted + '"';
}

std::string csv_cell(const Cell& cell) {
  if (const auto* integer = std::get_if<std::int64_t>(&cell)) {
    return std::to_string(*integer);
  }
  if (const auto* real = std::get_if<double>(&cell)) {
    return real_text(*real);
  }
  const auto* text = std::get_if<std::string>(&cell);
  return text == nullptr ? std::string() : quoted(*text);
}

void append_record(std::string& out, const std::vector<Cell>& cells) {
  for (std::size_t i = 0; i < cells.size(); ++i) {
    out += (i == 0 ? "" : ",") + csv_cell(cells[i]);
  }
  out += "\r\n";
}

}  // namespace

std::string csv_of(const Table& table) {
  std::vector<Cell> names;
  for (const Column& column : table.columns()) {
    names.emplace_back(column.name);
  }
  std::string out;
  append_record(out, names);
  for (const std::vector<Cell>& row : table.rows()) {
    std::vector<Cell> cells;
    for (std::size_t i = 0; i < row.size(); ++i) {
      cells.push_back(in_words(row[i], table.columns()[i].type));
    }
    append_record(out, cells);
  }
  return out;
}

std::string csv_of_rows(const nlohmann::ordered_json& rows) {
  std::vector<Cell> names;
  std::set<std::string> seen;
  for (const auto& row : rows) {
    for (const auto& [name, value] : row.items()) {
      if (seen.insert(name).second) {
        names.emplace_back(name);
      }
    }
  }
  std::string out;
  append_record(out, names);
  for (const auto& row : rows) {
    std::vector<Cell> cells;
    for (const Cell& name : names) {
      const auto at = row.find(std::get<std::string>(name));
      cells.push_back(at == row.end() ? Cell() : cell_of(*at));
    }
    append_record(out, cells);
  }
  return out;
}

}  // namespace marti::studies::tables
