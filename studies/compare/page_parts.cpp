#include "studies/compare/page_parts.h"

#include <fmt/format.h>

#include <cmath>

#include "sim/error.h"
#include "sim/schema.h"
#include "studies/compare/compare_text.h"
#include "studies/report/model/chart_library.h"
#include "studies/report/page/html_text.h"
#include "studies/report/page/page_sections.h"
#include "studies/report/page/report_page.h"
#include "studies/report/plots/vega_bundle.h"
#include "studies/sweep/plan/sweep_keys.h"
#include "studies/tables/cell_number.h"
#include "studies/tables/text_units.h"

namespace marti::studies::compare {

namespace {

report::SortedCell setting_cell(const std::string& key, const tables::Cell& value) {
  return {setting_text(value), setting_number(key, value)};
}

}  // namespace

report::SortedTable settings_table(const std::string& title, const std::vector<Difference>& settings) {
  report::SortedTable table;
  table.title = title;
  table.columns = {{"key", false, "of the configuration"},
                   {"A", false, "value in A; - where the machine does not use it"},
                   {"B", false, "value in B; - where the machine does not use it"},
                   {"meaning", false, ""}};
  for (const Difference& setting : settings) {
    const std::optional<std::size_t> key = sweep::sweep_schema().find(setting.name);
    table.rows.push_back({{setting.name, {}},
                          setting_cell(setting.name, setting.a),
                          setting_cell(setting.name, setting.b),
                          {key ? sweep::sweep_schema().keys()[*key].meaning : std::string(), {}}});
  }
  return table;
}

report::SortedCell figure_cell(const tables::Cell& value, const std::string& figure) {
  report::SortedCell cell{printable(tables::figure_text(value, unit_of_figure(figure), "-")), {}};
  if (const std::optional<double> number = tables::number_of(value); number && std::isfinite(*number)) {
    cell.number = number;
  }
  return cell;
}

report::SortedCell change_cell(const Difference& figure) { return {change_of(figure), figure.relative()}; }

report::SortedCell time_cell(std::int64_t ps) { return {tables::seconds(ps), static_cast<double>(ps)}; }

report::SortedCell ratio_cell(double ratio) { return {fmt::format("{:.4f}", ratio), ratio}; }

report::SortedCell integer_cell(std::int64_t number) {
  return {std::to_string(number), static_cast<double>(number)};
}

report::SortedTable figures_table(const std::string& title, const std::vector<Difference>& figures) {
  report::SortedTable table;
  table.title = title;
  table.columns = {{"figure", false, "name in the catalogue: marti figures"},
                   {"A", true, ""},
                   {"B", true, ""},
                   {"change", true, "from A to B; sorted by |B - A| / max(|A|, |B|)"},
                   {"meaning", false, ""}};
  for (const Difference& figure : figures) {
    table.rows.push_back({{figure.name, {}},
                          figure_cell(figure.a, figure.name),
                          figure_cell(figure.b, figure.name),
                          change_cell(figure),
                          {meaning_of_figure(figure.name), {}}});
  }
  return table;
}

report::ReportChart ratio_chart(const std::vector<RatioPoint>& points) {
  tables::Table table(
      "compare_points", "Frame time of B by that of A, for each point",
      {tables::count_column("point", "its number"), tables::text_column("name", "the values of its axes"),
       tables::integer_column("a_ps", "ps", "frame time of A"),
       tables::integer_column("b_ps", "ps", "frame time of B"),
       tables::real_column("ratio", "1", "frame time of B / frame time of A"),
       tables::text_column("which", "which is faster")});
  for (const RatioPoint& point : points) {
    table.add_row({point.point, point.name, point.a, point.b,
                   static_cast<double>(point.b) / static_cast<double>(point.a),
                   point.b < point.a   ? "B is faster"
                   : point.b > point.a ? "B is slower"
                                       : "equal"});
  }
  return report::make_chart(table.name(), table, "Below the line B is faster.");
}

std::string who_is(const char* letter, const std::string& name, const std::string& version) {
  return fmt::format("{} is {}{}.", letter, printable(name),
                     version.empty() ? "" : ", made by marti " + printable(version));
}

namespace {

std::string sentences_html(const std::vector<std::string>& sentences) {
  std::string html;
  for (const std::string& sentence : sentences) {
    html += "<li>" + report::html_text(sentence) + "</li>\n";
  }
  return html.empty() ? html : "<ul>\n" + html + "</ul>\n";
}

report::PageSection section_of(const ComparisonPart& part) {
  std::string charts;
  for (const report::ReportChart& chart : part.charts) {
    charts += report::chart_html(chart);
  }
  std::string html = sentences_html(part.sentences);
  if (!charts.empty()) {
    html += "<div class=\"charts\">\n" + charts + "</div>\n";
  }
  for (const report::SortedTable& table : part.tables) {
    html += "<h3>" + report::html_text(table.title) + "</h3>\n" + report::sorted_table_html(table);
  }
  return {part.id, part.title, html};
}

}  // namespace

std::string html_of(const ComparisonPage& page) {
  if (!report::have_vega_scripts()) {
    throw sim::UserError(report::no_vega_scripts);
  }
  report::ReportData data;
  data.kind = "comparison";
  data.title = page.title;
  std::vector<report::PageSection> sections;
  for (const ComparisonPart& part : page.parts) {
    sections.push_back(section_of(part));
    data.charts.insert(data.charts.end(), part.charts.begin(), part.charts.end());
  }
  return report::report_page(data, sections, report::vega_scripts());
}

}  // namespace marti::studies::compare
