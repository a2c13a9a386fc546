// The charts of a report as files for papers.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "studies/report/report_charts.h"

namespace marti::studies {

/// Writes into `directory`, which is made if it is not there, NAME.svg and NAME.csv for each chart, and with
/// `pdf` also NAME.pdf. The same charts give the same bytes; those of a PDF depend on the fonts of the host.
/// All files are written under temporary names first and renamed together at the end. Returns the files.
/// Needs node, and for PDF rsvg-convert. Throws UserError with the reason; older files stay as they were
/// then. A directory that holds results is refused: a plot's data could replace a table of theirs.
std::vector<std::filesystem::path> write_plots(std::span<const ReportChart> charts,
                                               const std::filesystem::path& directory, bool pdf);

}  // namespace marti::studies
