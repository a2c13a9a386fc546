#include "studies/tables/json_table.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "sim/mapped.h"

namespace marti::studies::tables {

namespace {

using Json = nlohmann::ordered_json;

}  // namespace

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

Cell cell_of(const Json& value) {
  if (value.is_null()) {
    return {};
  }
  if (value.is_number_integer() && !(value.is_number_unsigned() && value.get<std::uint64_t>() > INT64_MAX)) {
    return value.get<std::int64_t>();
  }
  if (value.is_number()) {
    return value.get<double>();
  }
  return value.is_string() ? value.get<std::string>()
                           : value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string json_text(const Json& json) {
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Json rows_json(const Table& table) {
  Json rows = Json::array();
  for (const std::vector<Cell>& row : table.rows()) {
    Json object = Json::object();
    for (std::size_t i = 0; i < row.size(); ++i) {
      const auto* flag = std::get_if<std::int64_t>(&row[i]);
      const bool boolean = flag != nullptr && table.columns()[i].type == ColumnType::boolean;
      object[table.columns()[i].name] = boolean ? Json(*flag != 0) : json_of(row[i]);
    }
    rows.push_back(std::move(object));
  }
  return rows;
}

Json table_json(const Table& table) {
  const Json columns = sim::mapped(table.columns(), [&](const Column& column) {
    return Json{{"name", column.name}, {"unit", column.unit}, {"description", column.description}};
  });
  return {{"name", table.name()}, {"title", table.title()}, {"columns", columns}, {"rows", rows_json(table)}};
}

std::string json_of(const Table& table) { return json_text(table_json(table)); }

}  // namespace marti::studies::tables
