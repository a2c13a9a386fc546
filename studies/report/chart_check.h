// What a chart that stands in a file may hold. Anybody may have changed the file.
#pragma once

#include <filesystem>

#include "studies/report/report_charts.h"

namespace marti::studies {

/// UserError, which names the file and the path of the part, unless `chart` is made only of what the charts
/// of marti are made of: views, marks, encodings and transforms whose expressions call arithmetic functions,
/// over rows that stand in data.values, an object each. It must not make Vega load or generate data or put
/// elements into the page, nor hold more than the page can draw.
void check_chart(const std::filesystem::path& file, const nlohmann::ordered_json& chart);

}  // namespace marti::studies
