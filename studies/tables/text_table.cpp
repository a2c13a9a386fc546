#include "studies/tables/text_table.h"
#include "sim/mapped.h"
#include "studies/tables/text_units.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "studies/tables/cell_number.h"
#include "studies/tables/wide_table.h"

namespace marti::studies::tables {

namespace {

/// How a unit is shown: what one of it is worth in the shown unit, its name, and the decimals.
struct Shown {
  double factor = 1.0;
  std::string unit;
  int decimals = 3;
  bool convert = false;  ///< integers too become reals
};

Shown shown(const Column& column) {
  if (column.unit == "ps") {
    return {1e-12, "s", 3, true};
  }
  if (column.unit == "byte") {
    return {1.0 / 1024.0, "KiB", 1, true};
  }
  if (column.unit == "fraction") {
    return {100.0, "%", 2, true};
  }
  return {1.0, column.unit == "1" ? "" : column.unit, 3, false};
}

std::string visible(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < 0x20U || c == 0x7f) {
      out += fmt::format("\\x{:02x}", static_cast<unsigned>(c));
    } else {
      out += c;
    }
  }
  return out;
}

std::string real(double value, const Shown& how) { return fixed(value * how.factor, how.decimals); }

std::string text_of(const Cell& cell, const Shown& how) {
  if (const auto* integer = std::get_if<std::int64_t>(&cell)) {
    return how.convert ? real(static_cast<double>(*integer), how) : grouped(*integer);
  }
  if (const auto* value = std::get_if<double>(&cell)) {
    return real(*value, how);
  }
  if (const auto* text = std::get_if<std::string>(&cell)) {
    return visible(*text);
  }
  return "-";
}

// Characters, not bytes: bytes of UTF-8 that continue a character do not count.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(
      std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xc0U) != 0x80U; }));
}

}  // namespace

std::string aligned(const std::vector<std::vector<std::string>>& lines, const std::vector<bool>& left) {
  std::vector<std::size_t> widths;
  for (const std::vector<std::string>& line : lines) {
    widths.resize(std::max(widths.size(), line.size()));
    for (std::size_t i = 0; i < line.size(); ++i) {
      widths[i] = std::max(widths[i], width_of(line[i]));
    }
  }
  std::string out;
  for (const std::vector<std::string>& line : lines) {
    std::string text;
    for (std::size_t i = 0; i < line.size(); ++i) {
      const std::string padding(widths[i] - width_of(line[i]), ' ');
      text += "  " + (i < left.size() && left[i] ? line[i] + padding : padding + line[i]);
    }
    out += text.substr(0, text.find_last_not_of(' ') + 1) + "\n";
  }
  return out;
}

std::string text_of(const Table& table) {
  std::vector<std::vector<std::string>> lines(2);
  for (const Column& column : table.columns()) {
    lines[0].push_back(column.name);
    lines[1].push_back(shown(column).unit);
  }
  for (const std::vector<Cell>& row : table.rows()) {
    std::vector<std::string>& line = lines.emplace_back();
    for (std::size_t i = 0; i < row.size(); ++i) {
      line.push_back(text_of(in_words(row[i], table.columns()[i].type), shown(table.columns()[i])));
    }
  }
  const std::vector<bool> left =
      sim::mapped(table.columns(), [&](const Column& column) { return column.type == ColumnType::text; });
  return table.title() + "\n" + aligned(lines, left);
}

std::string side_by_side(const Table& table, std::string_view row, std::string_view across,
                         std::string_view value, std::string_view title) {
  const Table wide = widen(table, std::array{row}, across, "", value);
  Table titled("shown", std::string(title), {wide.columns().begin(), wide.columns().end()});
  for (const std::vector<Cell>& cells : wide.rows()) {
    titled.add_row(cells);
  }
  return text_of(titled);
}

}  // namespace marti::studies::tables
