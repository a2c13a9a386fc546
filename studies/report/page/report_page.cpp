#include "studies/report/page/report_page.h"

#include <map>
#include <vector>

#include "sim/error.h"
#include "studies/report/page/html_text.h"
#include "studies/report/page/page_files.h"
#include "studies/report/page/page_sections.h"
#include "studies/version.h"

namespace marti::studies::report {

namespace {

using Json = nlohmann::ordered_json;

std::string source_of(const Script& script) { return " 'sha256-" + std::string(script.sha256) + "'"; }

// The data of the page's scripts.
Json data_of(const ReportData& report) {
  Json data = {{"kind", report.kind}, {"about", chart_about(report)}, {"charts", Json::array()}};
  for (const ReportChart& chart : report.charts) {
    Json& each =
        data["charts"].emplace_back(Json{{"name", chart.name}, {"title", chart.title}, {"spec", chart.spec}});
    // The page replaces rows by this data name.
    each["spec"]["data"]["name"] = "rows";
    if (chart.live.is_object()) {
      each["live"] = chart.live;
    }
  }
  if (report.explorer.is_object()) {
    data["explorer"] = report.explorer;
  }
  return data;
}

// Puts texts in the place of {{names}}; what is put in is not looked at again.
std::string fill(std::string_view page, const std::map<std::string_view, std::string>& parts) {
  std::string filled;
  while (!page.empty()) {
    const std::size_t begin = page.find("{{");
    filled += page.substr(0, begin);
    if (begin == std::string_view::npos) {
      break;
    }
    const std::size_t end = page.find("}}", begin);
    const auto part =
        end == std::string_view::npos ? parts.end() : parts.find(page.substr(begin + 2, end - begin - 2));
    sim::ensure(part != parts.end(), "the report's page asks for a part that there is not");
    filled += part->second;
    page.remove_prefix(end + 2);
  }
  return filled;
}

}  // namespace

std::string report_page(const ReportData& report, std::span<const Script> scripts) {
  return report_page(report, page_sections(report), scripts);
}

Json page_parts(const ReportData& report) {
  Json parts = data_of(report);
  parts["about"] = report.about;
  parts["answer"] = report.answer;
  for (const PageSection& section : page_sections(report)) {
    parts["sections"][section.id] = section.html;
  }
  return parts;
}

std::string report_page(const ReportData& report, std::span<const PageSection> parts,
                        std::span<const Script> scripts, const std::optional<LivePage>& live) {
  std::string policy = "default-src 'none'; img-src data:; base-uri 'none'; form-action 'none'; style-src" +
                       source_of(report_page_css());
  std::string style(report_page_css().text);
  if (live) {
    policy += source_of(live->style) + "; connect-src 'self'";
    style += "</style>\n<style>" + std::string(live->style.text);
  }
  policy += "; script-src";
  std::vector<Script> all(scripts.begin(), scripts.end());
  all.insert(all.end(), {report_chart_style_js(), report_theme_js(), report_tooltip_js(), report_charts_js(),
                         report_sorting_js()});
  if (report.explorer.is_object()) {
    all.insert(all.end(), {report_explorer_rows_js(), report_explorer_specs_js(), report_address_js(),
                           report_numbers_js(), report_points_filter_js(), report_points_table_js(),
                           report_chosen_point_js(), report_controls_js(), report_explorer_js()});
  }
  all.push_back(report_main_js());
  if (live) {
    all.insert(all.end(), live->scripts.begin(), live->scripts.end());
  }
  std::string script_elements;
  for (const Script& script : all) {
    policy += source_of(script);
    script_elements += "<script>" + std::string(script.text) + "</script>\n";
  }
  std::string contents;
  std::string sections;
  for (const PageSection& section : parts) {
    contents += "<li><a href=\"#" + section.id + "\">" + section.title + "</a></li>\n";
    sections += "<section id=\"" + section.id + "\" aria-labelledby=\"title-of-" + section.id +
                "\"><h2 id=\"title-of-" + section.id + "\">" + section.title + "</h2>\n" + section.html +
                "</section>\n";
  }
  return fill(report_page_html(),
              {{"policy", policy},
               {"version", html_text(version)},
               {"title", html_text(report.title)},
               {"about", report.about.empty() ? std::string()
                                              : "<p class=\"about\">" + html_text(report.about) + "</p>\n"},
               {"style", style},
               {"contents", contents},
               {"sections", sections},
               {"complete", live ? "" : " This file is complete: it loads nothing."},
               {"data", script_json(data_of(report))},
               {"scripts", script_elements}});
}

}  // namespace marti::studies::report
