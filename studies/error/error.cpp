#include "studies/error/error.h"

#include <fmt/format.h>

#include <iterator>
#include <utility>
#include <vector>

#include "studies/error/error_keys.h"
#include "studies/error/rendering.h"
#include "studies/error/simulator_tables.h"
#include "studies/tables/provenance.h"
#include "studies/tables/text_table.h"
#include "studies/tables/text_units.h"

namespace marti::studies::error {

namespace {

// Appends one family's part of the study.
void append(tables::StudyOutput& output, tables::StudyOutput part) {
  std::move(part.tables.begin(), part.tables.end(), std::back_inserter(output.tables));
  std::move(part.host_tables.begin(), part.host_tables.end(), std::back_inserter(output.host_tables));
  std::move(part.images.begin(), part.images.end(), std::back_inserter(output.images));
  output.report += part.report;
  output.host_report += part.host_report;
}

tables::StudyOutput simulator_error(const ErrorConfig& config) {
  const SimulatorStudy study = study_simulator(config);
  const std::vector<MethodErrors> errors = errors_of(study);
  tables::StudyOutput part;
  part.tables = {method_table(study, errors), figure_table(study, errors), case_table(study),
                 level_table(study), measured_table(study)};
  part.host_tables = {time_table(study, errors), fastest_table(study, errors)};
  part.report = fmt::format("Simulator: {} on {}\n\n{}\n{}\n", tables::counted(study.cases.size(), "machine"),
                            tables::counted(study.cases.back().frame + 1, "frame"),
                            tables::text_of(part.tables[0]), tables::text_of(part.tables[3]));
  part.host_report =
      fmt::format("Simulator: run time, {}\n\n{}\n{}\n", tables::counted(config.repeats, "repeat"),
                  tables::text_of(part.host_tables[0]), tables::text_of(part.host_tables[1]));
  return part;
}

}  // namespace

tables::StudyOutput run_error(sim::Config& config, sim::WorkMeter* meter) {
  ErrorConfig error = read_error(config);
  error.frame.meter = meter;
  tables::StudyOutput output;
  for (const ErrorFamily family : error.families) {
    append(output, family == ErrorFamily::simulator ? simulator_error(error)
                                                    : rendering_error(error.frame, error.rendering));
  }
  output.tables.push_back(tables::provenance_table(config.effective_values()));
  output.host_tables.push_back(tables::host_table());
  return output;
}

}  // namespace marti::studies::error
