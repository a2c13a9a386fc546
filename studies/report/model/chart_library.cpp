#include "studies/report/model/chart_library.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "studies/report/model/result_tables.h"
#include "studies/tables/cell_number.h"
#include "studies/tables/json_table.h"

namespace marti::studies::report {

namespace {

using Json = nlohmann::ordered_json;

ReportChart chart_with(std::string_view specification, const std::string& name, const std::string& title,
                       const Json& rows, const ChartWords& words = {}) {
  const tables::ChartSpecification& file = tables::chart_named(report_chart_specifications(), specification);
  ReportChart chart;
  chart.name = name;
  chart.title = title;
  chart.spec = Json::parse(replaced(std::string(file.json), words));
  chart.spec.erase("usermeta");
  chart.spec["title"] = title;
  chart.spec["data"] = {{"name", "rows"}, {"values", rows}};
  return chart;
}

// Lets the reader choose among the values that a column of the rows has; at first it is that of the first
// row. The specification knows what is chosen as `choice`.
void add_choice(Json& spec, const std::string& column, const Json& rows) {
  Json options = Json::array();
  for (const Json& row : rows) {
    if (std::ranges::find(options, row.at(column)) == options.end()) {
      options.push_back(row.at(column));
    }
  }
  spec["params"] = {{{"name", "choice"},
                     {"value", options.at(0)},
                     {"bind", {{"input", "select"}, {"name", column + " "}, {"options", options}}}}};
}

tables::ColumnType type_of(const std::string& name) {
  return name == "integer" ? tables::ColumnType::integer
         : name == "real"  ? tables::ColumnType::real
                           : tables::ColumnType::text;
}

tables::Table table_with(const std::string& name, const std::string& title, const Json& columns,
                         const Json& rows) {
  std::vector<tables::Column> described;
  for (const Json& column : columns) {
    described.push_back(
        {column.at("name"), type_of(column.at("type")), column.at("unit"), column.at("description")});
  }
  tables::Table table(name, title, described);
  for (const Json& row : rows) {
    std::vector<tables::Cell> cells;
    for (const tables::Column& column : described) {
      cells.push_back(tables::as_type(tables::cell_of(row.at(column.name)), column.type));
    }
    table.add_row(std::move(cells));
  }
  return table;
}

}  // namespace

std::vector<DescribedChart> described_charts(std::string_view of) {
  std::vector<DescribedChart> all;
  for (const tables::ChartSpecification& specification : report_chart_specifications()) {
    const Json meta = Json::parse(specification.json).value("usermeta", Json::object());
    if (meta.value("of", "") == of) {
      for (const Json& each : meta.contains("charts") ? meta.at("charts") : Json::array({meta})) {
        all.push_back({specification.name, each});
      }
    }
  }
  std::ranges::stable_sort(all, {},
                           [](const DescribedChart& chart) { return chart.meta.at("order").get<int>(); });
  return all;
}

std::string query_of(const Json& meta) {
  std::string sql;
  for (const Json& line : meta.at("sql")) {
    sql += line.get<std::string>() + "\n";
  }
  return sql;
}

std::string replaced(std::string text, const ChartWords& words) {
  for (const auto& [word, other] : words) {
    for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos; at += other.size()) {
      text.replace(at, word.size(), other);
    }
  }
  return text;
}

void add_queried(const tables::RunJson& run, ReportData& report) {
  ResultTables result(run);
  for (const auto& [file, meta] : described_charts("run")) {
    const Json rows = result.rows(query_of(meta));
    if (rows.empty()) {
      continue;
    }
    const std::string name = meta.value("name", std::string(file));
    if (meta.contains("columns")) {
      report.tables.push_back(
          {table_with(name, meta.at("title"), meta.at("columns"), rows), meta.at("folded")});
    } else {
      report.charts.push_back(chart_with(file, name, meta.at("title"), rows));
      report.charts.back().note = meta.value("note", "");
      if (meta.contains("choice")) {
        add_choice(report.charts.back().spec, meta.at("choice"), rows);
      }
    }
  }
}

ReportChart make_chart(std::string_view specification, const tables::Table& table, const std::string& note) {
  ReportChart chart = chart_with(specification, table.name(), table.title(), tables::rows_json(table));
  chart.note = note;
  return chart;
}

ReportChart live_chart(std::string_view specification, const std::string& name, const std::string& title,
                       const Json& live, const ChartWords& words) {
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
