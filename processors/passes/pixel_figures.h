// What single pixels ask of a machine, by walking them alone, without timing the frame: their times without
// misses, and bounds of their misses.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "processors/machine/machine_config.h"
#include "processors/program/work_log.h"
#include "processors/walk/kept_visits.h"
#include "processors/walk/observer.h"
#include "sim/time.h"

namespace marti::processors::passes {

struct PixelFigures {
  sim::Ticks hit_time = 0;        ///< what it takes if every reference hits
  std::int64_t misses = 0;        ///< of a node that has walked the pixel before it in the list
  std::int64_t misses_again = 0;  ///< of a node that has walked this pixel itself just before
};

/// One for each of `pixels`, which one node walks in their order, each twice. `config` must have a given
/// tree, one context and no second level of caches. `visits`: kept for the
/// replays of this machine that follow.
[[nodiscard]] std::vector<PixelFigures> pixel_figures(const program::WorkLog& log,
                                                      const machine::MachineConfig& config,
                                                      std::span<const walk::PixelPlace> pixels,
                                                      walk::KeptVisits& visits);

}  // namespace marti::processors::passes
