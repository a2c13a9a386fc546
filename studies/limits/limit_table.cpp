#include "studies/limits/limit_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "studies/sweep/store/points_table.h"
#include "studies/tables/cell_number.h"
#include "studies/tables/text_units.h"

namespace marti::studies::limits {

namespace {

// "limits        node.clock of 612 points, machine.nodes of 388"
std::string limits_line(const std::map<std::string, std::size_t>& count) {
  std::vector<std::pair<std::string, std::size_t>> names(count.begin(), count.end());
  std::stable_sort(names.begin(), names.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  std::string text;
  for (const auto& [name, points] : names) {
    text += fmt::format("{}{} of {}", text.empty() ? "limits        " : ", ", name,
                        text.empty() ? tables::counted(points, "point") : tables::grouped(points));
  }
  return text.empty() ? text : text + "\n";
}

}  // namespace

LimitedPoints limited_points(const sweep::SweepReader& sweep, const std::optional<keys::Prices>& prices) {
  const tables::Table points = sweep::points_table(sweep);
  const StoredLimits limits(sweep, prices);
  std::vector<tables::Column> columns(points.columns().begin(), points.columns().end());
  const auto ordinal = static_cast<std::size_t>(
      std::find_if(columns.begin(), columns.end(),
                   [](const tables::Column& column) { return column.name == "ordinal"; }) -
      columns.begin());
  columns.push_back(
      {"limit", tables::ColumnType::text, "", "the key that a tenth better helps most (docs/sweep.md)"});
  columns.push_back(
      {"limit_saves", tables::ColumnType::real, "fraction", "of the frame time that this saves, predicted"});
  columns.push_back({"limit_rests_on", tables::ColumnType::text, "", "what the prediction rests on"});
  tables::Table table(points.name(), points.title(), columns);
  std::map<std::string, std::size_t> count;
  for (const std::vector<tables::Cell>& row : points.rows()) {
    std::vector<tables::Cell> cells = row;
    const std::optional<PointLimit> limit = limits.at(std::get<std::int64_t>(row.at(ordinal)));
    const PredictedStep* const best = limit ? limit->best() : nullptr;
    if (best != nullptr) {
      cells.insert(cells.end(), {best->name, best->saved, best->rests_on});
    } else {
      cells.insert(cells.end(), {tables::Cell(), tables::Cell(), tables::Cell()});
    }
    if (limit) {
      ++count[best != nullptr ? best->name : "nothing known"];
    }
    table.add_row(std::move(cells));
  }
  return {std::move(table), limits_line(count)};
}

}  // namespace marti::studies::limits
