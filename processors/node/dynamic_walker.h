// Walks a node through its log on a machine whose tree is built while it is used: as LogWalker does, and
// splits branches on the way. It does not depend on events or queues.
//
// A line is settled when nobody can write it any more. A reference to a line that is not settled is not taken
// ahead of its time: the walk stops before it and continues when the simulation has reached that time. A miss
// too changes the cache only when its time has come, because the line brought in may push another out, and
// another node's write may have emptied a way by then. Hits of settled lines are taken ahead: they change
// nothing that others see, and the order of using a line and removing another does not matter.
#pragma once

#include <algorithm>
#include <bit>
#include <optional>
#include <utility>

#include "processors/cost/accounting.h"
#include "processors/cost/build_mix.h"
#include "processors/cost/step_time.h"
#include "processors/node/branch_lists.h"
#include "processors/node/build_result.h"
#include "processors/node/counted_look_ups.h"
#include "processors/node/dynamic_cursor.h"
#include "processors/node/tree_addresses.h"
#include "processors/node/tree_copies.h"
#include "processors/program/work_log.h"
#include "processors/walk/lines_under_way.h"
#include "processors/walk/local_memory.h"
#include "processors/walk/node_caches.h"
#include "processors/walk/prefetch_lines.h"
#include "processors/walk/replay_input.h"
#include "processors/walk/second_level.h"
#include "processors/walk/visit_plan.h"

namespace marti::processors::node {

template <class Caches>
class DynamicWalker {
 public:
  DynamicWalker(const walk::ReplayInput& input, Caches caches)
      : input_(input),
        plan_(*input.tree),
        layout_(input.layout),
        topology_(input.log.topology),
        caches_(std::move(caches)),
        line_bytes_(input.config.reference_bytes()),
        unit_shift_(static_cast<unsigned>(std::countr_zero(line_bytes_))),
        copies_(plan_, topology_, layout_, input.config),
        addresses_(plan_, topology_, layout_, copies_),
        lists_(topology_),
        ticks_(cost::step_ticks(input.config, input.log)),
        build_ticks_(cost::build_ticks(input.config)),
        local_(input.config.local),
        second_level_(input.config),
        local_base_(input.config.placement == machine::Placement::replicated ? 0
                    : private_()                                             ? plan_.lower_base()
                                                                             : ~memory::Address{0}) {
    if (plans && !input.step_by_step && input.causes == nullptr) {
      visits_ = walk::plan_initial_visits(plan_, input.log, layout_, unit_shift_, ticks_);
      planned_limit_ = visits_.empty() ? 0 : 2U << program::operand_bits;
    }
  }

  DynamicWalker(const DynamicWalker&) = delete;  // its members refer to each other
  DynamicWalker& operator=(const DynamicWalker&) = delete;

  [[nodiscard]] const cost::StepTicks& ticks() const { return ticks_; }
  [[nodiscard]] const cost::BuildTicks& times() const { return build_ticks_; }
  [[nodiscard]] TreeCopies& copies() { return copies_; }
  [[nodiscard]] const TreeCopies& copies() const { return copies_; }
  [[nodiscard]] const walk::PrivateSecondLevel& second_level() const { return second_level_; }
  /// See PrivateSecondLevel::hit.
  std::optional<sim::Ticks> second_level_hit(std::uint32_t node, std::uint32_t line) {
    return second_level_.hit(node, line);
  }
  [[nodiscard]] Caches& caches() { return caches_.caches(); }
  [[nodiscard]] const Caches& caches() const { return caches_.caches(); }
  /// The counts beyond hits and misses; empty where nothing is counted.
  [[nodiscard]] walk::CacheCountResult counts() const { return caches_.counts(); }
  /// Counts what the wait for a transaction was for, where that is counted.
  void note_wait(const DynamicCursor& cursor, const memory::Service& service) const {
    caches_.note_wait(cursor, service);
  }
  /// Removes a line from a node's caches; returns how many copies there were.
  [[nodiscard]] std::int64_t take_out(std::uint32_t node, std::uint32_t line) {
    return caches().view(node).remove(line) + second_level_.remove(node, line);
  }

