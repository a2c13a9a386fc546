// Walks a node through its log on a machine whose tree is built while it is used: as LogWalker, and splits
// branches on the way. It knows no event and no queue.
//
// A reference whose outcome another node may still change (a line that is not settled, so that somebody may
// write it) is not taken ahead of its time: the walk stops before it and goes on when the simulation has got
// there. A line that is brought in may push another out, and somebody may have emptied a way by then: so a
// miss too changes the cache only when its time has come. Hits of settled lines change nothing that others
// see, and taking lines out of a cache and using others in it commute; they are taken ahead.
#pragma once

#include <algorithm>
#include <bit>
#include <utility>

#include "processors/accounting.h"
#include "processors/branch_lists.h"
#include "processors/build_mix.h"
#include "processors/build_result.h"
#include "processors/node_caches.h"
#include "processors/packets.h"
#include "processors/program/work_log.h"
#include "processors/replay_input.h"
#include "processors/step_time.h"
#include "processors/tree_copies.h"

namespace marti::processors {

/// What follows when the bytes from DynamicCursor::at to `end` are dealt with.
enum class Todo : std::uint8_t {
  step,     ///< the next step of the log, or the next branch to split before the frame
  list,     ///< a leaf's record was read: read its list
  tests,    ///< test the next primitive of the leaf
  branch,   ///< a lazy branch's record was read: is it built?
  inherit,  ///< a private tree's slot was empty and the shared record was read: split the branch
  lock,     ///< the lock transaction is under way
  split,    ///< a branch to be split before the frame was read: split it
  sort,     ///< the list of the branch was read: read and sort its next primitive
  make,     ///< the next child: write its list
  record,   ///< its list was written: write its record
  publish,  ///< all children were written: write the branch's own record
  done,     ///< it was written
};

/// How a lock transaction came out.
enum class Lock : std::uint8_t { won, wait, built };

struct DynamicCursor {
  sim::Ticks time = 0;
  const std::uint32_t* word = nullptr;
  const std::uint32_t* word_end = nullptr;
  memory::Address at = 0;                ///< next byte to read or write
  memory::Address end = 0;               ///< one past the last of them
  const std::uint32_t* entry = nullptr;  ///< primitives still to be tested or sorted
  const std::uint32_t* entry_end = nullptr;
  sim::Ticks arrived = 0;             ///< waiting: when the lock transaction was done; -1 before
  sim::Ticks published = 0;           ///< waiting: when the branch can be seen; -1 before
  std::uint32_t node = 0;             ///< the leaf that is tested, or the branch that is looked at or split
  std::uint32_t child = 0;            ///< next child to make
  std::uint32_t eager = 0;            ///< next branch to split before the frame
  std::uint32_t tests = 0;            ///< entries of the leaf's list to read
  std::uint32_t first_waiter = none;  ///< of the nodes that wait for this one to publish
  std::uint32_t next_waiter = none;   ///< in the list this one waits in
  std::uint32_t x = 0;
  std::uint32_t y = 0;
  std::uint32_t writes = 0;  ///< where the next posted write goes in the write buffer
  Packet packet;
  memory::RecordKind kind = memory::RecordKind::node;
  Todo todo = Todo::step;
  Lock lock = Lock::won;
  bool writing = false;  ///< the bytes are written, not read
  bool due = false;      ///< the simulation has reached the reference that comes next
  bool seen = false;     ///< the lazy branch just read was seen built
  bool before = false;   ///< it still splits branches before the frame

  static constexpr std::uint32_t none = 0xffffffffU;
};

/// Why a walk stopped. due: the reference at the cursor's time must wait for the simulation. lock, miss: it
/// asks the interconnect. write: it posts a write, of a pixel when todo is `step`. ready: nothing is left to
/// split before the frame.
enum class DynamicStop : std::uint8_t { due, miss, lock, write, ready };

template <class Caches>
class DynamicWalker {
 public:
  DynamicWalker(const ReplayInput& input, Caches caches)
      : input_(input),
        plan_(*input.tree),
        layout_(input.layout),
        topology_(input.log.topology),
        caches_(std::move(caches)),
        line_bytes_(Caches::present ? input.config.cache.cache.line : input.config.banks.interleave),
        unit_shift_(static_cast<unsigned>(std::countr_zero(line_bytes_))),
        copies_(plan_, topology_, layout_, input.config, unit_shift_),
        lists_(topology_),
        ticks_(step_ticks(input.config)),
        build_ticks_(build_ticks(input.config)),
        local_access_(input.config.local.clock.cycles(input.config.local.access_cycles)),
        local_beat_(input.config.local.clock.cycles(input.config.local.cycles_per_beat)),
        local_base_(input.config.placement == Placement::replicated ? 0
                    : private_()                                    ? plan_.lower_base()
                                                                    : ~memory::Address{0}) {}

