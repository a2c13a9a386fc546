// Configuration of a SIMT node and its ray-tracing unit (docs/internals/rt-unit.md).
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace marti::processors::machine {

struct MachineConfig;

/// core: a scalar processor that works in order. simt: warps of lanes beside a ray-tracing unit.
enum class NodeKind : std::uint8_t { core, simt };
inline constexpr std::array<std::string_view, 2> node_kind_names = {"core", "simt"};

/// Which of a warp's lanes that hold a ray trace together. kind: those with the least (bounce, kind of ray).
enum class Reconverge : std::uint8_t { kind, any };
inline constexpr std::array<std::string_view, 2> reconverge_names = {"kind", "any"};

/// Which warp of the unit may ask for a record next.
enum class RtScheduler : std::uint8_t { oldest, greedy, round_robin, treelet };
inline constexpr std::array<std::string_view, 4> rt_scheduler_names = {"oldest", "greedy", "round_robin",
                                                                       "treelet"};

/// Whose accesses to the same record become one.
enum class RtCoalesce : std::uint8_t { none, warp, unit };
inline constexpr std::array<std::string_view, 3> rt_coalesce_names = {"none", "warp", "unit"};

/// Whose entries lanes of a warp in the unit take that have no work of their own: nobody's, or those of other
/// lanes of the warp.
enum class RtShare : std::uint8_t { none, warp };
inline constexpr std::array<std::string_view, 2> rt_share_names = {"none", "warp"};

/// By what rays of several warps are sorted before they enter the unit. kind: bounce, then kind of ray;
/// direction, origin: see program/ray_grid.h.
enum class RaySort : std::uint8_t { none, kind, direction, origin };
inline constexpr std::array<std::string_view, 4> ray_sort_names = {"none", "kind", "direction", "origin"};

/// The most lanes of a warp, warps of a node, and slots on which warps compute.
inline constexpr std::uint32_t most_lanes = 64;
inline constexpr std::uint32_t most_warps = 64;
/// The most lines that may be looked up in a cycle, and be under way at a node.
inline constexpr std::uint32_t most_cache_ports = 64;
inline constexpr std::uint32_t most_mshrs = 1024;
/// The most sectors of a line.
inline constexpr std::uint32_t most_sectors = 8;
/// The most tests that may be said to begin in a cycle.
inline constexpr std::uint32_t most_test_units = 4096;

/// The most entries of a lane's stack that are on chip, and bytes of an entry: a node and its distance.
inline constexpr std::uint32_t most_stack_entries = 1024;
inline constexpr std::uint32_t stack_entry_bytes = 8;

/// The most rays that are sorted together.
inline constexpr std::uint32_t most_sorted_rays = most_lanes * most_warps;

struct SimtConfig {
  std::uint32_t lanes = 32;  ///< of a warp, 1 to most_lanes
  std::uint32_t warps = 16;  ///< of a node, 1 to most_warps
  std::uint32_t issue = 1;   ///< warps that compute at once, 1 to most_warps
  Reconverge reconverge = Reconverge::kind;
  std::uint32_t ports = 1;   ///< lines looked up in a cycle, 1 to most_cache_ports
  std::uint32_t mshrs = 64;  ///< lines under way, 1 to most_mshrs
  std::uint32_t sector = 0;  ///< bytes fetched on a miss, a power of two that divides the line; 0: the line
};

/// Cycles of a test, at least 0; waiting for a unit comes on top.
struct RtUnitConfig {
  std::uint32_t warps = 4;  ///< in the unit at once, 0 to most_warps; 0: there is no unit
  RtScheduler scheduler = RtScheduler::oldest;
  RtCoalesce coalesce = RtCoalesce::warp;
  RtShare share = RtShare::none;
  std::int64_t box_cycles = 8;
  std::int64_t transform_cycles = 8;
  std::int64_t leaf_cycles = 4;
  std::int64_t triangle_cycles = 8;
  std::int64_t quadric_cycles = 16;
  std::uint32_t box_units = 0;  ///< tests of boxes, transforms and leaves that may begin in a cycle; 0: any
  std::uint32_t triangle_units = 0;  ///< tests of primitives that may; 0: any number
  /// Entries of a lane's stack that are on chip, 0 to most_stack_entries; others are in memory. 0: any number
  /// is on chip.
  std::uint32_t stack = 0;
  RaySort sort = RaySort::none;
  std::uint32_t sort_rays = 256;  ///< that are sorted together, 1 to most_sorted_rays
  std::int64_t sort_cycles = 32;  ///< from when they are known until they wait for the unit, at least 0
};

/// The part of check() for SIMT nodes; checks nothing for others.
void check_simt(const MachineConfig& config);

}  // namespace marti::processors::machine
