// Where a node's time goes: every tick from 0 to the end of the frame belongs to exactly one activity.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string_view>

#include "memory/interconnect.h"
#include "memory/record_kind.h"
#include "processors/program/work_log.h"
#include "sim/statistics.h"
#include "sim/time.h"

namespace marti::processors::cost {

enum class Activity : std::uint8_t {
  traversal,     ///< setting up rays, visiting branches, instances and leaves
  intersection,  ///< testing primitives
  shading,       ///< hit points, lights, textures, holes of triangles, finished pixels
  building,      ///< subdividing nodes during the frame
  cache_access,  ///< hit cycles
  switching,     ///< going from one context to another
  messaging,     ///< composing messages and taking them from the queue
  interconnect_wait,
  transfer,
  bank_wait,
  bank_access,
  lock_wait,
  message_wait,     ///< no ray in the queue, before the frame is over
  queue_full_wait,  ///< the write buffer or the next node's queue was full
  dispatch_wait,    ///< between asking the host for a packet and beginning it
  idle,             ///< no packet left, until the last node and the last write are done
};
inline constexpr std::size_t activities = 16;
inline constexpr std::array<std::string_view, activities> activity_names = {
    "traversal",    "intersection",      "shading",       "building",  "cache_access", "switching",
    "messaging",    "interconnect_wait", "transfer",      "bank_wait", "bank_access",  "lock_wait",
    "message_wait", "queue_full_wait",   "dispatch_wait", "idle"};

/// What a node does, or waits for, during an activity.
enum class ActivityKind : std::uint8_t {
  computing,  ///< its own work, hits of its cache and messages among it
  memory,     ///< being served by the way to memory, without queues
  queueing,   ///< waiting in a queue of the way to memory, or for room in one
  delay,      ///< waiting for another node or the host
  idle        ///< nothing is left to do
};
inline constexpr std::array<ActivityKind, activities> activity_kinds = {
    ActivityKind::computing, ActivityKind::computing, ActivityKind::computing, ActivityKind::computing,
    ActivityKind::computing, ActivityKind::computing, ActivityKind::computing, ActivityKind::queueing,
    ActivityKind::memory,    ActivityKind::queueing,  ActivityKind::memory,    ActivityKind::delay,
    ActivityKind::delay,     ActivityKind::queueing,  ActivityKind::delay,     ActivityKind::idle};

/// The sum of what `of_activity(i)` gives for each activity of these kinds, in the order of the activities.
template <class OfActivity>
[[nodiscard]] auto sum_of_kinds(std::initializer_list<ActivityKind> kinds, const OfActivity& of_activity) {
  decltype(of_activity(std::size_t{0})) sum{};
  for (std::size_t i = 0; i < activities; ++i) {
    if (std::find(kinds.begin(), kinds.end(), activity_kinds[i]) != kinds.end()) {
      sum += of_activity(i);
    }
  }
  return sum;
}

using TimeDivision = std::array<sim::Ticks, activities>;
/// Of many nodes together.
using TimeSums = std::array<sim::Sum, activities>;

/// How many of each kind of step a node took.
struct StepCounts {
  std::int64_t camera_rays = 0;
  std::int64_t shadow_rays = 0;
  std::int64_t reflection_rays = 0;
  std::int64_t refraction_rays = 0;
  std::int64_t diffuse_rays = 0;
  std::int64_t branches = 0;
  std::int64_t transforms = 0;
  std::int64_t leaves = 0;
  std::int64_t lists = 0;         ///< leaves whose object list was read
  std::int64_t tests = 0;         ///< of all kinds of primitive
  std::int64_t sphere_tests = 0;  ///< of these, spheres
  std::int64_t cone_tests = 0;    ///< of these, cylinders and cones
  std::int64_t lookups = 0;
  std::int64_t shades = 0;
  std::int64_t lights = 0;
  std::int64_t texels = 0;
  std::int64_t any_hits = 0;
  std::int64_t cuts = 0;
  std::int64_t passes = 0;
  std::int64_t pixels = 0;

