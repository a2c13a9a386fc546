// Files beside the results that a report takes in as they are. Each may have been changed by anybody.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "studies/report/report_charts.h"

namespace marti::studies {

/// A name as charts, files and elements of the page have it: every other character than lower-case letters
/// and digits becomes '_'.
[[nodiscard]] std::string plain_name(std::string name);

/// Whether a file or a link of this name exists, even a link to nothing. UserError when that cannot be told.
[[nodiscard]] bool is_there(const std::filesystem::path& file);

/// Paths of the files in `directory` whose names end in `ending`, by name. UserError when it cannot be read.
[[nodiscard]] std::vector<std::filesystem::path> files_ending_in(const std::filesystem::path& directory,
                                                                 std::string_view ending);

/// Takes a PNG file into the report; of one with more than 16 MiB only a sentence says that it is left out.
/// UserError when it cannot be read, is not a PNG file or has been cut off.
void take_image(const std::filesystem::path& file, const std::string& title, ReportData& report);

/// A chart that a run or a study has written. UserError unless it is a Vega-Lite specification whose rows
/// stand in data.values, an object each, and that has no other data, neither loaded from outside the file nor
/// generated.
[[nodiscard]] ReportChart read_chart(const std::filesystem::path& file);

}  // namespace marti::studies
