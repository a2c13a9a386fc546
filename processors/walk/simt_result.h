// What is counted of SIMT nodes beside what is counted of all nodes. docs/internals/rt-unit.md defines each
// counter.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/statistics.h"

namespace marti::processors::walk {

/// Of one node. The first ten divide its lane-cycles.
struct SimtCounts {
  std::int64_t lanes_shading = 0;
  std::int64_t lanes_slot = 0;
  std::int64_t lanes_unit = 0;
  std::int64_t lanes_scheduler = 0;
  std::int64_t lanes_cache = 0;
  std::int64_t lanes_memory = 0;
  std::int64_t lanes_box = 0;
  std::int64_t lanes_primitive = 0;
  std::int64_t lanes_held = 0;
  std::int64_t lanes_empty = 0;
  std::int64_t cycles = 0;
  std::int64_t accesses = 0;
  std::int64_t records = 0;
  std::int64_t joined = 0;
  std::int64_t full_cycles = 0;
  std::int64_t traces = 0;
  std::int64_t unit_cycles = 0;
  std::int64_t line_cycles = 0;
  std::int64_t rays = 0;
  std::int64_t returns = 0;
  std::int64_t ray_cycles = 0;
  std::int64_t longest_ray = 0;
  std::int64_t longest_warp = 0;
  std::int64_t spills = 0;
  std::int64_t fills = 0;
  std::int64_t sorted_warps = 0;
  std::int64_t sorted_rays = 0;
  std::int64_t helps = 0;

  static constexpr auto counters() {
    using C = sim::Counter<SimtCounts>;
    using sim::Better;
    using sim::MergeRule;
    return std::array{
        C{"lanes_shading", "cycle", "lane-cycles in shader code that computes", &SimtCounts::lanes_shading,
          MergeRule::sum, Better::neither},
        C{"lanes_slot", "cycle", "lane-cycles of waiting for a slot to compute on", &SimtCounts::lanes_slot},
        C{"lanes_unit", "cycle", "lane-cycles of waiting to enter the ray-tracing unit",
          &SimtCounts::lanes_unit},
        C{"lanes_scheduler", "cycle", "lane-cycles of waiting until a record's lines are looked up",
          &SimtCounts::lanes_scheduler},
        C{"lanes_cache", "cycle", "lane-cycles of waiting for the node's own caches",
          &SimtCounts::lanes_cache},
        C{"lanes_memory", "cycle", "lane-cycles of waiting for lines from beyond the node",
          &SimtCounts::lanes_memory},
        C{"lanes_box", "cycle", "lane-cycles of testing boxes and leaves", &SimtCounts::lanes_box,
          MergeRule::sum, Better::neither},
        C{"lanes_primitive", "cycle", "lane-cycles of testing primitives", &SimtCounts::lanes_primitive,
          MergeRule::sum, Better::neither},
        C{"lanes_held", "cycle",
          "lane-cycles of lanes with a pixel that wait for others of their warp, or for the write buffer",
          &SimtCounts::lanes_held},
        C{"lanes_empty", "cycle", "lane-cycles of lanes without a pixel", &SimtCounts::lanes_empty},
        C{"cycles", "cycle", "cycles until no packet was left", &SimtCounts::cycles, MergeRule::sum,
          Better::lower},
        C{"accesses", "1", "accesses to records, each by one lane or several", &SimtCounts::accesses},
        C{"records", "1", "records that lanes got by them", &SimtCounts::records, MergeRule::sum,
          Better::neither},
        C{"joined", "1", "look-ups that joined a line under way", &SimtCounts::joined, MergeRule::sum,
          Better::neither},
        C{"full_cycles", "cycle", "cycles in which a look-up found no register for its line",
          &SimtCounts::full_cycles},
        C{"traces", "1", "warps that entered the ray-tracing unit", &SimtCounts::traces},
        C{"unit_cycles", "cycle", "sum over cycles of warps in the unit", &SimtCounts::unit_cycles,
          MergeRule::sum, Better::neither},
        C{"line_cycles", "cycle", "sum over cycles of lines under way", &SimtCounts::line_cycles,
          MergeRule::sum, Better::neither},
        C{"rays", "1", "rays that read a record", &SimtCounts::rays, MergeRule::sum, Better::neither},
        C{"returns", "1", "times that a ray read a record after it had been asked whether hits count",
          &SimtCounts::returns, MergeRule::sum, Better::neither},
        C{"ray_cycles", "cycle", "cycles that rays took in their trace phases, from the beginning of these",
          &SimtCounts::ray_cycles},
        C{"longest_ray", "cycle", "the most cycles of a ray in a trace phase", &SimtCounts::longest_ray,
          MergeRule::maximum},
        C{"longest_warp", "cycle", "the most cycles of a warp with one packet", &SimtCounts::longest_warp,
          MergeRule::maximum},
        C{"spills", "1", "lines of traversal stacks written to memory (rt.stack)", &SimtCounts::spills},
        C{"fills", "1", "lines of traversal stacks read back", &SimtCounts::fills},
        C{"sorted_warps", "1", "warps that were formed of sorted rays (rt.sort)", &SimtCounts::sorted_warps},
        C{"sorted_rays", "1", "lanes of these that have a ray", &SimtCounts::sorted_rays, MergeRule::sum,
          Better::neither},
        C{"helps", "1", "entries that lanes without work took from others (rt.share)", &SimtCounts::helps,
          MergeRule::sum, Better::neither}};
  }
};
static_assert(sim::declares_every_member<SimtCounts>());

/// Number of the first counters, which divide the lane-cycles.
inline constexpr std::size_t lane_states = 10;

struct SimtResult {
  std::vector<SimtCounts> nodes;  ///< one for each processor node; empty with other nodes

  [[nodiscard]] SimtCounts counts() const {
    SimtCounts sum;
    for (const SimtCounts& node : nodes) {
      sim::merge(sum, node);
    }
    return sum;
  }
};

}  // namespace marti::processors::walk
