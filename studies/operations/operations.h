// `marti study operations`: what each walk takes, operation by operation, beside what the paper says.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "processors/cost/operation_mix.h"
#include "sim/config.h"
#include "sim/work_meter.h"
#include "studies/operations/unit_length.h"
#include "studies/tables/study_files.h"

namespace marti::studies::operations {

/// One walk over the configured scene, counted.
struct WalkRow {
  std::string name;
  bool mailboxes = false;
  std::uint32_t side = 0;  ///< pixels of the image's longer side
  std::uint64_t nodes = 0;
  std::uint64_t entries = 0;
  processors::cost::MeasuredMixes measured;
};

struct OperationsStudy {
  std::string scene;
  std::uint32_t max_depth = 0;
  std::uint32_t max_objects = 0;
  std::uint32_t max_level = 0;
  std::vector<WalkRow> walks;
  std::vector<UnitLengthRow> lengths;
};

/// Counts all walks over the configured scene. Its image is made small, because counting is slow and brute
/// force slower. Every structure is built whatever structure.kind is. Reads a configuration of `marti run`,
/// whose machine it checks and does not use. Throws UserError as that does.
[[nodiscard]] OperationsStudy count_operations(sim::Config& config, sim::WorkMeter* meter = nullptr);

/// Report and tables: "operations" has a row for each walk and kind of step, "unit_length" one for each depth
/// and structure.
[[nodiscard]] tables::StudyOutput output_of(const OperationsStudy& study);

/// Runs the study: its report, its tables, and the provenance of its numbers.
/// `meter` is told how far the study is; null: nobody waits.
[[nodiscard]] tables::StudyOutput run_operations(sim::Config& config, sim::WorkMeter* meter = nullptr);

}  // namespace marti::studies::operations
