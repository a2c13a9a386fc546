// `marti memory`: a configuration's interconnect, shared second level and banks or DRAM, driven by a trace.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "sim/config.h"
#include "sim/work_meter.h"

namespace marti::studies::driven {

struct DrivenChoices {
  std::uint32_t outstanding = 16;  ///< reads of a node under way at a time
  bool json = false;
};

/// Serves the trace's requests with the memory of the configuration, whose nodes, caches and scene it does
/// not use, and returns what came out, as text or JSON: latency of reads, and the figures of the catalogue
/// that the memory has. Throws UserError for a configuration without a shared memory and for a wrong trace.
[[nodiscard]] std::string drive(sim::Config& config, const std::filesystem::path& trace,
                                const DrivenChoices& choices, sim::WorkMeter* meter);

}  // namespace marti::studies::driven
