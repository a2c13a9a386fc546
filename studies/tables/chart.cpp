#include "studies/tables/chart.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "sim/error.h"
#include "studies/tables/json_table.h"

namespace marti::studies::tables {

namespace {

using Json = nlohmann::ordered_json;

// Gives each row the number of its panel, by its place among the values of the field. Returns how many panels
// there are.
std::size_t share_out(const std::string& field, Json& rows) {
  std::vector<Json> lines;
  for (Json& row : rows) {
    const auto known = std::ranges::find(lines, row.at(field));
    const auto place = static_cast<std::size_t>(known - lines.begin());
    if (known == lines.end()) {
      lines.push_back(row.at(field));
    }
    row["panel"] = place / most_chart_lines;
  }
  return (lines.size() + most_chart_lines - 1) / most_chart_lines;
}

// The chart once for each panel, below each other; each panel begins with the first colour.
void make_panels(Json& chart) {
  Json panel = Json::object();
  for (const char* part : {"width", "height", "mark", "layer", "encoding"}) {
    if (chart.contains(part)) {
      panel[part] = std::move(chart[part]);
      chart.erase(part);
    }
  }
  chart["facet"] = {{"field", "panel"}, {"type", "ordinal"}, {"title", nullptr}, {"header", nullptr}};
  chart["columns"] = 1;
  chart["spec"] = std::move(panel);
  chart["resolve"] = {{"scale", {{"color", "independent"}, {"shape", "independent"}}}};
}

}  // namespace

const ChartSpecification& chart_named(std::span<const ChartSpecification> charts, std::string_view name) {
  const auto found = std::ranges::find(charts, name, &ChartSpecification::name);
  if (found == charts.end()) {
    throw sim::InternalError("there is no chart specification " + std::string(name));
  }
  return *found;
}

std::string table_of(const ChartSpecification& chart) {
  const Json specification = Json::parse(chart.json);
  const auto data = specification.find("data");
  if (data == specification.end() || !data->contains("name")) {
    throw sim::InternalError("chart " + std::string(chart.name) + " names no table");
  }
  return data->at("name").get<std::string>();
}

Json chart_json(const ChartSpecification& chart, Json rows) {
  Json made = Json::parse(chart.json);
  const Json::json_pointer lines("/usermeta/lines");
  if (made.contains(lines) && share_out(made[lines].get<std::string>(), rows) > 1) {
    make_panels(made);
  }
  made["data"] = {{"name", table_of(chart)}, {"values", std::move(rows)}};
  return made;
}

std::string fill_chart(const ChartSpecification& chart, const Table& table) {
  return json_text(chart_json(chart, rows_json(table)));
}

std::vector<std::pair<const ChartSpecification*, const Table*>> charts_of(std::span<const Table> tables) {
  std::vector<std::pair<const ChartSpecification*, const Table*>> charts;
  for (const ChartSpecification& chart : chart_specifications()) {
    const std::string wanted = table_of(chart);
    for (const Table& table : tables) {
      if (table.name() == wanted && !table.rows().empty()) {
        charts.emplace_back(&chart, &table);
      }
    }
  }
  return charts;
}

}  // namespace marti::studies::tables
