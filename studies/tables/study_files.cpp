#include "studies/tables/study_files.h"

#include <string>

#include "studies/host/image_file.h"
#include "studies/host/signals_held.h"
#include "studies/tables/chart.h"
#include "studies/tables/csv.h"
#include "studies/tables/pending_files.h"
#include "studies/tables/sqlite.h"

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
    host::write_exr(image.image, files.add(image.name + ".exr"));
    host::write_png(image.image, files.add(image.name + ".png"));
  }
  files.write("report.txt", output.report);
  if (!output.host_report.empty()) {
    files.write("host.txt", output.host_report);
  }
  all.push_back(columns);
  write_database(files.add("results.sqlite"), all);
  return files.commit();
}

}  // namespace marti::studies::tables
