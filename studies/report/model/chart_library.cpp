#include "studies/report/model/chart_library.h"

#include <nlohmann/json.hpp>

#include "studies/tables/json_table.h"

namespace marti::studies::report {

namespace {

using Json = nlohmann::ordered_json;

ReportChart chart_with(std::string_view specification, const std::string& name, const std::string& title,
                       const Json& rows, ChartWords words = {}) {
  std::string text(tables::chart_named(report_chart_specifications(), specification).json);
  for (const auto& [word, other] : words) {
    for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos; at += other.size()) {
      text.replace(at, word.size(), other);
    }
  }
  ReportChart chart;
  chart.name = name;
  chart.title = title;
  chart.spec = Json::parse(text);
  chart.spec["title"] = title;
  chart.spec["data"] = {{"name", "rows"}, {"values", rows}};
  return chart;
}

}  // namespace

ReportChart make_chart(std::string_view specification, const tables::Table& table, const std::string& note) {
  ReportChart chart = chart_with(specification, table.name(), table.title(), tables::rows_json(table));
  chart.note = note;
  return chart;
}

ReportChart live_chart(std::string_view specification, const std::string& name, const std::string& title,
                       const Json& live, ChartWords words) {
  ReportChart chart = chart_with(specification, name, title, Json::array(), words);
  chart.live = live;
  return chart;
}

ReportChart chart_of_results(const tables::ChartSpecification& specification, const Json& rows) {
  ReportChart chart;
  chart.name = specification.name;
  chart.spec = tables::chart_json(specification, rows);
  chart.title = chart.spec.value("title", chart.name);
  return chart;
}

std::string plain_name(std::string name) {
  for (char& c : name) {
    const bool kept = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
    c = kept ? c : '_';
  }
  return name;
}

}  // namespace marti::studies::report
