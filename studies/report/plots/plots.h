// The charts of a report as files for papers.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "studies/report/model/report_data.h"

namespace marti::studies::report {

/// A file that is still to be written.
struct Plot {
  std::string file;  ///< its name
  std::string content;
};

/// Draws NAME.svg and NAME.csv for each chart, and with `pdf` also NAME.pdf; they are meant for `directory`,
/// which need not be there. The same charts give the same bytes; those of a PDF depend on the fonts of the
/// host. Needs node, and for PDF rsvg-convert. Throws UserError with the reason. A directory that holds
/// results is refused: a plot's data could replace a table of theirs.
[[nodiscard]] std::vector<Plot> draw_plots(const ReportData& report, const std::filesystem::path& directory,
                                           bool pdf);

}  // namespace marti::studies::report
