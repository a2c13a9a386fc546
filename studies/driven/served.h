// A memory that has served a trace, and what came out.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

#include "processors/replay/driven_memory.h"
#include "sim/config.h"
#include "sim/work_meter.h"
#include "studies/driven/driven.h"
#include "studies/run/run_result.h"

namespace marti::studies::driven {

// Units in which people are told, and the percentage of reads that a late one is behind.
inline constexpr double nanosecond = 1e3;  // in ps
inline constexpr double giga = 1e9;
inline constexpr double late = 95.0;

/// What one configuration has served.
struct Served {
  run::RunResult result;  ///< its parts are shown as those of a run
  processors::replay::DrivenResult driven;
  std::int64_t reads = 0;
  std::int64_t writes = 0;
  std::int64_t bytes = 0;
  std::string_view form;  ///< of the trace, for people
  bool timed = false;     ///< whether requests came at their times

  [[nodiscard]] double bytes_a_second() const;
  [[nodiscard]] double mean_latency() const;  ///< of reads, ps; 0 without reads
  [[nodiscard]] double hit_ratio() const;     ///< of the private caches; 0 where they are not asked
  /// That so many percent of the reads do not exceed, ps.
  [[nodiscard]] std::int64_t latency(double percent) const;
  [[nodiscard]] double picojoules_a_byte() const;  ///< 0 without energy
};

/// Throws as drive() does.
[[nodiscard]] Served serve(sim::Config& config, const std::filesystem::path& trace,
                           const DrivenChoices& choices, sim::WorkMeter* meter);

}  // namespace marti::studies::driven
