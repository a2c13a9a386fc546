#include <nlohmann/json.hpp>

#include "studies/show/result_parts.h"
#include "studies/tables/json_table.h"

namespace marti::studies::show {

nlohmann::ordered_json intervals_json(const run::RunResult& result) {
  using Json = nlohmann::ordered_json;
  if (!result.intervals) {
    return nullptr;
  }
  Json columns = Json::object();
  for (std::size_t i = 0; i < result.intervals->columns().size(); ++i) {
    const tables::Column& column = result.intervals->columns()[i];
    Json values = Json::array();
    for (const std::vector<tables::Cell>& row : result.intervals->rows()) {
      values.push_back(tables::json_of(row[i]));
    }
    columns[column.name] = {{"unit", column.unit}, {"values", std::move(values)}};
  }
  return {{"count", result.intervals->rows().size()}, {"columns", std::move(columns)}};
}

}  // namespace marti::studies::show
