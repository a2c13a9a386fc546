#include "studies/report/page/page_sections.h"

#include <fmt/format.h>

#include "sim/base64.h"
#include "sim/units.h"
#include "studies/report/model/answer_text.h"
#include "studies/report/page/html_text.h"
#include "studies/report/page/sorted_table.h"
#include "studies/tables/cell_number.h"
#include "studies/tables/text_units.h"

namespace marti::studies::report {

namespace {

// How a column's numbers are shown: times of the simulation in milliseconds, shares in percent, sizes with
// the unit that suits each.
struct ShownColumn {
  std::string unit;      // in the heading
  double divisor = 1.0;  // of what the table holds
  bool sizes = false;
};

ShownColumn shown_as(const tables::Column& column) {
  if (column.unit == "ps") {
    return {"ms", 1e9};
  }
  if (column.unit == "fraction") {
    return {"%", 0.01};
  }
  if (column.unit == "byte") {
    return {"", 1.0, true};
  }
  return {column.unit == "1" ? "" : column.unit};
}

std::string cell_text(const tables::Cell& cell, const ShownColumn& how) {
  const std::optional<double> number = tables::number_of(cell);
  if (number && how.sizes) {
    const auto* whole = std::get_if<std::int64_t>(&cell);
    return whole != nullptr && *whole >= 0 && *whole % 1024 == 0 ? sim::print_size(*whole)
                                                                 : tables::bytes(*number);
  }
  return number && how.divisor != 1.0 ? tables::short_text(*number / how.divisor, "")
                                      : tables::short_text(cell, "");
}

SortedTable sorted_table(const tables::Table& table) {
  SortedTable made{table.title(), {}, {}};
  std::vector<ShownColumn> shown;
  for (const tables::Column& column : table.columns()) {
    const std::string& unit = shown.emplace_back(shown_as(column)).unit;
    made.columns.push_back({words(column.name) + (unit.empty() ? "" : ", " + unit),
                            column.type != tables::ColumnType::text, column.description});
  }
  for (const std::vector<tables::Cell>& row : table.rows()) {
    std::vector<SortedCell>& cells = made.rows.emplace_back();
    for (std::size_t i = 0; i < row.size(); ++i) {
      cells.push_back({cell_text(row[i], shown[i]), tables::number_of(row[i])});
    }
  }
  return made;
}

std::string folded(const std::string& title, const std::string& html, bool open = false) {
  return fmt::format("<details{}><summary>{}</summary>\n{}</details>\n", open ? " open" : "",
                     html_text(title), html);
}

std::string answer_html(const ReportData& report) {
  std::string html = "<ul>\n";
  for (const std::string& sentence : report.answer) {
    html += "<li>" + html_text(sentence) + "</li>\n";
  }
  return html + "</ul>\n";
}

bool is_explored(const ReportChart& chart) {
  return chart.live.is_object() && chart.live.value("rows", "") == "explorer";
}

std::string charts_html(const ReportData& report, bool explored) {
  std::string html;
  for (const ReportChart& chart : report.charts) {
    if (is_explored(chart) == explored) {
      html += chart_html(chart);
    }
  }
  return html.empty() ? html : "<div class=\"charts\">\n" + html + "</div>\n";
}

std::string explorer_html(const std::string& charts) {
  return "<p>Points are machines of the sweep, simulated exactly. All charts of the sweep follow the "
         "controls; a "
         "click on a point, here or in the table, chooses its machine.</p>\n"
         "<div id=\"controls\" role=\"group\" aria-label=\"The machine that is shown\"></div>\n"
         "<p id=\"reading\" role=\"status\" aria-live=\"polite\"></p>\n" +
         charts;
}

// Filled by page/points_table.js.
std::string points_html() {
  return "<p><label for=\"filter\">Only points with </label><input id=\"filter\" type=\"search\" "
         "placeholder=\"cache.size &gt;= 16 KiB, speed_up &gt; 8\" aria-describedby=\"filter-fault\"> "
         "<span id=\"filter-fault\" role=\"status\"></span></p>\n"
         "<div class=\"table\" role=\"region\" tabindex=\"0\" aria-label=\"All points\">"
         "<table id=\"points-table\"></table></div>\n"
         "<p class=\"pages\"><button type=\"button\" id=\"points-before\">Previous</button> "
         "<span id=\"points-shown\" role=\"status\"></span> "
         "<button type=\"button\" id=\"points-after\">Next</button></p>\n"
         "<p class=\"saves\"><a href=\"#points\" id=\"save-points\" aria-label=\"These points with all "
         "figures: save as CSV\">CSV</a></p>\n";
}

// The colours of a map, from dark to bright, and what they stand for.
std::string scale_html(const ReportImage& image) {
  return image.scale.empty() ? std::string()
                             : "<span class=\"scale\"><span>0</span><span class=\"colours\"></span><span>" +
                                   html_text(image.scale) + "</span></span>";
}

std::string images_html(const ReportData& report) {
  std::string html = "<div class=\"images\">\n";
  for (const ReportImage& image : report.images) {
    html += fmt::format(
        "<figure><img alt=\"{0}\" src=\"data:image/png;base64,{1}\"><figcaption>{0}{2}</figcaption>"
        "</figure>\n",
        html_text(image.title), sim::base64(image.png), scale_html(image));
  }
  return html + "</div>\n";
}

std::string tables_html(const ReportData& report) {
  std::string html;
  for (const ReportTable& table : report.tables) {
    html +=
        folded(fmt::format("{} ({})", table.table.title(), tables::counted(table.table.rows().size(), "row")),
               sorted_table_html(sorted_table(table.table)), !table.folded);
  }
  return html;
}

std::string provenance_html(const ReportData& report) {
  std::string html = "<table class=\"facts\"><tbody>\n";
  for (const auto& [what, value] : report.provenance) {
    html += "<tr><th scope=\"row\">" + html_text(what) + "</th><td>" + html_text(value) + "</td></tr>\n";
  }
  html += "</tbody></table>\n";
  if (!report.configuration.empty()) {
    html += folded("Configuration", "<pre tabindex=\"0\">" + html_text(report.configuration) + "</pre>\n");
  }
  return html;
}

}  // namespace

std::string chart_html(const ReportChart& chart) {
  const bool wide = !chart.spec.contains("width") && !chart.spec.contains("layer");
  const std::string name = html_text(chart.name);
  return fmt::format(
      "<figure{0} role=\"group\" aria-labelledby=\"title-{1}\"><h3 id=\"title-{1}\">{2}</h3>\n"
      "<div id=\"chart-{1}\" class=\"chart\" tabindex=\"0\"></div>\n"
      "<figcaption><p class=\"note\" id=\"note-{1}\">{3}</p><p class=\"saves\">"
      "<a href=\"#chart-{1}\" data-save=\"csv\" data-chart=\"{1}\" aria-label=\"{2}: save the data as "
      "CSV\">CSV</a>"
      "<a href=\"#chart-{1}\" data-save=\"svg\" data-chart=\"{1}\" aria-label=\"{2}: save the chart as "
      "SVG\">SVG</a>"
      "</p></figcaption></figure>\n",
      wide ? " class=\"wide\"" : "", name, html_text(chart.title), html_text(chart.note));
}

std::vector<PageSection> page_sections(const ReportData& report) {
  std::vector<PageSection> sections;
  const auto add = [&](const char* id, const char* title, const std::string& html) {
    if (!html.empty()) {
      sections.push_back({id, title, html});
    }
  };
  const std::string explored = charts_html(report, true);
  add("answer", "The answer", report.answer.empty() ? "" : answer_html(report));
  add("explorer", "What if", explored.empty() ? "" : explorer_html(explored));
  add("points", "All points", report.explorer.is_object() ? points_html() : "");
  add("charts", "Charts", charts_html(report, false));
  add("images", "Images", report.images.empty() ? "" : images_html(report));
  add("tables", "Tables", tables_html(report));
  add("text", "The study's own report",
      report.text.empty() ? "" : "<pre tabindex=\"0\">" + html_text(report.text) + "</pre>\n");
  add("provenance", "Where it comes from", provenance_html(report));
  return sections;
}

}  // namespace marti::studies::report
