#include "studies/report/rows_csv.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "studies/tables/csv.h"

namespace marti::studies {

namespace {

using Json = nlohmann::ordered_json;

std::string cell_of(const Json& value) {
  if (value.is_null()) {
    return {};
  }
  return csv_text(value.is_string() ? value.get<std::string>()
                                    : value.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace

std::string csv_of_rows(const Json& rows) {
  std::vector<std::string> columns;
  std::set<std::string> seen;
  for (const Json& row : rows) {
    for (const auto& [name, value] : row.items()) {
      if (seen.insert(name).second) {
        columns.push_back(name);
      }
    }
  }
  std::string text;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    text += (i == 0 ? "" : ",") + cell_of(columns[i]);
  }
  text += "\r\n";
  for (const Json& row : rows) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const auto at = row.find(columns[i]);
      text += (i == 0 ? "" : ",") + (at == row.end() ? std::string() : cell_of(*at));
    }
    text += "\r\n";
  }
  return text;
}

}  // namespace marti::studies
