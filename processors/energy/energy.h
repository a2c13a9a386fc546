// The energy of a finished frame and the area of the machine, from what was counted.
#pragma once

#include <array>
#include <cstdint>

#include "accel/traversal.h"
#include "memory/cache.h"
#include "memory/dram_statistics.h"
#include "processors/cost/accounting.h"
#include "processors/machine/machine_config.h"
#include "processors/node/build_result.h"
#include "sim/statistics.h"
#include "sim/time.h"

namespace marti::processors::energy {

/// What takes energy, of all nodes and clusters together.
struct EnergyCounts {
  accel::Traversal traversal = accel::Traversal::octree;
  bool mailboxes = false;
  program::Integrator integrator = program::Integrator::whitted;
  cost::StepCounts steps;
  node::BuildCounts build;
  /// Look-ups that hit and miss in the nodes' own caches; a miss brings its line in. Split caches in their
  /// order, a unified one at place 0.
  std::array<memory::CacheCounters, machine::split_caches> l1;
  std::int64_t l1_prefetches = 0;  ///< lines brought in beside the misses, into the cache at place 0
  memory::CacheCounters l2;
  std::int64_t interconnect_bytes = 0;  ///< between nodes and shared memory
  std::int64_t hop_bytes = 0;           ///< over networks: bytes times links
  std::int64_t memory_reads = 0;        ///< of banks and of nodes' own memories; each reads a line
  std::int64_t memory_writes = 0;
  memory::DramStatistics dram;  ///< of a memory of DRAM, whose accesses are not among the two before
  sim::Ticks end = 0;
};

/// The parts add up to `total` exactly.
struct EnergyResult {
  std::int64_t operations = 0;
  std::int64_t unit = 0;
  std::int64_t l1 = 0;
  std::int64_t l2 = 0;
  std::int64_t interconnect = 0;
  std::int64_t memory = 0;
  std::int64_t leakage = 0;
  std::int64_t total = 0;
  std::int64_t area = 0;
  std::int64_t cache_area = 0;
  std::int64_t unit_area = 0;

  static constexpr auto counters() {
    using C = sim::Counter<EnergyResult>;
    return std::array{
        C{"operations", "fJ", "operations of the nodes, each with what its instruction takes beside it",
          &EnergyResult::operations},
        C{"unit", "fJ", "tests of ray-tracing units, and reading and writing the rays that they hold",
          &EnergyResult::unit},
        C{"l1", "fJ", "first-level caches: look-ups, and lines brought in", &EnergyResult::l1},
        C{"l2", "fJ", "second-level caches", &EnergyResult::l2},
        C{"interconnect", "fJ", "bytes moved over interconnects and networks", &EnergyResult::interconnect},
        C{"memory", "fJ", "accesses of banks and local memories", &EnergyResult::memory},
        C{"leakage", "fJ", "area times frame time", &EnergyResult::leakage},
        C{"total", "fJ", "all parts together", &EnergyResult::total},
        C{"area", "um2", "area of nodes, caches and ray-tracing units", &EnergyResult::area},
        C{"cache_area", "um2", "of this, of caches", &EnergyResult::cache_area},
        C{"unit_area", "um2", "of this, of ray-tracing units", &EnergyResult::unit_area}};
  }
};
static_assert(sim::declares_every_member<EnergyResult>());

/// The number of EnergyResult's first counters that are parts of `total`.
inline constexpr std::size_t energy_parts = 7;

/// Throws KeyError when a figure that the machine needs is not known, or is out of range.
void check_energy(const machine::MachineConfig& config);

/// As energy_of(), of caches, interconnects and memory alone: what nodes take, leakage and areas are 0.
[[nodiscard]] EnergyResult energy_of_accesses(const machine::MachineConfig& config,
                                              const EnergyCounts& counts);

/// Each part is rounded once, to the nearest fJ. The energy must be on. Throws as check_energy() does, and
/// KeyError for an energy or an area that does not fit 64 bits.
[[nodiscard]] EnergyResult energy_of(const machine::MachineConfig& config, const EnergyCounts& counts);

}  // namespace marti::processors::energy
