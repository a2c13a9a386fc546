#include "studies/tables/csv.h"

#include <cmath>

#include "sim/units.h"

namespace marti::studies {

namespace {

void append_real(std::string& out, double value) {
  if (std::isnan(value)) {
    out += "nan";
  } else if (std::isinf(value)) {
    out += value > 0.0 ? "inf" : "-inf";
  } else {
    out += sim::print_real(value);
  }
}

void append_cell(std::string& out, const Cell& cell) {
  if (const auto* integer = std::get_if<std::int64_t>(&cell)) {
    out += std::to_string(*integer);
  } else if (const auto* real = std::get_if<double>(&cell)) {
    append_real(out, *real);
  } else if (const auto* text = std::get_if<std::string>(&cell)) {
    out += csv_text(*text);
  }
}

}  // namespace

std::string csv_text(const std::string& text) {
  if (!text.empty() && text.find_first_of(",\"\r\n") == std::string::npos) {
    return text;
  }
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') {
      quoted += '"';
    }
    quoted += c;
  }
  return quoted + '"';
}

std::string csv_of(const Table& table) {
  std::string out;
  for (std::size_t i = 0; i < table.columns().size(); ++i) {
    out += (i == 0 ? "" : ",") + table.columns()[i].name;
  }
  out += "\r\n";
  for (const std::vector<Cell>& row : table.rows()) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      out += i == 0 ? "" : ",";
      append_cell(out, row[i]);
    }
    out += "\r\n";
  }
  return out;
}

}  // namespace marti::studies