  [[nodiscard]] const StepTicks& ticks() const { return ticks_; }
  [[nodiscard]] const BuildTicks& times() const { return build_ticks_; }
  [[nodiscard]] TreeCopies& copies() { return copies_; }
  [[nodiscard]] const TreeCopies& copies() const { return copies_; }
  [[nodiscard]] Caches& caches() { return caches_; }

  /// Takes `node` on from its cursor. Without RunAhead it stops before every reference.
  template <bool RunAhead>
  DynamicStop advance(std::uint32_t node, DynamicCursor& cursor, NodeStatistics& statistics,
                      BuildCounts& built) {
    const std::uint32_t copy = copies_.copy_of(node);
    const LineStates lines = copies_.lines(copy);
    const typename Caches::View cache = caches_.view(node);
    for (;;) {
      while (cursor.at < cursor.end) {
        if (cursor.writing) {
          if (cursor.at < local_base_) {
            return DynamicStop::write;
          }
          write_local(copy, cursor, statistics, built);
        } else if (DynamicStop stop = DynamicStop::due;
                   !refer<RunAhead>(copy, lines, cache, cursor, statistics, built, stop)) {
          return stop;
        }
      }
      switch (cursor.todo) {
        case Todo::step:
          if (cursor.before) {
            if (cursor.eager == plan_.eager().size()) {
              return DynamicStop::ready;
            }
            read_record(cursor, copy, plan_.eager()[cursor.eager++], Todo::split);
            break;
          }
          if (cursor.word == cursor.word_end) {
            ++statistics.steps.pixels;
            spend(cursor, ticks_.pixel, 1);
            return DynamicStop::write;
          }
          take_step(cursor, copy, statistics, *cursor.word++);
          break;
        case Todo::list:
          cursor.todo = Todo::tests;
          read(cursor, memory::RecordKind::list, list_address(copy, cursor.node),
               std::uint64_t{cursor.tests} * layout_.record_bytes(memory::RecordKind::list));
          break;
        case Todo::tests:
          if (cursor.entry == cursor.entry_end) {
            cursor.todo = Todo::step;
            break;
          }
          ++statistics.steps.tests;
          spend(cursor, ticks_.test, 1);
          read_primitive(cursor);
          break;
        case Todo::branch:
          if (cursor.seen) {
            cursor.todo = Todo::step;
          } else if (!private_()) {
            spend(cursor, build_ticks_.lock, 1);
            cursor.todo = Todo::lock;
            return DynamicStop::lock;
          } else if (plan_.place(cursor.node).home == TreePlan::none) {
            cursor.todo = Todo::inherit;
            read(cursor, memory::RecordKind::node, initial_record(cursor.node), node_bytes());
          } else {
            take(node, copy, cursor, built);
          }
          break;
        case Todo::inherit:
          take(node, copy, cursor, built);
          break;
        case Todo::lock:
          if (cursor.lock == Lock::won) {
            take_won(copy, cursor, built);
          } else {
            ++built.rereads;
            read_record(cursor, copy, cursor.node, Todo::branch);
          }
          break;
        case Todo::split:
          ++built.start_up_splits;
          begin_split(copy, cursor, built);
          break;
        case Todo::sort:
          sort_next(cursor, built);
          break;
        case Todo::make:
          make_child(copy, cursor, built);
          break;
        case Todo::record:
          cursor.todo = Todo::make;
          write(cursor, record_address(copy, first_child(cursor) + cursor.child++), node_bytes());
          break;
        case Todo::publish:
          cursor.todo = Todo::done;
          spend(cursor, build_ticks_.publish, 1);
          write(cursor, record_address(copy, cursor.node), node_bytes());
          break;
        case Todo::done:
          cursor.todo = Todo::step;
          break;
      }
    }
  }

