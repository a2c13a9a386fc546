#include "studies/tables/study_files.h"

#include <cstdint>
#include <optional>
#include <string>

#include "sim/error.h"
#include "studies/host/image_file.h"
#include "studies/host/signals_held.h"
#include "studies/tables/chart.h"
#include "studies/tables/csv.h"
#include "studies/tables/page_file.h"
#include "studies/tables/pending_files.h"
#include "studies/tables/result_directory.h"
#include "studies/tables/sqlite.h"
#include "studies/tables/sqlite_connection.h"

namespace marti::studies::tables {

namespace fs = std::filesystem;

std::vector<fs::path> write_study(const StudyOutput& output, const fs::path& directory) {
  const host::SignalsHeld held;
  PendingFiles files(directory);
  std::vector<Table> all = output.tables;
  all.insert(all.end(), output.host_tables.begin(), output.host_tables.end());
  const Table columns = describe_columns(all);
  for (const Table& table : all) {
    files.write(table.name() + ".csv", csv_of(table));
  }
  files.write("columns.csv", csv_of(columns));
  for (const auto& [chart, table] : charts_of(all)) {
    files.write(std::string(chart->name) + ".vl.json", fill_chart(*chart, *table));
  }
  for (const StudyImage& image : output.images) {
    files.write(image.name + ".exr", host::exr_file(image.image));
    files.write(image.name + ".png", host::png_file(image.image));
  }
  files.write("report.txt", output.report);
  if (!output.host_report.empty()) {
    files.write("host.txt", output.host_report);
  }
  all.push_back(columns);
  write_database(files.add(database_name), all);
  std::vector<fs::path> written = files.commit_set();
  remove_sealed_page(directory / report_page_name);  // of the results that were there before
  return written;
}

void refuse_store_of_sweep(const fs::path& directory) {
  const fs::path file = directory / database_name;
  if (directory.empty() || !is_there(file)) {
    return;
  }
  // The store of a sweep has an application's number (studies/sweep/store), the database of a study none.
  std::optional<std::int64_t> application;
  try {
    application =
        SqliteConnection(file, SqliteConnection::Access::read).value<std::int64_t>("PRAGMA application_id");
  } catch (const sim::UserError&) {
    return;  // no database
  }
  if (application != 0) {
    throw sim::UserError(
        file.string() +
        ": is the store of a sweep, which a study does not replace; give another directory, or "
        "remove the file");
  }
}

}  // namespace marti::studies::tables
