// `marti report DIR` and `marti report DIR:N`.
#pragma once

#include <optional>
#include <string>

namespace marti::studies::report {

struct ReportArguments {
  std::string directory;           ///< of a run, a sweep or a study; "DIR:N" for point N of a sweep
  std::string output;              ///< the page; empty: report.html, or point-N.html, in the directory
  std::string plots;               ///< directory for the charts as files; empty: none
  bool pdf = false;                ///< plots also as PDF
  std::optional<double> budget{};  ///< of a sweep: the price that a machine may have
};

/// Writes the page, and with `plots` the charts, and prints which files. Throws UserError for a directory
/// that is not a result, a program that was built without the scripts of the page, and files that cannot be
/// written; then no file is changed or added. A file that is not an HTML page is not replaced.
void report_command(const ReportArguments& arguments, void (*print)(const std::string&));

}  // namespace marti::studies::report
