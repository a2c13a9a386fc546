// `marti memory`: a configuration's interconnect, shared second level and banks or DRAM, driven by a trace;
// if asked for, with the private caches of the nodes before them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "sim/config.h"
#include "sim/work_meter.h"
#include "studies/tables/study_files.h"

namespace marti::studies::driven {

struct DrivenChoices {
  std::uint32_t outstanding = 16;  ///< reads of a node under way at a time
  bool caches = false;             ///< reads go through the nodes' private caches
  std::vector<std::string> axes;   ///< as of `marti sweep --axis`: the trace drives each of their memories
  bool json = false;
};

struct DrivenOutput {
  std::string printed;        ///< text or JSON
  tables::StudyOutput files;  ///< what a page shows of it
};

/// Serves the trace's requests with the memory of the configuration, whose nodes and scene it does not use,
/// and returns what came out: latency of reads, and the figures of the catalogue that the memory has; with
/// axes a table, or an array, of the configurations. Throws UserError for a configuration
/// without a shared memory and for a wrong trace.
[[nodiscard]] DrivenOutput drive(sim::Config& config, const std::filesystem::path& trace,
                                 const DrivenChoices& choices, sim::WorkMeter* meter);

}  // namespace marti::studies::driven
