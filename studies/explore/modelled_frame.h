// A frame time for the moment, while the exact one is not there yet.
#pragma once

#include <cstdint>
#include <optional>

#include "processors/machine/machine_config.h"
#include "processors/program/work_log.h"
#include "sim/work_meter.h"

namespace marti::studies::explore {

struct ModelledFrame {
  double end = 0.0;           ///< ps
  double end_of_one = 0.0;    ///< of the same machine with one node, ps
  std::uint64_t packets = 0;  ///< that were timed
  std::uint64_t of_packets = 0;
};

/// Times a few packets of the frame on one node, spread over the image. What all packets take follows from
/// the words that the log has of each, what nodes wait for each other from mean value analysis of the queues
/// that one node meets (processors/theory), and how unevenly they end from handing all packets out.
/// std::nullopt for a machine whose packets cannot be sampled. `meter` may stop it.
[[nodiscard]] std::optional<ModelledFrame> modelled_frame(const processors::program::WorkLog& log,
                                                          const processors::machine::MachineConfig& machine,
                                                          sim::WorkMeter* meter = nullptr);

}  // namespace marti::studies::explore
