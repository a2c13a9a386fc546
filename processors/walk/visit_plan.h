// What a visit to each tree node touches, worked out once for a layout and a line size: the lines in order,
// and the number of steps and lines of each kind. A replay then walks a list of line numbers instead of
// computing addresses record by record.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "memory/layout.h"
#include "processors/cost/step_time.h"
#include "processors/program/work_log.h"
#include "sim/large_pages.h"

namespace marti::processors::walk {

/// The counts of one visit. A visit without `leaf` is one to a branch; `test` counts triangles, cone_test
/// cylinders too. Counts are summed in 16-bit lanes, four to a word, which most_summed_visits visits cannot
/// overflow.
enum class VisitCount : std::uint8_t {
  leaf,
  list,
  test,
  sphere_test,
  cone_test,
  node_line,
  list_line,
  primitive_line
};
inline constexpr std::uint32_t most_of_a_count = 255;
inline constexpr std::uint32_t most_summed_visits = 65535 / most_of_a_count;

struct VisitCounts {
  std::array<std::uint64_t, 2> lanes{};

  [[nodiscard]] std::uint32_t of(VisitCount what) const {
    const auto lane = static_cast<unsigned>(what);
    return (lanes[lane / 4] >> (lane % 4 * 16)) & 0xffffU;
  }
  void add(VisitCount what) {
    const auto lane = static_cast<unsigned>(what);
    lanes[lane / 4] += std::uint64_t{1} << (lane % 4 * 16);
  }
  VisitCounts& operator+=(const VisitCounts& other) {
    lanes[0] += other.lanes[0];
    lanes[1] += other.lanes[1];
    return *this;
  }
};

/// Sums over planned visits that are not in the statistics yet.
struct VisitTally {
  VisitCounts counts;
  std::uint32_t visits = 0;
};

/// A planned visit; a leaf's tests all its entries, each after a look-up where there are mailboxes. A visit
/// to an instance, or one that does not fit (more than 255 of anything, or 2^61 ticks), has no lines and is
/// taken record by record.
struct alignas(32) Visit {
  std::uint32_t begin = 0;  ///< first of its lines in VisitPlan::lines
  std::uint32_t lines = 0;
  sim::Ticks time = 0;  ///< of the whole visit when every line hits
  VisitCounts counts;
};

/// A line's label: its record kind in the upper bits; in the lower the time from the beginning of the visit
/// until the line is asked for, when every line before it hits.
inline constexpr unsigned label_bits = 61;
[[nodiscard]] constexpr memory::RecordKind kind_of_label(std::uint64_t label) {
  return static_cast<memory::RecordKind>(label >> label_bits);
}
[[nodiscard]] constexpr sim::Ticks time_of_label(std::uint64_t label) {
  return static_cast<sim::Ticks>(label & ((std::uint64_t{1} << label_bits) - 1));
}

struct VisitPlan {
  sim::LargeVector<Visit> visits;          ///< one for each tree node
  sim::LargeVector<std::uint32_t> lines;   ///< line numbers, visit by visit
  sim::LargeVector<std::uint64_t> labels;  ///< one for each line

  [[nodiscard]] bool empty() const { return visits.empty(); }
};

/// Most lines a plan may hold (12 bytes each).
inline constexpr std::uint64_t most_planned_lines = std::uint64_t{1} << 27U;

/// The plan, or an empty one when the tree has more than most_planned_lines lines. `rank` is as in
/// ReplayInput::node_rank.
[[nodiscard]] VisitPlan plan_visits(const program::WorkLog& log, const memory::Layout& layout,
                                    std::span<const std::uint32_t> rank, unsigned line_shift,
                                    const cost::StepTicks& ticks);

/// Adds `visits` visits, all of whose lines hit, with the sum of their counts to a node's statistics.
void add_visits(const VisitCounts& counts, std::uint32_t visits, bool mailboxes,
                cost::NodeStatistics& statistics);

}  // namespace marti::processors::walk
