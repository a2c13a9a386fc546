// What the lanes of a SIMT node read and compute for the steps of a log, one after the other.
#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "accel/record_order.h"
#include "accel/visitor.h"
#include "memory/layout.h"
#include "processors/cost/step_time.h"
#include "processors/walk/node_order.h"
#include "processors/walk/record_places.h"
#include "tests/support/naive_program.h"
#include "tests/support/naive_stack.h"

namespace marti::test {

/// What a lane does with a record in the unit.
enum class NaiveTest { none, box, transform, leaf, triangle, quadric };

struct NaiveRecord {
  memory::RecordKind kind = memory::RecordKind::node;
  memory::Address address = 0;
  std::uint32_t bytes = 0;
  NaiveTest test = NaiveTest::none;
};

/// A record of a ray's visit and, for warps that trace themselves, the steps that are taken with it. Steps
/// behind the last record come without one.
struct NaiveVisit {
  std::optional<NaiveRecord> record;
  StepCounts steps;
  /// To be prefetched when the lane wants the record: of each item the lines of all its records, each once.
  std::vector<std::vector<NaiveRecord>> wishes;
  std::uint32_t treelet = 0;              ///< of the record
  std::vector<memory::Address> spills{};  ///< lines that are written when the lane wants the record
};

/// What a ray does in the unit.
struct NaiveRay {
  std::vector<NaiveVisit> visits;
  std::vector<memory::Address> spills;  ///< lines that are written when it is done
};

/// What is kept of a ray from one stay in the unit to the next: between them it is asked about hits.
struct NaiveOnWay {
  NaiveStack stack;
  std::optional<std::uint32_t> before{};   ///< the node visited last
  std::optional<std::uint32_t> treelet{};  ///< of the record read last
};

/// The cycles of a phase, and of one that several lanes take together.
struct NaiveCycles {
  std::int64_t traversal = 0;
  std::int64_t intersection = 0;
  std::int64_t shading = 0;
  [[nodiscard]] std::int64_t all() const { return traversal + intersection + shading; }
};

/// Of each kind of step the most that any lane takes.
class NaiveMost {
 public:
  void lane(const StepCounts& steps) {
    std::size_t kind = 0;
    for_each_step(StepTicks{}, steps, [&](Activity, sim::Ticks, std::int64_t count) {
      most_.resize(std::max(most_.size(), kind + 1));
      most_[kind] = std::max(most_[kind], count);
      ++kind;
    });
  }
  [[nodiscard]] NaiveCycles cycles(const StepTicks& ticks, sim::Ticks period) const {
    NaiveCycles sum;
    std::size_t kind = 0;
    for_each_step(ticks, StepCounts{}, [&](Activity activity, sim::Ticks each, std::int64_t) {
      const std::int64_t cycles = kind < most_.size() ? each / period * most_[kind] : 0;
      (activity == Activity::traversal      ? sum.traversal
       : activity == Activity::intersection ? sum.intersection
                                            : sum.shading) += cycles;
      ++kind;
    });
    return sum;
  }

 private:
  std::vector<std::int64_t> most_;
};

class NaiveSimtLog {
 public:
  NaiveSimtLog(const WorkLog& log, const MachineConfig& machine, const memory::Layout& layout)
      : log_(log), machine_(machine), layout_(layout), rank_(processors::walk::node_ranks(log, machine)) {
    if (machine.layout.node_order == memory::NodeOrder::treelets) {
      treelets_ = accel::treelets_of(log.topology, !accel::walks_bvh(log.traversal),
                                     processors::walk::treelet_records(machine.layout));
    }
  }

  static bool is_visit(Step step) {
    return step == Step::branch || step == Step::transform || step == Step::leaf ||
           step == Step::partial_leaf || step == Step::cut || step == Step::pass;
  }

  /// Counts a step. Where leaves list no primitives, no list is read.
  void count(const std::uint32_t* word, StepCounts& steps) const {
    count_step(log_, word, steps);
    if (inlined()) {
      steps.lists = 0;
    }
  }

