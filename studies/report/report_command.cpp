#include "studies/report/report_command.h"

#include <algorithm>
#include <filesystem>
#include <span>
#include <vector>

#include "sim/error.h"
#include "sim/made_directory.h"
#include "studies/host/signals_held.h"
#include "studies/report/page/report_page.h"
#include "studies/report/plots/plots.h"
#include "studies/report/plots/vega_bundle.h"
#include "studies/report/read/read_report.h"
#include "studies/tables/page_file.h"
#include "studies/tables/pending_files.h"
#include "studies/tables/result_directory.h"

namespace marti::studies::report {

namespace {

namespace fs = std::filesystem;

// DIR/report.html, or DIR/point-N.html.
fs::path page_of(const std::string& results) {
  std::error_code ignored;
  const std::optional<tables::PointName> point =
      fs::is_directory(results, ignored) ? std::nullopt : tables::point_named(results);
  return point ? tables::directory_of(point->store) / ("point-" + std::to_string(point->ordinal) + ".html")
               : fs::path(results) / tables::report_page_name;
}

void check_apart(const fs::path& file, const fs::path& directory, std::span<const Plot> plots) {
  std::error_code ignored;
  for (const Plot& plot : plots) {
    if (fs::weakly_canonical(file, ignored) == fs::weakly_canonical(directory / plot.file, ignored)) {
      throw sim::UserError(file.string() +
                           ": is also the name of a plot; choose another name for the page with -o");
    }
  }
}

// The page and the plots, all or none.
std::vector<fs::path> write_all(const fs::path& file, const std::string& page, const fs::path& directory,
                                std::span<const Plot> plots) {
  const host::SignalsHeld held;
  tables::PendingFiles pending_page(tables::directory_of(file));
  pending_page.write(file.filename().string(), tables::sealed(page));
  const sim::MadeDirectory made = directory.empty() ? sim::MadeDirectory() : sim::MadeDirectory(directory);
  tables::PendingFiles pending_plots(directory);
  for (const Plot& plot : plots) {
    pending_plots.write(plot.file, plot.content);
  }
  std::vector<fs::path> files = directory.empty() ? std::vector<fs::path>() : pending_plots.commit_set();
  (void)pending_page.commit();
  files.push_back(file);
  return files;
}

}  // namespace

void report_command(const ReportArguments& arguments, void (*print)(const std::string&)) {
  if (arguments.directory.empty()) {
    throw sim::UserError("marti report: DIR is empty; give the directory of a run, a sweep or a study");
  }
  if (arguments.pdf && arguments.plots.empty()) {
    throw sim::UserError("--pdf: goes with --plots DIR, the directory for the files, which is missing");
  }
  const fs::path file = arguments.output.empty() ? page_of(arguments.directory) : fs::path(arguments.output);
  const ReportData report = read_report(arguments.directory, arguments.budget);
  require_vega_scripts();
  tables::check_page_target(file);
  const std::string page = report_page(report, vega_scripts());
  std::vector<Plot> plots;
  if (!arguments.plots.empty()) {
    plots = draw_plots(report, arguments.plots, arguments.pdf);
    check_apart(file, arguments.plots, plots);
  }
  std::string text;
  for (const std::string& sentence : report.answer) {
    text += sentence + "\n";
  }
  for (const fs::path& written : write_all(file, page, arguments.plots, plots)) {
    text += "wrote " + written.string() + "\n";
  }
  print(text);
}

}  // namespace marti::studies::report