  /// Address and bytes of the transaction that the node stopped for: of a miss a whole line with a cache,
  /// else its own part of the interleave unit; of a write its part of a line.
  [[nodiscard]] memory::Address address(const DynamicCursor& cursor) const {
    return Caches::present && !cursor.writing ? (cursor.at >> unit_shift_) << unit_shift_ : cursor.at;
  }
  [[nodiscard]] std::uint32_t bytes(const DynamicCursor& cursor) const {
    return Caches::present && !cursor.writing ? line_bytes_ : part(cursor);
  }
  /// The record that a lock transaction is about.
  [[nodiscard]] memory::Address locked_address(std::uint32_t node, const DynamicCursor& cursor) const {
    return record_address(copies_.copy_of(node), cursor.node);
  }

  /// The time of the miss has come: its line is brought in.
  void miss(std::uint32_t node, DynamicCursor& cursor, NodeStatistics& statistics) {
    const std::uint32_t copy = copies_.copy_of(node);
    const auto line = static_cast<std::uint32_t>(cursor.at >> unit_shift_);
    (void)caches_.view(node).access(cursor.kind, line);
    ++statistics.references.misses[static_cast<std::size_t>(cursor.kind)];
    if (Caches::present && !private_()) {
      copies_.note_cached(copy, line);
    }
    look(copy, cursor);
  }
  /// The transaction has been made.
  void pass(DynamicCursor& cursor) const { cursor.at = ((cursor.at >> unit_shift_) + 1) << unit_shift_; }

  /// Whether the bytes just written were the last of a lazy branch's own record.
  [[nodiscard]] bool publishes(const DynamicCursor& cursor) const {
    return cursor.todo == Todo::done && cursor.at >= cursor.end &&
           plan_.place(cursor.node).lazy != TreePlan::none;
  }

 private:
  using View = typename Caches::View;

  [[nodiscard]] bool private_() const { return input_.config.build.sharing == Sharing::private_trees; }
  [[nodiscard]] std::uint32_t node_bytes() const { return layout_.record_bytes(memory::RecordKind::node); }
  [[nodiscard]] std::uint32_t first_child(const DynamicCursor& cursor) const {
    return topology_.nodes[cursor.node].first;
  }
  [[nodiscard]] std::uint32_t part(const DynamicCursor& cursor) const {
    const memory::Address next = ((cursor.at >> unit_shift_) + 1) << unit_shift_;
    return static_cast<std::uint32_t>(std::min(cursor.end, next) - cursor.at);
  }
  static void spend(DynamicCursor& cursor, sim::Ticks each, std::int64_t count) {
    cursor.time = sim::add_ticks(cursor.time, sim::multiply_ticks(each, count));
  }

  [[nodiscard]] memory::Address initial_record(std::uint32_t tree_node) const {
    return layout_.address(memory::RecordKind::node, plan_.place(tree_node).record);
  }
  [[nodiscard]] memory::Address record_address(std::uint32_t copy, std::uint32_t tree_node) const {
    const TreePlan::Place& place = plan_.place(tree_node);
    if (place.home != TreePlan::none) {
      return block_of(copy, place) + place.record * plan_.stride();
    }
    if (place.lazy != TreePlan::none && plan_.lazy()[place.lazy].slot != TreePlan::none) {
      return plan_.slot_address(plan_.lazy()[place.lazy].slot);
    }
    return initial_record(tree_node);
  }
  [[nodiscard]] memory::Address list_address(std::uint32_t copy, std::uint32_t tree_node) const {
    const TreePlan::Place& place = plan_.place(tree_node);
    if (place.home != TreePlan::none) {
      return block_of(copy, place) + place.list;
    }
    if (!topology_.nodes[tree_node].leaf && place.lazy == TreePlan::none) {
      return plan_.dynamic_base() + place.list;
    }
    return layout_.address(memory::RecordKind::list, place.list);
  }
  [[nodiscard]] memory::Address block_of(std::uint32_t copy, const TreePlan::Place& place) const {
    const memory::Address block = copies_.block(copy, place.home);
    sim::ensure(block != 0, "the log visits a node before its parent");
    return block;
  }

