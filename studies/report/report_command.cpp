#include "studies/report/report_command.h"

#include <filesystem>

#include "sim/error.h"
#include "sim/files.h"
#include "studies/report/plots.h"
#include "studies/report/report_charts.h"
#include "studies/report/report_page.h"
#include "studies/report/vega_bundle.h"

namespace marti::studies {

void report_command(const ReportArguments& arguments, void (*print)(const std::string&)) {
  namespace fs = std::filesystem;
  if (arguments.pdf && arguments.plots.empty()) {
    throw sim::UserError("--pdf: goes with --plots DIR, the directory for the files, which is missing");
  }
  const ReportData report = read_report(arguments.directory);
  if (!have_vega_scripts()) {
    throw sim::UserError(
        "marti report: this program was built without the scripts that draw charts; install node and npm "
        "(Debian: "
        "nodejs, npm), and configure and build again with -DMARTI_REPORT=ON");
  }
  const fs::path file =
      arguments.output.empty() ? fs::path(arguments.directory) / "report.html" : fs::path(arguments.output);
  const std::string page = report_page(report, vega_scripts());
  std::string text;
  for (const std::string& sentence : report.answer) {
    text += sentence + "\n";
  }
  if (!arguments.plots.empty()) {
    for (const fs::path& plot : write_plots(report.charts, arguments.plots, arguments.pdf)) {
      text += "wrote " + plot.string() + "\n";
    }
  }
  sim::write_file(file, page);
  print(text + "wrote " + file.string() + "\n");
}

}  // namespace marti::studies