  [[nodiscard]] NaiveRecord material(std::uint32_t number) const {
    return record(memory::RecordKind::material, number, NaiveTest::leaf);
  }
  [[nodiscard]] NaiveRecord texel(std::uint32_t texture, std::uint32_t number) const {
    return record(memory::RecordKind::texel, log_.texture_begin[texture] + number, NaiveTest::none);
  }
  /// The records of the visits of a ray that begin at `at`, which moves behind them. Counts their steps.
  /// `entered`: of the branches from here on, if stacks are asked for; what is read is taken off. `place`: of
  /// the lane's stack in memory. `way`: null for a ray that has not been in the unit; where the visits end
  /// because it is asked about hits, it is on its way afterwards.
  NaiveRay visits(RayKind ray, std::span<const std::uint32_t> words, std::size_t& at, StepCounts& counted,
                  std::span<const std::uint32_t>& entered, memory::Address place,
                  std::optional<NaiveOnWay>& way) const {
    std::vector<NaiveVisit> visits;
    const std::uint32_t line = machine_.reference_bytes();
    if (!way) {
      way = NaiveOnWay{NaiveStack(machine_.rt.stack, std::max(1U, line / 8))};
    }
    NaiveStack& stack = way->stack;
    std::vector<memory::Address> spills;  // before the next record
    const auto moves = [&] {              // what the stack has written and read
      for (const std::size_t number : std::exchange(stack.written, {})) {
        spills.push_back(place + number * line);
      }
      for (const std::size_t number : std::exchange(stack.read, {})) {
        const NaiveRecord record = {memory::RecordKind::node, place + number * line, line, NaiveTest::none};
        visits.push_back({record, StepCounts{}, {}, way->treelet.value_or(0), std::exchange(spills, {})});
      }
    };
    StepCounts waiting;  // steps for the next record
    bool any = false;    // of them
    const auto take = [&](const NaiveRecord& of) {
      visits.push_back({of, std::exchange(waiting, StepCounts{}), {}, 0, std::exchange(spills, {})});
      any = false;
    };
    for (; at < words.size() && is_visit(step_of(words[at])); at += step_words(&words[at])) {
      const std::uint32_t operand = operand_of(words[at]);
      count(&words[at], counted);
      any = true;
      std::vector<std::vector<NaiveRecord>> wishes = take_entry(operand, way->before, stack, entered);
      moves();
      const std::size_t visit = visits.size();
      const bool first = !way->treelet;
      const std::uint32_t last = way->treelet.value_or(0);
      std::uint32_t treelet = last;
      if (step_of(words[at]) != Step::pass && !treelets_.of_node.empty()) {
        treelet = treelets_.of_node[operand];
      }
      if (machine_.prefetch.treelet && !first && last != treelet) {
        wish_for(treelet, wishes);
      }
      switch (step_of(words[at])) {
        case Step::branch:
          ++waiting.branches;
          take(node(operand, NaiveTest::box));
          break;
        case Step::transform:
          ++waiting.transforms;
          take(record(memory::RecordKind::transform, rank_[operand], NaiveTest::transform));
          break;
        case Step::cut:
          ++waiting.cuts;
          if (has_record(operand)) {
            take(node(operand, NaiveTest::box));
          }
          break;
        case Step::pass:
          ++waiting.passes;
          take(material(operand));
          break;
        default:
          ++waiting.leaves;
          leaf(operand, step_of(words[at]) == Step::leaf ? log_.topology.nodes[operand].count : words[at + 1],
               take, waiting);
      }
      if (visit < visits.size()) {
        visits[visit].wishes = wishes;
      }
      for (std::size_t i = visit; i < visits.size(); ++i) {
        visits[i].treelet = treelet;
        way->treelet = treelet;
      }
    }
    if (any) {
      visits.push_back({std::nullopt, waiting, {}});
    }
    if (at < words.size() && step_of(words[at]) == Step::any_hit) {
      return {visits, {}};
    }
    if (machine_.rt.stack > 0 || machine_.prefetch.stack > 0) {
      push_entered(way->before, stack, entered);
      while (ray != RayKind::shadow && stack.take()) {
      }
      moves();
    }
    way.reset();
    return {visits, spills};
  }
  /// The records of a visit to a node, of which so many primitives are tested, each with its own steps.
  [[nodiscard]] std::vector<NaiveVisit> node_visit(std::uint32_t number, std::uint32_t tests) const {
    std::vector<NaiveVisit> visits;
    StepCounts waiting;
    const auto take = [&](const NaiveRecord& of) {
      waiting.lists = of.kind == memory::RecordKind::list ? 1 : 0;
      visits.push_back({of, std::exchange(waiting, StepCounts{}), {}, 0, {}});
    };
    if (log_.topology.nodes[number].leaf) {
      ++waiting.leaves;
      leaf(number, tests, take, waiting);
    } else {
      ++waiting.branches;
      take(node(number, NaiveTest::box));
    }
    return visits;
  }
  [[nodiscard]] std::uint32_t treelet_of(std::uint32_t number) const {
    return treelets_.of_node.empty() ? 0 : treelets_.of_node[number];
  }
  /// What a lane wishes for that comes to another treelet.
  [[nodiscard]] std::vector<std::vector<NaiveRecord>> wishes_for(std::uint32_t treelet) const {
    std::vector<std::vector<NaiveRecord>> wishes;
    if (machine_.prefetch.treelet) {
      wish_for(treelet, wishes);
    }
    return wishes;
  }
  /// Bytes of a lane's place for its stack: of as many entries as there are levels below the root, times one
  /// less than the most children of a branch.
  [[nodiscard]] std::uint64_t stack_bytes() const {
    std::uint64_t levels = 0;
    std::uint64_t others = 0;
    for (const accel::TopologyNode& node : log_.topology.nodes) {
      levels = std::max<std::uint64_t>(levels, node.level - 1U);
      others = std::max<std::uint64_t>(others, node.leaf ? 0 : node.count - 1);
    }
    const std::uint64_t line = machine_.reference_bytes();
    return (levels * others * 8 + line - 1) / line * line;
  }