  static void read(DynamicCursor& cursor, memory::RecordKind kind, memory::Address at, std::uint64_t bytes) {
    cursor.kind = kind;
    cursor.at = at;
    cursor.end = at + bytes;
    cursor.writing = false;
  }
  static void write(DynamicCursor& cursor, memory::Address at, std::uint64_t bytes) {
    cursor.at = at;
    cursor.end = at + bytes;
    cursor.writing = true;
  }
  void read_record(DynamicCursor& cursor, std::uint32_t copy, std::uint32_t tree_node, Todo todo) const {
    cursor.node = tree_node;
    cursor.todo = todo;
    read(cursor, memory::RecordKind::node, record_address(copy, tree_node), node_bytes());
  }
  void read_primitive(DynamicCursor& cursor) const {
    read(cursor, memory::RecordKind::primitive,
         layout_.address(memory::RecordKind::primitive, *cursor.entry++),
         layout_.record_bytes(memory::RecordKind::primitive));
  }

  // Whether the node sees the lazy branch built whose record it reads now.
  void look(std::uint32_t copy, DynamicCursor& cursor) const {
    if (cursor.todo == Todo::branch) {
      cursor.seen = copies_.built(copy, plan_.place(cursor.node).lazy);
    }
  }

  // Reads the next part. False when the node has to stop.
  template <bool RunAhead>
  bool refer(std::uint32_t copy, const LineStates& lines, View cache, DynamicCursor& cursor,
             NodeStatistics& statistics, BuildCounts& built, DynamicStop& stop) {
    const auto line = static_cast<std::uint32_t>(cursor.at >> unit_shift_);
    if ((!RunAhead || (Caches::present && !lines.settled(line))) && !cursor.due) {
      stop = DynamicStop::due;
      return false;
    }
    cursor.due = false;
    const bool local = cursor.at >= local_base_;
    if (local ? cache.access(cursor.kind, line) : cache.touch(cursor.kind, line)) [[likely]] {
      ++statistics.references.hits[static_cast<std::size_t>(cursor.kind)];
      spend(cursor, ticks_.hit, 1);
    } else if (!local) {
      stop = DynamicStop::miss;
      return false;
    } else {
      ++statistics.references.misses[static_cast<std::size_t>(cursor.kind)];
      ++built.local_misses;
      use_local(cursor, statistics, Caches::present ? line_bytes_ : part(cursor));
    }
    look(copy, cursor);
    pass(cursor);
    return true;
  }

  void use_local(DynamicCursor& cursor, NodeStatistics& statistics, std::uint32_t bytes) const {
    const std::int64_t width = input_.config.local.width;
    const sim::Ticks transfer = sim::multiply_ticks(local_beat_, (std::int64_t{bytes} + width - 1) / width);
    statistics.time[static_cast<std::size_t>(Activity::transfer)] += transfer;
    statistics.time[static_cast<std::size_t>(Activity::bank_access)] += local_access_;
    cursor.time = sim::add_ticks(cursor.time, sim::add_ticks(transfer, local_access_));
  }

  void write_local(std::uint32_t copy, DynamicCursor& cursor, NodeStatistics& statistics,
                   BuildCounts& built) {
    built.written_bytes += part(cursor);
    use_local(cursor, statistics, part(cursor));
    pass(cursor);
    if (publishes(cursor)) {
      // Only a tree of its own lies in a node's own memory, so nobody else looks.
      copies_.publish(copy, plan_.place(cursor.node).lazy);
    }
  }

  void take(std::uint32_t node, std::uint32_t copy, DynamicCursor& cursor, BuildCounts& built) {
    copies_.take(copy, plan_.place(cursor.node).lazy, node);
    take_won(copy, cursor, built);
  }
  void take_won(std::uint32_t copy, DynamicCursor& cursor, BuildCounts& built) {
    ++built.splits;
    begin_split(copy, cursor, built);
  }

  void begin_split(std::uint32_t copy, DynamicCursor& cursor, BuildCounts& built) {
    const std::span<const std::uint32_t> primitives = lists_.of(cursor.node);
    const std::uint32_t listed = plan_.listed(cursor.node);
    sim::ensure(listed >= primitives.size(), "a branch lists fewer primitives than the leaves below it");
    built.listed += listed;
    cursor.entry = primitives.data();
    cursor.entry_end = primitives.data() + primitives.size();
    cursor.todo = Todo::sort;
    read(cursor, memory::RecordKind::list, list_address(copy, cursor.node),
         std::uint64_t{listed} * layout_.record_bytes(memory::RecordKind::list));
  }