  /// Continues `node` from its cursor. Without RunAhead it stops before every reference.
  template <bool RunAhead>
  DynamicStop advance(std::uint32_t node, DynamicCursor& cursor, cost::NodeStatistics& statistics,
                      BuildCounts& built) {
    const std::uint32_t copy = copies_.copy_of(node);
    const LineStates lines = copies_.lines(copy);
    const View cache = caches().view(node);
    for (;;) {
      while (cursor.at < cursor.end) {
        if (cursor.writing) {
          if (cursor.at < local_base_) {
            return DynamicStop::write;
          }
          write_local(copy, cursor, statistics, built);
        } else if (DynamicStop stop = DynamicStop::due;
                   !refer<RunAhead>(node, copy, lines, cache, cursor, statistics, built, stop)) {
          return stop;
        }
      }
      if constexpr (guarded) {
        if (cursor.todo == Todo::step && cursor.children != DynamicCursor::none) {
          if (wants_children(copy, lines, cache, cursor.children)) {
            return DynamicStop::children;
          }
          cursor.children = DynamicCursor::none;
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
          if constexpr (RunAhead && plans) {
            take_planned(lines, cache, cursor, statistics);
          }
          if (cursor.word == cursor.word_end) {
            if (input_.config.pixels == machine::Pixels::written) {
              ++statistics.steps.pixels;
              spend(cursor, ticks_.pixel, 1);
            }
            return DynamicStop::write;
          }
          take_step(cursor, copy, statistics, *cursor.word++);
          break;
        case Todo::list:
          cursor.todo = Todo::tests;
          read(cursor, memory::RecordKind::list, addresses_.list(copy, cursor.node),
               std::uint64_t{cursor.tests} * layout_.record_bytes(memory::RecordKind::list));
          break;
        case Todo::tests:
          if (cursor.entry == cursor.entry_end) {
            cursor.todo = Todo::step;
            break;
          }
          if (input_.log.mailboxes) {
            ++statistics.steps.lookups;
            spend(cursor, ticks_.lookup, 1);
            if (cursor.tested != nullptr && !program::tested_in_mask(cursor.tested, cursor.entry_number++)) {
              ++cursor.entry;
              break;
            }
          }
          begin_test(cursor, statistics.steps, *cursor.entry);
          read_one(cursor, memory::RecordKind::primitive, *cursor.entry++);
          break;
        case Todo::branch:
          if (cursor.seen) {
            cursor.todo = Todo::step;
          } else if (!private_()) {
            spend(cursor, build_ticks_.lock, 1);
            cursor.todo = Todo::lock;
            return DynamicStop::lock;
          } else if (guarded && copies_.taken(copy, plan_.place(cursor.node).lazy)) {
            if (read_again(copy, cursor)) {
              return DynamicStop::other;
            }
          } else if (addresses_.has_slot(plan_.place(cursor.node))) {
            cursor.todo = Todo::inherit;
            read(cursor, memory::RecordKind::node, addresses_.initial_record(cursor.node), node_bytes());
          } else {
            take(node, copy, cursor, built);
          }
          break;
        case Todo::voxel:
          cursor.todo = Todo::step;
          if (const walk::TreePlan::Place& place = plan_.place(cursor.node);
              addresses_.has_slot(place) && !copies_.built(copy, place.lazy)) {
            read(cursor, memory::RecordKind::node, addresses_.initial_record(cursor.node), node_bytes());
          }
          break;
        case Todo::inherit:
          // While a node with several contexts waited for the record, another one may have taken the branch.
          if (guarded && copies_.taken(copy, plan_.place(cursor.node).lazy)) {
            if (read_again(copy, cursor)) {
              return DynamicStop::other;
            }
          } else {
            take(node, copy, cursor, built);
          }
          break;
        case Todo::lock:
          if (cursor.lock == Lock::won) {
            ++built.splits;
            begin_split(copy, cursor, built);
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
        case Todo::record: {
          cursor.todo = Todo::make;
          const std::uint32_t child = topology_.nodes[cursor.node].first + cursor.child++;
          // Before the frame the tree that all nodes share is built; a private tree's own records stay empty.
          write(cursor, cursor.before ? addresses_.initial_record(child) : addresses_.record(copy, child),
                node_bytes());
          break;
        }
        case Todo::publish:
          cursor.todo = Todo::done;
          spend(cursor, build_ticks_.publish, 1);
          write(cursor, addresses_.record(copy, cursor.node), node_bytes());
          break;
        case Todo::done:
          cursor.todo = Todo::step;
          break;
      }
    }
  }

  /// Address and bytes of the transaction that the node stopped for. A miss reads a whole line with a cache,
  /// else the referenced bytes within the interleave unit; a write has the written bytes within a line.
  [[nodiscard]] memory::Address address(const DynamicCursor& cursor) const {
    return Caches::present && !cursor.writing ? (cursor.at >> unit_shift_) << unit_shift_ : cursor.at;
  }
  [[nodiscard]] std::uint32_t bytes(const DynamicCursor& cursor) const {
    return Caches::present && !cursor.writing ? line_bytes_ : part(cursor);
  }
  /// Address of the record that a lock transaction is for.
  [[nodiscard]] memory::Address locked_address(std::uint32_t node, const DynamicCursor& cursor) const {
    return addresses_.record(copies_.copy_of(node), cursor.node);
  }

  /// Whether the branch that a cursor is to read again is still being split.
  [[nodiscard]] bool is_being_split(std::uint32_t node, const DynamicCursor& cursor) const {
    return !copies_.built(copies_.copy_of(node), plan_.place(cursor.node).lazy);
  }
  /// Calls visit(line) for the lines of the records of a branch's children that are not in the node's own
  /// memory, in ascending order, until one call returns false; returns the last call's result, or true.
  template <class Visit>
  bool each_child_line(std::uint32_t copy, std::uint32_t branch, const Visit& visit) const {
    const accel::TopologyNode& node = topology_.nodes[branch];
    return walk::each_line_of(
        node.count, unit_shift_,
        [&](std::uint32_t number) -> std::optional<walk::RecordBytes> {
          const memory::Address address = addresses_.record(copy, node.first + number);
          return address < local_base_ ? std::optional(walk::RecordBytes{address, node_bytes()})
                                       : std::nullopt;
        },
        visit);
  }
  /// Notes that the node's cache holds a line which other nodes may still write.
  void note_cached(std::uint32_t node, std::uint32_t line) {
    if (!private_()) {
      copies_.note_cached(copies_.copy_of(node), line);
    }
  }

  /// Brings in the line of a miss whose time has come. False when the second level has served the miss.
  bool miss(std::uint32_t node, DynamicCursor& cursor, cost::NodeStatistics& statistics) {
    const std::uint32_t copy = copies_.copy_of(node);
    const auto line = static_cast<std::uint32_t>(cursor.at >> unit_shift_);
    (void)LookUps::access(caches().view(node), cursor, line, part(cursor), is_own(cursor));
    ++statistics.references.misses[static_cast<std::size_t>(cursor.kind)];
    if (Caches::present) {
      note_cached(node, line);
    }
    look(copy, cursor);
    if (second_level_.access(node, line, cursor.time, statistics.time)) {
      caches_.note_second_level_hit(cursor);
      pass(cursor);
      return false;
    }
    return true;
  }
  /// Moves the cursor past a transaction that has been made.
  void pass(DynamicCursor& cursor) const { cursor.at = ((cursor.at >> unit_shift_) + 1) << unit_shift_; }

  /// Whether the bytes just written were the last of a lazy branch's own record.
  [[nodiscard]] bool publishes(const DynamicCursor& cursor) const {
    return cursor.todo == Todo::done && cursor.at >= cursor.end &&
           plan_.place(cursor.node).lazy != walk::TreePlan::none;
  }

 private:
  using View = typename Caches::View;
  using LookUps = CountedLookUps<Caches>;
  static constexpr bool guarded = requires { Caches::guarded; };
  static constexpr bool plans =
      Caches::present && !walk::are_counted<Caches> && !guarded;  // see take_planned()

  // Whether reading the branch prefetches something, or may at that time: a line that is not settled may be
  // taken out of the cache until then.
  bool wants_children(std::uint32_t copy, const LineStates& lines, View cache, std::uint32_t branch) const {
    return Caches::present && input_.config.prefetch.children &&
           !each_child_line(copy, branch, [&](std::uint32_t line) {
             return lines.settled(line) && cache.holds(memory::RecordKind::node, line);
           });
  }
  // Another context of the node has taken the branch: its record is read again when it is split. True when it
  // is not yet.
  bool read_again(std::uint32_t copy, DynamicCursor& cursor) const {
    read_record(cursor, copy, cursor.node, Todo::branch);
    return !copies_.built(copy, plan_.place(cursor.node).lazy);
  }

  // Whether the present reference is to the part of a private tree that the node has built itself.
  [[nodiscard]] bool is_own(const DynamicCursor& cursor) const {
    return private_() && cursor.at >= plan_.lower_base();
  }
  [[nodiscard]] bool private_() const {
    return input_.config.build.sharing == machine::Sharing::private_trees;
  }
  [[nodiscard]] std::uint32_t node_bytes() const { return layout_.record_bytes(memory::RecordKind::node); }
  [[nodiscard]] std::uint32_t part(const DynamicCursor& cursor) const {
    const memory::Address next = ((cursor.at >> unit_shift_) + 1) << unit_shift_;
    return static_cast<std::uint32_t>(std::min(cursor.end, next) - cursor.at);
  }
  static void spend(DynamicCursor& cursor, sim::Ticks each, std::int64_t count) {
    cursor.time = sim::add_ticks(cursor.time, sim::multiply_ticks(each, count));
  }

  static void read(DynamicCursor& cursor, memory::RecordKind kind, memory::Address at, std::uint64_t bytes) {
    cursor.kind = kind;
    cursor.at = at;
    cursor.end = at + bytes;
    cursor.writing = false;
  }
  static void write(DynamicCursor& cursor, memory::Address at, std::uint64_t bytes) {
    read(cursor, memory::RecordKind::node, at, bytes);  // the kind of a write does not matter
    cursor.writing = true;
  }
  void read_record(DynamicCursor& cursor, std::uint32_t copy, std::uint32_t tree_node, Todo todo) const {
    cursor.node = tree_node;
    cursor.todo = todo;
    LookUps::note_level(cursor, topology_.nodes[tree_node].level);
    read(cursor, memory::RecordKind::node, addresses_.record(copy, tree_node), node_bytes());
  }
  void read_one(DynamicCursor& cursor, memory::RecordKind kind, std::uint64_t index) const {
    if (!walk::of_tree(kind)) {
      LookUps::note_level(cursor, 0);
    }
    read(cursor, kind, layout_.address(kind, index), layout_.record_bytes(kind, index));
  }

  // Counts a test and spends its compute time.
  void begin_test(DynamicCursor& cursor, cost::StepCounts& steps, std::uint32_t primitive) const {
    cursor.time = sim::add_ticks(cursor.time, cost::count_test(ticks_, input_.log.kind_of(primitive), steps));
  }

  // Takes visits to the initial tree whose lines are all settled and in the cache. The first visit that is
  // not of this kind is left to be taken record by record, from its beginning: its lines looked up here are
  // then used a second time in the same order, which changes nothing.
  void take_planned(const LineStates& lines, View cache, DynamicCursor& cursor,
                    cost::NodeStatistics& statistics) {
    walk::VisitCounts counts;
    std::uint32_t visits = 0;
    sim::Ticks time = cursor.time;
    const std::uint32_t* word = cursor.word;
    for (; word != cursor.word_end && *word < planned_limit_; ++word) {
      const walk::Visit& visit = visits_.visits[program::operand_of(*word)];
      const std::uint32_t* line = visits_.lines.data() + visit.begin;
      const std::uint32_t* const end = line + visit.lines;
      while (line != end && lines.settled(*line) && look_up(cache, line)) {
        ++line;
      }
      if (line != end || visit.lines == 0) {
        break;
      }
      time = sim::add_ticks(time, visit.time);
      counts += visit.counts;
      if (++visits == walk::most_summed_visits) [[unlikely]] {
        walk::add_visits(std::exchange(counts, {}), visits, input_.log.mailboxes, statistics);
        visits = 0;
      }
    }
    cursor.word = word;
    cursor.time = time;
    walk::add_visits(counts, visits, input_.log.mailboxes, statistics);
  }

  [[gnu::always_inline]] bool look_up(View cache, const std::uint32_t* line) const {
    if constexpr (Caches::by_kind) {
      const auto at = static_cast<std::size_t>(line - visits_.lines.data());
      return cache.touch(walk::kind_of_label(visits_.labels[at]), *line);
    } else {
      return cache.touch(memory::RecordKind::node, *line);  // such caches ignore the kind
    }
  }

  // Notes whether the lazy branch whose record the node now reads is built.
  void look(std::uint32_t copy, DynamicCursor& cursor) const {
    if (cursor.todo == Todo::branch) {
      cursor.seen = copies_.built(copy, plan_.place(cursor.node).lazy);
    }
  }

  // Reads the next part. False when the node has to stop.
  template <bool RunAhead>
  bool refer(std::uint32_t node, std::uint32_t copy, const LineStates& lines, View cache,
             DynamicCursor& cursor, cost::NodeStatistics& statistics, BuildCounts& built, DynamicStop& stop) {
    const auto line = static_cast<std::uint32_t>(cursor.at >> unit_shift_);
    if ((!RunAhead || (Caches::present && !lines.settled(line))) && !cursor.due) {
      stop = DynamicStop::due;
      return false;
    }
    const bool local = cursor.at >= local_base_;
    if constexpr (guarded) {
      if (!local && cache.awaits(cursor.kind, line, cursor.time) != walk::LinesUnderWay::none) {
        stop = DynamicStop::line;
        return false;
      }
    }
    cursor.due = false;
    if (local ? LookUps::access(cache, cursor, line, part(cursor), is_own(cursor))
              : LookUps::touch(cache, cursor, line, part(cursor))) [[likely]] {
      ++statistics.references.hits[static_cast<std::size_t>(cursor.kind)];
      spend(cursor, ticks_.hit, 1);
    } else if (!local) {
      stop = DynamicStop::miss;
      return false;
    } else {
      ++statistics.references.misses[static_cast<std::size_t>(cursor.kind)];
      if (!second_level_.access(node, line, cursor.time, statistics.time)) {
        ++built.local_misses;
        use_local(cursor, statistics, Caches::present ? line_bytes_ : part(cursor));
      } else {
        caches_.note_second_level_hit(cursor);
      }
    }
    look(copy, cursor);
    pass(cursor);
    return true;
  }

  void use_local(DynamicCursor& cursor, cost::NodeStatistics& statistics, std::uint32_t bytes) const {
    const memory::Service service = local_.read(bytes, cursor.time);
    cost::add_service(statistics.time, service);
    caches_.note_wait(cursor, service);
    cursor.time = service.done;
  }

  void write_local(std::uint32_t copy, DynamicCursor& cursor, cost::NodeStatistics& statistics,
                   BuildCounts& built) {
    built.written_bytes += part(cursor);
    use_local(cursor, statistics, part(cursor));
    pass(cursor);
    if (publishes(cursor)) {
      // Only a private tree lies in a node's own memory, so no other node reads the branch.
      copies_.publish(copy, plan_.place(cursor.node).lazy);
    }
  }

  void take(std::uint32_t node, std::uint32_t copy, DynamicCursor& cursor, BuildCounts& built) {
    copies_.take(copy, plan_.place(cursor.node).lazy, node);
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
    read(cursor, memory::RecordKind::list, addresses_.list(copy, cursor.node),
         std::uint64_t{listed} * layout_.record_bytes(memory::RecordKind::list));
  }

  void sort_next(DynamicCursor& cursor, BuildCounts& built) {
    if (cursor.entry != cursor.entry_end) {
      spend(cursor, build_ticks_.listed, 1);
      read_one(cursor, memory::RecordKind::primitive, *cursor.entry++);
      return;
    }
    // Primitives that the branch listed and no leaf does are classified too; the overlap tests follow.
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
    const std::uint32_t child = topology_.nodes[cursor.node].first + cursor.child;
    const std::uint32_t entries = plan_.listed(child);
    ++built.children;
    built.entries += entries;
    spend(cursor, build_ticks_.child, 1);
    spend(cursor, build_ticks_.entry, entries);
    cursor.todo = Todo::record;
    if (entries != 0) {
      write(cursor, addresses_.list(copy, child),
            std::uint64_t{entries} * layout_.record_bytes(memory::RecordKind::list));
    }
  }

  void take_leaf(DynamicCursor& cursor, std::uint32_t copy, cost::NodeStatistics& statistics,
                 std::uint32_t leaf, std::uint32_t tests, const std::uint32_t* tested = nullptr) {
    ++statistics.steps.leaves;
    statistics.steps.lists += tests != 0 ? 1 : 0;
    spend(cursor, ticks_.leaf, 1);
    cursor.tests = tests;
    cursor.tested = tested;
    cursor.entry_number = 0;
    cursor.entry = topology_.entries.data() + topology_.nodes[leaf].first;
    cursor.entry_end = cursor.entry + tests;
    read_record(cursor, copy, leaf, tests != 0 ? Todo::list : Todo::step);
  }

  // Takes any step: spends its compute cycles and prepares the first of its references.
  void take_step(DynamicCursor& cursor, std::uint32_t copy, cost::NodeStatistics& statistics,
                 std::uint32_t word) {
    const std::uint32_t operand = program::operand_of(word);
    cost::StepCounts& steps = statistics.steps;
    switch (program::step_of(word)) {
      case program::Step::branch:
        ++steps.branches;
        spend(cursor, ticks_.branch, 1);
        if constexpr (guarded) {
          cursor.children = operand;
        }
        read_record(cursor, copy, operand,
                    plan_.place(operand).lazy == walk::TreePlan::none ? Todo::step : Todo::branch);
        break;
      case program::Step::leaf:
        take_leaf(cursor, copy, statistics, operand, topology_.nodes[operand].count);
        break;
      case program::Step::partial_leaf:
        take_leaf(cursor, copy, statistics, operand, *cursor.word++);
        break;
      case program::Step::mailed_leaf: {
        const std::uint32_t entries = *cursor.word++;
        const std::uint32_t* const tested = cursor.word;
        cursor.word += program::mask_words(entries);
        take_leaf(cursor, copy, statistics, operand, entries, tested);
        break;
      }
      case program::Step::ray:
        LookUps::note_ray(cursor, operand);
        ++(steps.*cost::ray_counters[program::ray_number_of(operand)]);
        spend(cursor, ticks_.ray[program::ray_number_of(operand)], 1);
        break;
      case program::Step::shade:
        ++steps.shades;
        spend(cursor, ticks_.shade, 1);
        read_one(cursor, memory::RecordKind::material, operand);
        break;
      case program::Step::cut:
        ++steps.cuts;
        spend(cursor, ticks_.cut, 1);
        read_record(cursor, copy, operand, Todo::voxel);
        break;
      case program::Step::transform:
        throw sim::InternalError("an instance in a tree that is built during the frame");
      case program::Step::pass:
        ++steps.passes;
        spend(cursor, ticks_.pass, 1);
        read_one(cursor, memory::RecordKind::material, operand);
        break;
      case program::Step::any_hit:
        ++steps.any_hits;
        spend(cursor, ticks_.any_hit, 1);
        read_one(cursor, memory::RecordKind::material, operand);
        break;
      case program::Step::light:
        ++steps.lights;
        spend(cursor, ticks_.light, 1);
        break;
      case program::Step::texel:
        ++steps.texels;
        spend(cursor, ticks_.texel, 1);
        read_one(cursor, memory::RecordKind::texel, input_.log.texture_begin[operand] + *cursor.word++);
        break;
    }
  }

  walk::ReplayInput input_;
  const walk::TreePlan& plan_;
  const memory::Layout& layout_;
  const accel::Topology& topology_;
  LookUps caches_;
  std::uint32_t line_bytes_;
  unsigned unit_shift_;
  TreeCopies copies_;
  TreeAddresses addresses_;
  walk::VisitPlan visits_;  // of the initial tree
  std::uint32_t planned_limit_ = 0;
  BranchLists lists_;
  cost::StepTicks ticks_;
  cost::BuildTicks build_ticks_;
  walk::LocalMemory local_;
  walk::PrivateSecondLevel second_level_;
  memory::Address local_base_;  ///< addresses from here on are in a node's own memory
};

}  // namespace marti::processors::node
