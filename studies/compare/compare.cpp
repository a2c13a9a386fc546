#include "studies/compare/compare.h"

#include <fmt/format.h>

#include <algorithm>

#include "sim/error.h"
#include "studies/compare/page.h"
#include "studies/compare/results.h"
#include "studies/report/page/html_text.h"
#include "studies/report/page/page_sections.h"
#include "studies/report/page/report_page.h"
#include "studies/report/plots/vega_bundle.h"
#include "studies/tables/text_table.h"
#include "studies/tables/text_units.h"

namespace marti::studies::compare {

namespace {

constexpr std::size_t most_lines = 20;
constexpr std::size_t most_page_rows = 20'000;

// Control characters must not reach the terminal.
std::string printable(std::string text) {
  std::ranges::replace_if(
      text, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, '?');
  return text;
}

std::string table_text(const report::SortedTable& table, bool whole) {
  const std::size_t columns = table.columns.size() - (table.columns.back().name == page_column ? 1 : 0);
  std::vector<std::vector<std::string>> lines(1);
  std::vector<bool> left;
  for (std::size_t i = 0; i < columns; ++i) {
    lines[0].push_back(printable(table.columns[i].name));
    left.push_back(!table.columns[i].number);
  }
  const std::size_t shown = whole ? table.rows.size() : std::min(table.rows.size(), most_lines);
  for (std::size_t row = 0; row < shown; ++row) {
    std::vector<std::string>& line = lines.emplace_back();
    for (std::size_t i = 0; i < columns; ++i) {
      line.push_back(printable(table.rows[row][i].text));
    }
  }
  const std::size_t more = table.rows.size() - shown;
  return tables::aligned(lines, left) + (more == 0
                                             ? ""
                                             : fmt::format("  and {} more: --all lists them\n",
                                                           tables::grouped(static_cast<std::int64_t>(more))));
}

report::PageSection section_of(const ComparisonPart& part) {
  std::string html;
  for (const std::string& sentence : part.sentences) {
    html += (html.empty() ? "<ul>\n<li>" : "<li>") + report::html_text(sentence) + "</li>\n";
  }
  html += html.empty() ? "" : "</ul>\n";
  for (const report::ReportChart& chart : part.charts) {
    html += "<div class=\"charts\">\n" + report::chart_html(chart) + "</div>\n";
  }
  for (report::SortedTable table : part.tables) {
    table.rows.resize(std::min(table.rows.size(), most_page_rows));
    html += "<h3>" + report::html_text(table.title) + "</h3>\n" + report::sorted_table_html(table);
  }
  return {part.id, part.title, html};
}

// Lists have at most `most_lines` lines unless `all`. Ends in a line break.
std::string text_of(const ComparisonPage& page, bool all) {
  std::string text = fmt::format("A  {}\nB  {}\n", printable(page.a), printable(page.b));
  for (const ComparisonPart& part : page.parts) {
    std::string label = part.label;
    for (const std::string& sentence : part.sentences) {
      text += fmt::format("{}{:<15}{}\n", label.empty() ? "" : "\n", label, printable(sentence));
      label.clear();
    }
    for (const report::SortedTable& table : part.tables) {
      text += (&table == part.tables.data() ? "" : "\n  " + printable(table.title) + "\n") +
              table_text(table, all || part.whole);
    }
  }
  return text;
}

}  // namespace

std::string compare_results(const std::string& a, const std::string& b, const CompareOptions& options,
                            ComparisonPage* page) {
  Results from(a);
  Results to(b);
  const Comparison found = compared(from, to);
  const ComparisonPage shown = page_of(found, options.all);
  if (page != nullptr) {
    *page = shown;
  }
  return options.json ? json_of(found, options.all) : text_of(shown, options.all);
}

std::string html_of(const ComparisonPage& page) {
  report::require_vega_scripts();
  report::ReportData data;
  data.kind = "comparison";
  data.title = page.title;
  data.about = page.about;
  std::vector<report::PageSection> sections;
  for (const ComparisonPart& part : page.parts) {
    sections.push_back(section_of(part));
    data.charts.insert(data.charts.end(), part.charts.begin(), part.charts.end());
  }
  return report::report_page(data, sections, report::vega_scripts());
}

}  // namespace marti::studies::compare
