#include "studies/report/read/read_report.h"

#include <filesystem>

#include "sim/error.h"
#include "studies/report/model/sweep_report.h"
#include "studies/report/read/read_points.h"
#include "studies/sweep/store/store_schema.h"
#include "studies/tables/sqlite_connection.h"

namespace marti::studies::report {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view expected =
    "expected is the directory of `marti run CONFIG -o DIR`, `marti sweep CONFIG -o DIR` or `marti study "
    "... -o "
    "DIR`, or DIR:N for point N of a sweep";

// Sweeps and studies both have a results.sqlite; its table `columns` differs. Other faults of the file are
// reported by the code that reads it.
bool is_study(const fs::path& file) {
  (void)sweep::check_store_file(file);
  tables::SqliteConnection connection(file, tables::SqliteConnection::Access::read);
  return connection.value<std::int64_t>(
             "SELECT count(*) FROM pragma_table_info('columns') WHERE name = 'table_name'") != 0;
}

}  // namespace

ReportData read_report(const fs::path& directory, std::optional<double> budget) {
  const auto refuse_budget = [&] {
    if (budget) {
      throw sim::UserError("--budget: chooses among the machines of a sweep, and " + directory.string() +
                           " is none; leave it out");
    }
  };
  std::error_code error;
  const fs::file_status status = fs::status(directory, error);
  if (status.type() == fs::file_type::not_found) {
    if (const std::optional<tables::PointName> point = tables::point_named(directory.string())) {
      refuse_budget();
      return read_point_report(*point);
    }
    throw sim::UserError(directory.string() + ": there is no such directory; " + std::string(expected));
  }
  if (error) {
    throw sim::UserError(directory.string() + ": cannot be read: " + error.message());
  }
  if (!fs::is_directory(status)) {
    throw sim::UserError(directory.string() + ": is no directory; " + std::string(expected));
  }
  const fs::path file = tables::results_in(directory, expected);
  if (file.extension() == ".json") {
    refuse_budget();
    return read_run_report(directory);
  }
  if (is_study(file)) {
    refuse_budget();
    return read_study_report(directory);
  }
  const ReportPoints sweep = read_report_points(file);
  if (budget && !sweep.priced) {
    throw sim::UserError(
        "--budget: all machines of " + directory.string() +
        " have the same cost by [prices], so that a budget cannot choose among them; leave it out");
  }
  return sweep_report(sweep, budget);
}

}  // namespace marti::studies::report
