// Files beside the results that a report takes in as they are. Each may have been changed by anybody.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "studies/report/report_charts.h"

namespace marti::studies {

/// Is there something of this name?
[[nodiscard]] bool is_there(const std::filesystem::path& file);

/// Paths of the files in `directory` whose names end in `ending`, by name. UserError when it cannot be read.
[[nodiscard]] std::vector<std::filesystem::path> files_ending_in(const std::filesystem::path& directory,
                                                                 std::string_view ending);

/// A PNG file of at most 16 MiB. UserError when it cannot be read or is none.
[[nodiscard]] ReportImage read_image(const std::filesystem::path& file, const std::string& title);

/// A chart that a run or a study has written. UserError unless it is a Vega-Lite specification whose rows
/// stand in data.values, an object each, and that asks for nothing from outside the file.
[[nodiscard]] ReportChart read_chart(const std::filesystem::path& file);

}  // namespace marti::studies
