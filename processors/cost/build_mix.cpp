#include "processors/cost/build_mix.h"

#include <array>
#include <numeric>
#include <vector>

#include "accel/octree.h"
#include "accel/octree_sort.h"
#include "processors/cost/step_time.h"
#include "sim/time.h"

namespace marti::processors::cost {

namespace {

using accel::Counted;
using accel::OperationCounts;

// Counts minus the share that the mean `each` predicts for them; 0 where a count is below its share.
OperationCounts beyond(const OperationCounts& counts, const OperationMix& each, std::uint64_t times) {
  const auto rest = [times](std::uint64_t count, std::int64_t mean) {
    const std::uint64_t share = (static_cast<std::uint64_t>(mean) * times + 500) / 1000;
    return count > share ? count - share : 0;
  };
  return {rest(counts.add, each.add),         rest(counts.multiply, each.multiply),
          rest(counts.divide, each.divide),   rest(counts.square_root, each.square_root),
          rest(counts.compare, each.compare), rest(counts.integer, each.integer)};
}

class Measurement {
 public:
  explicit Measurement(const accel::Octree& octree)
      : octree_(octree), frame_(accel::make_frame(octree.triangles())) {}

  MeasuredBuild run() {
    std::vector<std::uint32_t> all(octree_.triangles().size());
    std::iota(all.begin(), all.end(), 0U);
    split(0, {}, all);
    measured_.mixes.listed = mean_mix(untested_counts_, untested_);
    measured_.mixes.overlap =
        mean_mix(beyond(tested_counts_, measured_.mixes.listed, tested_), measured_.overlaps);
    measured_.mixes.child = mean_mix(child_counts_, measured_.children);
    measured_.listed = untested_ + tested_;
    return measured_;
  }

 private:
  void split(std::uint32_t number, const accel::OctreeCell& cell, const std::vector<std::uint32_t>& list) {
    const accel::TopologyNode& node = octree_.topology().nodes[number];
    if (node.leaf) {
      return;
    }
    OperationCounts before = accel::operation_counts();
    const accel::ChildSorter<Counted> sorter(frame_, cell);
    child_counts_ += accel::operation_counts() - before;
    measured_.children += node.count;
    std::array<std::vector<std::uint32_t>, 8> lists;
    for (const std::uint32_t id : list) {
      std::uint32_t tests = 0;
      before = accel::operation_counts();
      const std::uint32_t met = sorter.children(octree_.triangles(), id, tests);
      (tests == 0 ? untested_counts_ : tested_counts_) += accel::operation_counts() - before;
      ++(tests == 0 ? untested_ : tested_);
      measured_.overlaps += tests;
      for (std::uint32_t child = 0; child < 8; ++child) {
        if ((met >> child & 1U) != 0) {
          lists[child].push_back(id);
        }
      }
    }
    for (std::uint32_t child = 0; child < 8; ++child) {
      split(node.first + child, cell.child(child), lists[child]);
    }
  }

  const accel::Octree& octree_;
  accel::RootFrame frame_;
  MeasuredBuild measured_;
  OperationCounts untested_counts_;
  OperationCounts tested_counts_;
  OperationCounts child_counts_;
  std::uint64_t untested_ = 0;
  std::uint64_t tested_ = 0;
};

}  // namespace

MeasuredBuild measure_build_mixes(const accel::Octree& octree) { return Measurement(octree).run(); }

const BuildMixes& build_mixes() {
  // Columns: add, multiply, divide, square root, compare, integer.
  static constexpr BuildMixes table{
      .listed = {4517, 0, 0, 0, 22517, 3000},
      .overlap = {74182, 66119, 0, 0, 70750, 0},
      .child = {3750, 3750, 0, 0, 0, 0},
  };
  return table;
}

BuildCycles build_cycles(const machine::OperationCycles& cycles, const RecordWords& words) {
  const BuildMixes& mixes = build_mixes();
  using sim::add_ticks;
  const auto words_of = [&](std::int64_t count, std::int64_t each) {
    return add_ticks(cycles.integer, sim::multiply_ticks(each, count));
  };
  const auto fetch = [&](std::int64_t count) { return words_of(count, cycles.load); };
  const auto store = [&](std::int64_t count) { return words_of(count, cycles.store); };
  return {.lock = add_ticks(add_ticks(cycles.integer, cycles.load), cycles.store),
          .listed = price(mixes.listed, cycles, add_ticks(fetch(words.entry), fetch(words.primitive))),
          .overlap = price(mixes.overlap, cycles, 0),
          .child = price(mixes.child, cycles, store(words.node)),
          .entry = store(words.entry),
          .publish = store(words.node)};
}

BuildTicks build_ticks(const machine::MachineConfig& config) {
  const BuildCycles cycles = build_cycles(config.operations, record_words(config));
  const sim::Clock& clock = config.clock;
  return {.lock = clock.cycles(cycles.lock),
          .listed = clock.cycles(cycles.listed),
          .overlap = clock.cycles(cycles.overlap),
          .child = clock.cycles(cycles.child),
          .entry = clock.cycles(cycles.entry),
          .publish = clock.cycles(cycles.publish)};
}

}  // namespace marti::processors::cost