  static constexpr auto counters() {
    using C = sim::Counter<StepCounts>;
    return std::array{
        C{"camera_rays", "1", "camera rays set up", &StepCounts::camera_rays, sim::MergeRule::sum,
          sim::Better::neither},
        C{"shadow_rays", "1", "shadow rays set up", &StepCounts::shadow_rays, sim::MergeRule::sum,
          sim::Better::neither},
        C{"reflection_rays", "1", "reflected rays set up", &StepCounts::reflection_rays, sim::MergeRule::sum,
          sim::Better::neither},
        C{"refraction_rays", "1", "refracted rays set up", &StepCounts::refraction_rays, sim::MergeRule::sum,
          sim::Better::neither},
        C{"diffuse_rays", "1", "scattered rays set up", &StepCounts::diffuse_rays, sim::MergeRule::sum,
          sim::Better::neither},
        C{"branches", "1", "branch nodes visited", &StepCounts::branches},
        C{"transforms", "1", "instances visited: rays brought into a mesh's coordinates",
          &StepCounts::transforms},
        C{"leaves", "1", "leaf nodes visited, empty ones included", &StepCounts::leaves},
        C{"lists", "1", "object lists read", &StepCounts::lists},
        C{"tests", "1", "primitives tested", &StepCounts::tests},
        C{"sphere_tests", "1", "of these, spheres", &StepCounts::sphere_tests},
        C{"cone_tests", "1", "of these, cylinders and cones", &StepCounts::cone_tests},
        C{"lookups", "1", "mailboxes looked up", &StepCounts::lookups},
        C{"shades", "1", "surface points shaded", &StepCounts::shades},
        C{"lights", "1", "light contributions added", &StepCounts::lights},
        C{"texels", "1", "texels read", &StepCounts::texels},
        C{"any_hits", "1", "hits of triangles with holes asked about", &StepCounts::any_hits},
        C{"cuts", "1", "nodes taken as one voxel", &StepCounts::cuts},
        C{"passes", "1", "nodes too little covered for that", &StepCounts::passes},
        C{"pixels", "1", "pixels finished", &StepCounts::pixels, sim::MergeRule::sum, sim::Better::neither}};
  }
};
static_assert(sim::declares_every_member<StepCounts>());

/// The counter of each RayKind.
inline constexpr std::array<std::int64_t StepCounts::*, program::ray_kinds> ray_counters = {
    &StepCounts::camera_rays, &StepCounts::shadow_rays, &StepCounts::reflection_rays,
    &StepCounts::refraction_rays, &StepCounts::diffuse_rays};

/// References are lines touched (without a cache: parts of at most one interleave unit each); one record may
/// take several references.
struct ReferenceCounts {
  std::array<std::int64_t, memory::record_kinds> misses{};
  std::array<std::int64_t, memory::record_kinds> hits{};

  [[nodiscard]] std::int64_t all_hits() const;
  [[nodiscard]] std::int64_t all_misses() const;
  [[nodiscard]] std::int64_t references() const { return all_hits() + all_misses(); }
  ReferenceCounts& operator+=(const ReferenceCounts& other);
};

/// Everything counted at one node. What a read adds to, the four waits and the misses, lies in two cache
/// lines of the host: with many nodes these are out of its caches at each read.
struct alignas(64) NodeStatistics {
  sim::Ticks finish = 0;  ///< when it learned that no packet is left
  TimeDivision time{};
  ReferenceCounts references;
  std::int64_t packets = 0;
  std::int64_t writes = 0;
  StepCounts steps;

  static constexpr auto counters() {
    using C = sim::Counter<NodeStatistics>;
    return std::array{C{"packets", "1", "packets traced", &NodeStatistics::packets, sim::MergeRule::sum,
                        sim::Better::neither},
                      C{"writes", "1", "pixels written", &NodeStatistics::writes, sim::MergeRule::sum,
                        sim::Better::neither},
                      C{"finish", "ps", "when no packet was left", &NodeStatistics::finish}};
  }
};

// The waits begin a cache line, and the misses, which come first of the references, lie in one.
static_assert((offsetof(NodeStatistics, time) +
               static_cast<std::size_t>(Activity::interconnect_wait) * sizeof(sim::Ticks)) %
                  64 ==
              0);
static_assert(offsetof(NodeStatistics, references) % 64 + sizeof(ReferenceCounts::misses) <= 64);

/// The hits counted for one record kind.
inline std::int64_t& hits_of(NodeStatistics& statistics, memory::RecordKind kind) {
  return statistics.references.hits[static_cast<std::size_t>(kind)];
}
inline std::int64_t& misses_of(NodeStatistics& statistics, memory::RecordKind kind) {
  return statistics.references.misses[static_cast<std::size_t>(kind)];
}

/// Records that rays read, and pixels written, by kind. The numbers follow from the steps. `leaf_records`:
/// whether leaves have node records; those of a bounding volume hierarchy have none.
[[nodiscard]] std::array<std::int64_t, memory::record_kinds> records_of(const StepCounts& steps,
                                                                        bool leaf_records);

[[nodiscard]] sim::Ticks sum_of(const TimeDivision& time);

/// Adds the parts of a read to their activities.
inline void add_service(TimeDivision& time, const memory::Service& service) {
  time[static_cast<std::size_t>(Activity::interconnect_wait)] += service.wait_interconnect;
  time[static_cast<std::size_t>(Activity::transfer)] += service.transfer;
  time[static_cast<std::size_t>(Activity::bank_wait)] += service.wait_bank;
  time[static_cast<std::size_t>(Activity::bank_access)] += service.bank;
}

}  // namespace marti::processors::cost
