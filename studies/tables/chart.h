// Charts: Vega-Lite specifications (studies/tables/charts/*.vl.json, built into the program) with a table's
// rows inlined, so that any viewer of Vega-Lite shows them.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "studies/tables/table.h"

namespace marti::studies::tables {

/// A specification as it stands in studies/tables/charts/. Its data names the table that it shows:
/// "data": {"name": "figure1"}.
struct ChartSpecification {
  std::string_view name;  ///< the file's, without .vl.json
  std::string_view json;
};

/// All of them, in alphabetical order.
[[nodiscard]] std::span<const ChartSpecification> chart_specifications();

/// The chart of this name. Throws InternalError if no chart has it.
[[nodiscard]] const ChartSpecification& chart_named(std::span<const ChartSpecification> charts,
                                                    std::string_view name);

/// The name of the table that a specification shows. Throws InternalError when it names none.
[[nodiscard]] std::string table_of(const ChartSpecification& chart);

/// The specification with rows as its data. Where "usermeta": {"lines": FIELD} says that each value of a
/// field has a line of its own and there are more than `most_chart_lines`, they are shared out among panels.
[[nodiscard]] nlohmann::ordered_json chart_json(const ChartSpecification& chart, nlohmann::ordered_json rows);
inline constexpr std::size_t most_chart_lines = 4;

/// The same with the table's rows, as text; a value that is missing, NaN or infinite is null. Text that is
/// not UTF-8 is shown with replacement characters.
[[nodiscard]] std::string fill_chart(const ChartSpecification& chart, const Table& table);

/// Each of chart_specifications() whose table is among `tables` and has rows, with that table.
[[nodiscard]] std::vector<std::pair<const ChartSpecification*, const Table*>> charts_of(
    std::span<const Table> tables);

}  // namespace marti::studies::tables
