// References, misses and waits by what they were for: record kind, tree level, ray kind and bounce.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "memory/interconnect.h"
#include "memory/record_kind.h"
#include "processors/program/work_log.h"
#include "sim/statistics.h"
#include "sim/time.h"

namespace marti::processors::walk {

/// Whether records of this kind are read for a node of the tree.
[[nodiscard]] constexpr bool of_tree(memory::RecordKind kind) {
  return kind <= memory::RecordKind::primitive;
}

/// What a reference was for: a work log's `ray` operand (ray_operand(), the bounce at most
/// Origin::most_bounces), the level of the tree node whose record, list or primitives were read (0 for
/// materials and texels), and whether they were read to split a branch: for the ray that needed it, or before
/// the frame, when there is no ray yet and `ray` is 0.
struct Origin {
  static constexpr std::uint32_t most_bounces = 255;

  std::uint16_t ray = 0;
  std::uint8_t level = 0;
  bool splitting = false;

  void begin_ray(std::uint32_t operand) {
    const std::uint32_t bounce = program::bounce_of(operand);
    ray = static_cast<std::uint16_t>(
        program::ray_operand(program::ray_kind_of(operand), bounce < most_bounces ? bounce : most_bounces));
  }
};

/// A reference, as caches that count see it.
struct Use {
  Origin origin{};
  sim::Ticks time = 0;
  memory::Address at = 0;
  std::uint32_t bytes = 0;
  bool own = false;  ///< see CacheCounting::refer
};

struct AttributionCounts {
  std::int64_t references = 0;
  std::int64_t misses = 0;
  std::int64_t second_level_hits = 0;
  sim::Sum interconnect_wait = 0;
  sim::Sum transfer = 0;
  sim::Sum bank_wait = 0;
  sim::Sum bank_access = 0;

  [[nodiscard]] sim::Sum waited() const { return interconnect_wait + transfer + bank_wait + bank_access; }

  static constexpr auto counters() {
    using C = sim::Counter<AttributionCounts>;
    return std::array{
        C{"references", "1", "lines asked for in the first level", &AttributionCounts::references},
        C{"misses", "1", "of these, misses of the first level", &AttributionCounts::misses},
        C{"second_level_hits", "1", "of these, hits of a private second level",
          &AttributionCounts::second_level_hits, sim::MergeRule::sum, sim::Better::higher},
        C{"interconnect_wait", "ps", "waiting for the interconnect", &AttributionCounts::interconnect_wait},
        C{"transfer", "ps", "transfers", &AttributionCounts::transfer},
        C{"bank_wait", "ps", "waiting for banks", &AttributionCounts::bank_wait},
        C{"bank_access", "ps", "accesses of banks", &AttributionCounts::bank_access}};
  }
};
static_assert(sim::declares_every_member<AttributionCounts>());

/// The counts of one combination of record kind, level, ray kind, bounce and work that occurred.
struct AttributionRow {
  memory::RecordKind record = memory::RecordKind::node;
  std::uint32_t level = 0;
  program::RayKind ray = program::RayKind::camera;
  std::uint32_t bounce = 0;
  bool splitting = false;
  AttributionCounts counts;
};

class Attribution {
 public:
  AttributionCounts& at(memory::RecordKind record, Origin origin);
  void wait(memory::RecordKind record, Origin origin, const memory::Service& service);

  /// Ascending by bounce, ray kind, work (splitting last), level, record kind.
  [[nodiscard]] std::vector<AttributionRow> rows() const;

 private:
  static constexpr std::uint32_t levels = 64;  ///< the deepest tree, a BSP tree, has 61

  std::vector<AttributionCounts> cells_;  // by origin's ray, work, level and record
};

}  // namespace marti::processors::walk
