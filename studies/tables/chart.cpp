#include "studies/tables/chart.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "sim/error.h"
#include "studies/tables/json_table.h"

namespace marti::studies {

namespace {

using Json = nlohmann::ordered_json;

}  // namespace

const ChartSpecification& chart_named(std::span<const ChartSpecification> charts, std::string_view name) {
  const auto found = std::find_if(charts.begin(), charts.end(),
                                  [&](const ChartSpecification& chart) { return chart.name == name; });
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

std::string fill_chart(const ChartSpecification& chart, const Table& table) {
  Json specification = Json::parse(chart.json);
  specification["data"] = {{"name", table.name()}, {"values", rows_json(table)}};
  return json_text(specification);
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

}  // namespace marti::studies