  void sort_next(DynamicCursor& cursor, BuildCounts& built) {
    if (cursor.entry != cursor.entry_end) {
      spend(cursor, build_ticks_.listed, 1);
      read_primitive(cursor);
      return;
    }
    // What the branch listed and no leaf does is classified too; then come the overlap tests.
    const std::uint32_t overlaps = topology_.work[cursor.node].overlaps;
    const auto sorted = static_cast<std::int64_t>(lists_.of(cursor.node).size());
    spend(cursor, build_ticks_.listed, plan_.listed(cursor.node) - sorted);
    spend(cursor, build_ticks_.overlap, overlaps);
    built.overlaps += overlaps;
    cursor.child = 0;
    cursor.todo = Todo::make;
  }

  void make_child(std::uint32_t copy, DynamicCursor& cursor, BuildCounts& built) {
    if (cursor.child == topology_.nodes[cursor.node].count) {
      cursor.todo = Todo::publish;
      return;
    }
    const std::uint32_t child = first_child(cursor) + cursor.child;
    const std::uint32_t entries = plan_.listed(child);
    ++built.children;
    built.entries += entries;
    spend(cursor, build_ticks_.child, 1);
    spend(cursor, build_ticks_.entry, entries);
    cursor.todo = Todo::record;
    if (entries != 0) {
      write(cursor, list_address(copy, child),
            std::uint64_t{entries} * layout_.record_bytes(memory::RecordKind::list));
    }
  }

  void take_leaf(DynamicCursor& cursor, std::uint32_t copy, NodeStatistics& statistics, std::uint32_t leaf,
                 std::uint32_t tests) {
    ++statistics.steps.leaves;
    statistics.steps.lists += tests != 0 ? 1 : 0;
    spend(cursor, ticks_.leaf, 1);
    cursor.tests = tests;
    cursor.entry = topology_.entries.data() + topology_.nodes[leaf].first;
    cursor.entry_end = cursor.entry + tests;
    read_record(cursor, copy, leaf, tests != 0 ? Todo::list : Todo::step);
  }

  // Any step: its compute cycles, and the first of its references made ready.
  void take_step(DynamicCursor& cursor, std::uint32_t copy, NodeStatistics& statistics, std::uint32_t word) {
    const std::uint32_t operand = operand_of(word);
    StepCounts& steps = statistics.steps;
    switch (step_of(word)) {
      case Step::branch:
        ++steps.branches;
        spend(cursor, ticks_.branch, 1);
        read_record(cursor, copy, operand,
                    plan_.place(operand).lazy == TreePlan::none ? Todo::step : Todo::branch);
        break;
      case Step::leaf:
        take_leaf(cursor, copy, statistics, operand, topology_.nodes[operand].count);
        break;
      case Step::partial_leaf:
        take_leaf(cursor, copy, statistics, operand, *cursor.word++);
        break;
      case Step::ray:
        ++(steps.*ray_counters[operand & 3U]);
        spend(cursor, ticks_.ray[operand & 3U], 1);
        break;
      case Step::shade:
        ++steps.shades;
        spend(cursor, ticks_.shade, 1);
        read(cursor, memory::RecordKind::material, layout_.address(memory::RecordKind::material, operand),
             layout_.record_bytes(memory::RecordKind::material));
        break;
      case Step::light:
        ++steps.lights;
        spend(cursor, ticks_.light, 1);
        break;
      case Step::texel:
        ++steps.texels;
        spend(cursor, ticks_.texel, 1);
        read(cursor, memory::RecordKind::texel,
             layout_.address(memory::RecordKind::texel, input_.log.texture_begin[operand] + *cursor.word++),
             layout_.record_bytes(memory::RecordKind::texel));
        break;
    }
  }

  ReplayInput input_;
  const TreePlan& plan_;
  const memory::Layout& layout_;
  const accel::Topology& topology_;
  Caches caches_;
  std::uint32_t line_bytes_;
  unsigned unit_shift_;
  TreeCopies copies_;
  BranchLists lists_;
  StepTicks ticks_;
  BuildTicks build_ticks_;
  sim::Ticks local_access_;
  sim::Ticks local_beat_;
  memory::Address local_base_;  ///< from here on addresses are those of a node's own memory
};

}  // namespace marti::processors
