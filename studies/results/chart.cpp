#include "studies/results/chart.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "sim/error.h"

namespace marti::studies {

namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Cell& cell) {
  if (const auto* integer = std::get_if<std::int64_t>(&cell)) {
    return *integer;
  }
  if (const auto* real = std::get_if<double>(&cell)) {
    return std::isfinite(*real) ? Json(*real) : Json();
  }
  if (const auto* text = std::get_if<std::string>(&cell)) {
    return *text;
  }
  return {};
}

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
  Json values = Json::array();
  for (const std::vector<Cell>& row : table.rows()) {
    Json object = Json::object();
    for (std::size_t i = 0; i < row.size(); ++i) {
      object[table.columns()[i].name] = json_of(row[i]);
    }
    values.push_back(std::move(object));
  }
  specification["data"] = {{"name", table.name()}, {"values", std::move(values)}};
  return specification.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace marti::studies
