#include "studies/tables/latex.h"

#include <fmt/format.h>

#include <string_view>

namespace marti::studies::tables {

namespace {

std::string escaped(std::string_view text) {
  std::string latex;
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (code < 0x20 || code == 0x7f) {
      latex += ' ';
    } else if (std::string_view("#$%&_{}").find(c) != std::string_view::npos) {
      latex += std::string("\\") + c;
    } else if (c == '\\') {
      latex += "\\textbackslash{}";
    } else if (c == '<' || c == '>' || c == '|') {  // other glyphs in TeX's own encoding of fonts
      latex += c == '<' ? "\\textless{}" : c == '>' ? "\\textgreater{}" : "\\textbar{}";
    } else if (c == '~' || c == '^') {
      latex += std::string("\\") + c + "{}";
    } else {
      latex += c;
    }
  }
  return latex;
}

std::string cell_text(const Cell& cell) {
  if (const auto* const text = std::get_if<std::string>(&cell)) {
    return escaped(*text);
  }
  if (const auto* const real = std::get_if<double>(&cell)) {
    return fmt::format("{:.2f}", *real);
  }
  const auto* const whole = std::get_if<std::int64_t>(&cell);
  return whole == nullptr ? "--" : std::to_string(*whole);
}

}  // namespace

std::string latex_of(const Table& table) {
  std::string form;
  std::string head;
  for (const Column& column : table.columns()) {
    std::string name = column.name;
    for (char& c : name) {
      c = c == '_' ? ' ' : c;
    }
    form += column.type == ColumnType::text ? 'l' : 'r';
    head += (head.empty() ? "" : " & ") + escaped(name);
  }
  std::string latex =
      "% " + escaped(table.title()) + "\n\\begin{tabular}{" + form + "}\n" + head + " \\\\\n\\hline\n";
  for (const std::vector<Cell>& row : table.rows()) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      line += (i == 0 ? "" : " & ") + cell_text(row[i]);
    }
    latex += line + " \\\\\n";
  }
  return latex + "\\end{tabular}\n";
}

}  // namespace marti::studies::tables
