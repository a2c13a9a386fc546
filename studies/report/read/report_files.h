// Images and charts that a run or a study has written beside its results, for its report. Anybody may have
// changed them, so they are checked.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "studies/report/model/report_data.h"

namespace marti::studies::report {

/// Paths of the files in `directory` whose names end in `ending`, by name. UserError when it cannot be read.
[[nodiscard]] std::vector<std::filesystem::path> files_ending_in(const std::filesystem::path& directory,
                                                                 std::string_view ending);

/// Takes a PNG file into the report, with `scale` as ReportImage::scale; of one with more than 16 MiB only a
/// sentence says that it is left out. UserError when it cannot be read, is not a PNG file or has been cut
/// off.
void take_image(const std::filesystem::path& file, const std::string& title, ReportData& report,
                const std::string& scale = {});

/// The rows of a chart that a run has written. UserError unless they stand in data.values, an object of
/// numbers and texts each.
[[nodiscard]] nlohmann::ordered_json read_chart_rows(const std::filesystem::path& file);

}  // namespace marti::studies::report
