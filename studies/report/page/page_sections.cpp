#include "studies/report/page/page_sections.h"

#include <fmt/format.h>

#include "sim/base64.h"
#include "studies/report/model/answer_text.h"
#include "studies/report/page/html_text.h"
#include "studies/tables/text_units.h"

namespace marti::studies {

namespace {

std::string table_html(const Table& table) {
  std::string html = "<div class=\"table\" role=\"region\" tabindex=\"0\" aria-label=\"" +
                     html_text(table.title()) + "\"><table><thead><tr>";
  for (const Column& column : table.columns()) {
    const bool has_unit = !column.unit.empty() && column.unit != "1";
    html +=
        fmt::format("<th scope=\"col\"{} title=\"{}\">{}{}</th>",
                    column.type == ColumnType::text ? "" : " class=\"number\"", html_text(column.description),
                    html_text(words(column.name)), has_unit ? ", " + html_text(column.unit) : "");
  }
  html += "</tr></thead><tbody>\n";
  for (const std::vector<Cell>& row : table.rows()) {
    html += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i) {
      html += table.columns()[i].type == ColumnType::text ? "<td>" : "<td class=\"number\">";
      html += html_text(short_text(row[i], "")) + "</td>";
    }
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
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
  return "<p>Points are machines of the sweep, simulated exactly. The curve is the analytic model: it "
         "reaches one step "
         "of the axis beyond the points, where it is dashed and marked as extrapolated. All charts of the "
         "sweep follow "
         "the controls.</p>\n"
         "<div id=\"controls\" role=\"group\" aria-label=\"The machine that is shown\"></div>\n"
         "<p id=\"reading\" role=\"status\" aria-live=\"polite\"></p>\n" +
         charts +
         "<details id=\"points\"><summary>All points</summary>\n<p class=\"saves\"><a href=\"#points\" "
         "id=\"save-points\">CSV</a></p>\n<div id=\"points-table\" class=\"table\" role=\"region\" "
         "tabindex=\"0\" "
         "aria-label=\"All points\"></div></details>\n";
}

std::string images_html(const ReportData& report) {
  std::string html = "<div class=\"images\">\n";
  for (const ReportImage& image : report.images) {
    html += fmt::format(
        "<figure><img alt=\"{0}\" src=\"data:image/png;base64,{1}\"><figcaption>{0}</figcaption>"
        "</figure>\n",
        html_text(image.title), sim::base64(image.png));
  }
  return html + "</div>\n";
}

std::string tables_html(const ReportData& report) {
  std::string html;
  for (const ReportTable& table : report.tables) {
    html += folded(fmt::format("{} ({} rows)", table.table.title(), table.table.rows().size()),
                   table_html(table.table), !table.folded);
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
  add("charts", "Charts", charts_html(report, false));
  add("images", "Images", report.images.empty() ? "" : images_html(report));
  add("tables", "Tables", tables_html(report));
  add("text", "The study's own report",
      report.text.empty() ? "" : "<pre tabindex=\"0\">" + html_text(report.text) + "</pre>\n");
  add("provenance", "Where it comes from", provenance_html(report));
  return sections;
}

}  // namespace marti::studies
