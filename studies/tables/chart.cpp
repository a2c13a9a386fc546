#include "studies/tables/chart.h"

#include <nlohmann/json.hpp>

#include "sim/error.h"
#include "studies/tables/json_table.h"

namespace marti::studies {

namespace {

using Json = nlohmann::ordered_json;

}  // namespace

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

}  // namespace marti::studies
