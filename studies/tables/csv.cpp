#include "studies/tables/csv.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <string>
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

// A record of cell(0) to cell(cells - 1).
template <class CellAt>
void append_record(std::string& out, std::size_t cells, const CellAt& cell) {
  for (std::size_t i = 0; i < cells; ++i) {
    out += i == 0 ? "" : ",";
    out += csv_cell(cell(i));
  }
  out += "\r\n";
}

}  // namespace

std::string csv_of(const Table& table) {
  const std::span<const Column> columns = table.columns();
  std::string out;
  append_record(out, columns.size(), [&](std::size_t i) { return Cell(columns[i].name); });
  for (const std::vector<Cell>& row : table.rows()) {
    append_record(out, columns.size(), [&](std::size_t i) { return in_words(row[i], columns[i].type); });
  }
  return out;
}

std::string csv_of_rows(const nlohmann::ordered_json& rows) {
  std::vector<std::string> names;
  std::set<std::string> seen;
  for (const auto& row : rows) {
    for (const auto& [name, value] : row.items()) {
      if (seen.insert(name).second) {
        names.push_back(name);
      }
    }
  }
  std::string out;
  append_record(out, names.size(), [&](std::size_t i) { return Cell(names[i]); });
  for (const auto& row : rows) {
    append_record(out, names.size(), [&](std::size_t i) {
      const auto at = row.find(names[i]);
      return at == row.end() ? Cell() : cell_of(*at);
    });
  }
  return out;
}

}  // namespace marti::studies::tables