 private:
  [[nodiscard]] bool inlined() const { return machine_.layout.leaf == memory::LeafLayout::inline_records; }
  [[nodiscard]] bool has_record(std::uint32_t number) const { return NaiveProgram::has_record(log_, number); }
  // The ray takes the node from its stack; what it wishes for then.
  std::vector<std::vector<NaiveRecord>> take_entry(std::uint32_t visited,
                                                   std::optional<std::uint32_t>& before, NaiveStack& stack,
                                                   std::span<const std::uint32_t>& entered) const {
    std::vector<std::vector<NaiveRecord>> wishes;
    if (machine_.prefetch.stack == 0 && machine_.rt.stack == 0) {
      return wishes;
    }
    push_entered(before, stack, entered);
    while (stack.take() != visited) {
    }
    const auto& nodes = log_.topology.nodes;
    const auto is_child = [&](std::uint32_t branch) {
      return !nodes[branch].leaf && visited >= nodes[branch].first &&
             visited < nodes[branch].first + nodes[branch].count;
    };
    if (before && !is_child(*before)) {
      for (const std::uint32_t waiting : stack.near()) {
        if (wishes.size() < machine_.prefetch.stack) {
          wishes.push_back({first_record(waiting)});
        }
      }
    }
    before = visited;
    return wishes;
  }
  // The branch visited before has been tested: the ray keeps the nearest of the children that it has entered,
  // and pushes the others.
  void push_entered(std::optional<std::uint32_t> before, NaiveStack& stack,
                    std::span<const std::uint32_t>& entered) const {
    if (!before || log_.topology.nodes[*before].leaf) {
      return;
    }
    const accel::EnteredChildren children(entered.front());
    entered = entered.subspan(1);
    const std::uint32_t first = log_.topology.nodes[*before].first;
    for (std::uint32_t i = children.count(); i > 1; --i) {
      stack.push(first + children[i - 1]);
    }
    if (children.count() > 0) {
      stack.nearest = first + children[0];
    }
  }
  void wish_for(std::uint32_t treelet, std::vector<std::vector<NaiveRecord>>& wishes) const {
    wishes.emplace_back();
    for (std::uint32_t place = treelets_.begin[treelet]; place < treelets_.begin[treelet + 1]; ++place) {
      wishes.back().push_back(record(memory::RecordKind::node, place, NaiveTest::none));
    }
  }
  [[nodiscard]] NaiveRecord first_record(std::uint32_t number) const {
    const accel::TopologyNode& its = log_.topology.nodes[number];
    if (its.instance) {
      return record(memory::RecordKind::transform, rank_[number], NaiveTest::none);
    }
    if (!its.leaf) {
      return node(number, NaiveTest::box);
    }
    return inlined() ? record(memory::RecordKind::primitive, its.first, NaiveTest::none)
                     : list(its.first, its.count);
  }
  [[nodiscard]] NaiveRecord list(std::uint32_t first, std::uint32_t entries) const {
    return {memory::RecordKind::list, layout_.address(memory::RecordKind::list, first),
            entries * machine_.layout.entry_bytes, NaiveTest::none};
  }
  [[nodiscard]] NaiveRecord record(memory::RecordKind kind, std::uint64_t index, NaiveTest test) const {
    return {kind, layout_.address(kind, index), layout_.record_bytes(kind, index), test};
  }
  [[nodiscard]] NaiveRecord node(std::uint32_t number, NaiveTest test) const {
    return record(memory::RecordKind::node, rank_.empty() ? number : rank_[number], test);
  }
  template <class Take>
  void leaf(std::uint32_t number, std::uint32_t tests, const Take& take, StepCounts& waiting) const {
    if (has_record(number)) {
      take(node(number, NaiveTest::leaf));
    }
    const std::uint32_t first = log_.topology.nodes[number].first;
    if (tests > 0 && !inlined()) {
      take(list(first, tests));
    }
    for (std::uint32_t entry = first; entry < first + tests; ++entry) {
      const std::uint32_t primitive = log_.topology.entries[entry];
      const accel::PrimitiveKind kind = log_.kind_of(primitive);
      (void)count_test(StepTicks{}, kind, waiting);
      take(record(memory::RecordKind::primitive, inlined() ? entry : primitive,
                  kind == accel::PrimitiveKind::triangle ? NaiveTest::triangle : NaiveTest::quadric));
    }
  }

  const WorkLog& log_;
  MachineConfig machine_;
  memory::Layout layout_;
  std::vector<std::uint32_t> rank_;
  accel::Treelets treelets_;
};

}  // namespace marti::test
