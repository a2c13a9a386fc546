#include "studies/limits/limit_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "sim/joined.h"
#include "sim/mapped.h"
#include "studies/sweep/store/points_table.h"
#include "studies/tables/cell_number.h"
#include "studies/tables/text_units.h"

namespace marti::studies::limits {

namespace {

// "limits        node.clock of 612 points, machine.nodes of 388"
std::string limits_line(const std::map<std::string, std::size_t>& count, std::size_t open) {
  std::vector<std::pair<std::string, std::size_t>> names(count.begin(), count.end());
  std::ranges::stable_sort(names, std::greater{}, &std::pair<std::string, std::size_t>::second);
  std::string text;
  for (const auto& [name, points] : names) {
    text += fmt::format("{}{} of {}", text.empty() ? "limits        " : ", ", name,
                        text.empty() ? tables::counted(points, "point") : tables::grouped(points));
  }
  if (open > 0) {
    text += fmt::format("; of {} another key may save more (limit_open)", tables::counted(open, "point"));
  }
  return text.empty() ? text : text + "\n";
}

}  // namespace

LimitedPoints limited_points(const sweep::SweepReader& sweep, const std::optional<keys::Prices>& prices) {
  tables::Table table = sweep::points_table(sweep);
  const StoredLimits limits(sweep, prices);
  const std::size_t ordinal = table.column("ordinal");
  const std::array<tables::Column, 4> columns = {
      {tables::text_column("limit", "the key that a tenth better helps most (docs/sweep.md)"),
       tables::real_column("limit_saves", "fraction", "of the frame time that this saves, predicted"),
       tables::text_column("limit_rests_on", "what the prediction rests on"),
       tables::text_column("limit_open", "keys of which nothing is known that may save more")}};
  std::map<std::string, std::size_t> count;
  std::size_t open = 0;
  table.add_columns(columns, [&](std::span<const tables::Cell> row) -> std::vector<tables::Cell> {
    const std::optional<PointLimit> limit = limits.at(std::get<std::int64_t>(row[ordinal]));
    const PredictedStep* const best = limit ? limit->best() : nullptr;
    if (!limit) {
      return std::vector<tables::Cell>(columns.size());
    }
    ++count[best != nullptr ? best->name : "nothing known"];
    const std::string others = sim::joined(sim::mapped(limit->open(), &PredictedStep::name));
    open += others.empty() ? 0U : 1U;
    if (best == nullptr) {
      return {{}, {}, {}, others};
    }
    return {best->name, best->saved, best->rests_on, others};
  });
  return {std::move(table), limits_line(count, open)};
}

}  // namespace marti::studies::limits
