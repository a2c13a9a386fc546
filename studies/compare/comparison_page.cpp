#include "studies/compare/comparison_page.h"

#include "sim/error.h"
#include "studies/report/page/html_text.h"
#include "studies/report/page/page_sections.h"
#include "studies/report/page/report_page.h"
#include "studies/report/plots/vega_bundle.h"

namespace marti::studies::compare {

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
