// Walks a node through its log: spends the compute cycles of each step, looks its references up in the
// node's cache, and stops where the node needs something shared. It knows no event and no queue.
#pragma once

#include <algorithm>
#include <bit>
#include <utility>

#include "processors/accounting.h"
#include "processors/node_caches.h"
#include "processors/packets.h"
#include "processors/program/work_log.h"
#include "processors/replay_input.h"
#include "processors/stages.h"
#include "processors/step_time.h"
#include "processors/visit_plan.h"

namespace marti::processors {

/// Where a node is in its packet: the pixel, the word of the pixel's log, and within a step either a line of
/// a planned visit or a byte of a record with, for a leaf, the objects still to come.
struct Cursor {
  sim::Ticks time = 0;
  const std::uint32_t* word = nullptr;
  const std::uint32_t* word_end = nullptr;
  const std::uint32_t* line = nullptr;  ///< next line of the planned visit
  const std::uint32_t* line_end = nullptr;
  memory::Address at = 0;   ///< next byte of the current record
  memory::Address end = 0;  ///< one past its last byte
  const std::uint32_t* entry = nullptr;
  const std::uint32_t* entry_end = nullptr;
  const std::uint32_t* tested = nullptr;  ///< of a mailed leaf: a bit for each entry; null: all are tested
  std::uint32_t entry_number = 0;         ///< of `entry` in the mailed leaf's list
  std::uint32_t list_count = 0;   ///< entries of the current leaf's list, while its read is still to come
  std::uint32_t tests_begun = 0;  ///< of the planned visit, by kind as in tests_of_kind
  std::uint32_t writes = 0;       ///< where the next pixel write goes in the write buffer
  std::uint32_t x = 0;
  std::uint32_t y = 0;
  Packet packet;
  memory::RecordKind kind = memory::RecordKind::node;
};

/// Why a walk stopped: after a hit (only without running ahead), at a miss, or at the end of its words.
enum class Stop : std::uint8_t { hit, miss, end };

/// `Caches` is one of node_caches.h.
template <class Caches>
class LogWalker {
 public:
  LogWalker(const ReplayInput& input, Caches caches)
      : input_(input),
        caches_(std::move(caches)),
        topology_(input.log.topology.nodes.data()),
        entries_(input.log.topology.entries.data()),
        rank_(input.node_rank.empty() ? nullptr : input.node_rank.data()),
        node_bytes_(input.layout.record_bytes(memory::RecordKind::node)),
        entry_bytes_(input.layout.record_bytes(memory::RecordKind::list)),
        line_bytes_(Caches::present ? input.config.cache.cache.line : input.config.banks.interleave),
        unit_shift_(static_cast<unsigned>(std::countr_zero(line_bytes_))),
        ticks_(step_ticks(input.config, input.log)),
        mailboxes_(input.log.mailboxes),
        local_access_(input.config.local.clock.cycles(input.config.local.access_cycles)),
        local_beat_(input.config.local.clock.cycles(input.config.local.cycles_per_beat)),
        local_database_(input.config.placement == Placement::replicated) {
    if (Caches::present && !input.step_by_step) {
      plan_ = plan_visits(input.log, input.layout, input.node_rank, unit_shift_, ticks_);
      plan_limit_ = plan_.empty() ? 0 : 2U << operand_bits;
    }
  }

  [[nodiscard]] const StepTicks& ticks() const { return ticks_; }

  /// Takes `node` on from its cursor. Without RunAhead it stops after every reference.
  template <bool RunAhead>
  Stop advance(std::uint32_t node, Cursor& cursor, NodeStatistics& statistics) {
    Tally tally;
    const Stop stop = walk<RunAhead>(caches_.view(node), cursor, statistics, tally);
    flush(tally, statistics);
    return stop;
  }

  /// Begins a visit to the leaf at cursor.word as far as its own record; `advance` over no words (word equal
  /// to word_end) reads it. cursor.word stays at the leaf, for begin_objects.
  void begin_record(Cursor& cursor, NodeStatistics& statistics) const {
    const std::uint32_t leaf = operand_of(*cursor.word);
    ++statistics.steps.leaves;
    spend(cursor, ticks_.leaf, 1);
    if (const Visit* const visit = planned(*cursor.word)) {
      const std::uint32_t lines = visit->counts.of(VisitCount::node_line);
      hits_of(statistics, memory::RecordKind::node) += lines;
      begin_lines(cursor, visit->begin, lines);
      return;
    }
    cursor.kind = memory::RecordKind::node;
    cursor.at = input_.layout.address(cursor.kind, rank_ == nullptr ? leaf : rank_[leaf]);
    cursor.end = cursor.at + node_bytes_;
  }

  /// Begins the rest of that visit, perhaps at another node: the leaf's list and its tests. cursor.word goes
  /// behind the leaf; `advance` over no words reads and tests.
  void begin_objects(Cursor& cursor, NodeStatistics& statistics) const {
    const std::uint32_t* const word = cursor.word;
    cursor.word += step_words(word);
    if (const Visit* const visit = planned(*word)) {
      // The whole visit but what begin_record counted.
      const std::uint32_t lines = visit->counts.of(VisitCount::node_line);
      add_visits(visit->counts, 1, mailboxes_, statistics);
      --statistics.steps.leaves;
      hits_of(statistics, memory::RecordKind::node) -= lines;
      begin_lines(cursor, visit->begin + lines, visit->lines - lines);
      return;
    }
    cursor.list_count = entries_read(word, input_.log.topology);
    statistics.steps.lists += cursor.list_count != 0 ? 1 : 0;
    cursor.entry = entries_ + topology_[operand_of(*word)].first;
    cursor.entry_end = cursor.entry + cursor.list_count;
    cursor.tested = step_of(*word) == Step::mailed_leaf ? word + 2 : nullptr;
    cursor.entry_number = 0;
  }

  /// The steps of a pixel are done; what is left is to convert and store it.
  void finish_pixel(Cursor& cursor, NodeStatistics& statistics) const {
    ++statistics.steps.pixels;
    spend(cursor, ticks_.pixel, 1);
  }

  /// Address and bytes of the reference that missed: a whole line with a cache, else its own part of the
  /// interleave unit.
  [[nodiscard]] memory::Address missed_address(const Cursor& cursor) const {
    if (in_visit(cursor)) {
      return memory::Address{*cursor.line} << unit_shift_;
    }
    return Caches::present ? (cursor.at >> unit_shift_) << unit_shift_ : cursor.at;
  }
  [[nodiscard]] std::uint32_t missed_bytes(const Cursor& cursor) const {
    if (Caches::present) {
      return line_bytes_;
    }
    const memory::Address next = ((cursor.at >> unit_shift_) + 1) << unit_shift_;
    return static_cast<std::uint32_t>(std::min(cursor.end, next) - cursor.at);
  }
  /// The reference that missed has been served.
  void pass(Cursor& cursor) const {
    if (in_visit(cursor)) {
      ++cursor.line;
    } else {
      cursor.at = ((cursor.at >> unit_shift_) + 1) << unit_shift_;
    }
  }

 private:
  using View = typename Caches::View;

  // Sums over the planned visits of one walk that are not in the statistics yet.
  struct Tally {
    VisitCounts counts;
    std::uint32_t visits = 0;
  };

  static bool in_visit(const Cursor& cursor) { return cursor.line != cursor.line_end; }

  // The plan of a whole leaf's visit; null when it has to be taken record by record.
  [[nodiscard]] const Visit* planned(std::uint32_t word) const {
    if (word >= plan_limit_) {
      return nullptr;
    }
    const Visit& visit = plan_.visits[operand_of(word)];
    return visit.lines == 0 ? nullptr : &visit;
  }
  void begin_lines(Cursor& cursor, std::uint32_t first, std::uint32_t lines) const {
    cursor.line = plan_.lines.data() + first;
    cursor.line_end = cursor.line + lines;
    cursor.tests_begun = 0;
  }

  void flush(Tally& tally, NodeStatistics& statistics) const {
    const auto of = [&](VisitCount what) { return std::int64_t{tally.counts.of(what)}; };
    StepCounts& steps = statistics.steps;
    steps.branches += tally.visits - of(VisitCount::leaf);
    steps.leaves += of(VisitCount::leaf);
    steps.lists += of(VisitCount::list);
    steps.tests += of(VisitCount::test) + of(VisitCount::sphere_test) + of(VisitCount::cone_test);
    steps.sphere_tests += of(VisitCount::sphere_test);
    steps.cone_tests += of(VisitCount::cone_test);
    if (mailboxes_) {
      steps.lookups += of(VisitCount::test) + of(VisitCount::sphere_test) + of(VisitCount::cone_test);
    }
    hits_of(statistics, memory::RecordKind::node) += of(VisitCount::node_line);
    hits_of(statistics, memory::RecordKind::list) += of(VisitCount::list_line);
    hits_of(statistics, memory::RecordKind::primitive) += of(VisitCount::primitive_line);
    tally = {};
  }
  static std::int64_t& hits_of(NodeStatistics& statistics, memory::RecordKind kind) {
    return statistics.references.hits[static_cast<std::size_t>(kind)];
  }
  static std::int64_t& misses_of(NodeStatistics& statistics, memory::RecordKind kind) {
    return statistics.references.misses[static_cast<std::size_t>(kind)];
  }
  static void spend(Cursor& cursor, sim::Ticks each, std::int64_t count) {
    cursor.time = sim::add_ticks(cursor.time, sim::multiply_ticks(each, count));
  }

  template <bool RunAhead>
  Stop walk(View cache, Cursor& cursor, NodeStatistics& statistics, Tally& tally) {
    Stop stop = Stop::hit;
    if ((Caches::present && !finish_visit(cache, cursor, statistics, stop)) ||
        !touch<RunAhead>(cache, cursor, statistics, cursor.kind, stop) ||
        !finish_leaf<RunAhead>(cache, cursor, statistics, stop)) {
      return stop;
    }
    while (cursor.word != cursor.word_end) {
      if constexpr (RunAhead && Caches::present) {
        if (!visit_planned(cache, cursor, statistics, tally, stop)) {
          return stop;
        }
        if (cursor.word == cursor.word_end) {
          break;
        }
      }
      if (!take_step<RunAhead>(cache, cursor, statistics, *cursor.word++, stop)) {
        return stop;
      }
    }
    return Stop::end;
  }

  // Takes all planned visits up to the next step that has to be taken record by record, with what it needs
  // in registers. False when the node has to stop.
  bool visit_planned(View cache, Cursor& cursor, NodeStatistics& statistics, Tally& tally, Stop& stop) {
    const std::uint32_t* word = cursor.word;
    const std::uint32_t* const word_end = cursor.word_end;
    const std::uint32_t limit = plan_limit_;
    sim::Ticks time = cursor.time;
    Tally sum = tally;
    for (; word != word_end && *word < limit; ++word) {
      const Visit& visit = plan_.visits[operand_of(*word)];
      if (visit.lines == 0) [[unlikely]] {
        break;
      }
      const std::uint32_t* const first = plan_.lines.data() + visit.begin;
      const std::uint32_t* const end = first + visit.lines;
      const std::uint32_t* line = first;
      while (line != end && look_up(cache, line)) {
        ++line;
      }
      // Lines count as hits until they miss.
      sum.counts += visit.counts;
      if (++sum.visits == most_summed_visits) [[unlikely]] {
        flush(sum, statistics);
      }
      if (line == end) [[likely]] {
        time = sim::add_ticks(time, visit.time);
        continue;
      }
      cursor.time =
          sim::add_ticks(time, visit.counts.of(VisitCount::leaf) != 0 ? ticks_.leaf : ticks_.branch);
      cursor.word = word + 1;
      cursor.tests_begun = 0;
      cursor.line = first;
      cursor.line_end = end;
      if (!miss(cursor, statistics, line, stop) || !finish_visit(cache, cursor, statistics, stop)) {
        tally = sum;
        return false;
      }
      time = cursor.time;
    }
    cursor.word = word;
    cursor.time = time;
    tally = sum;
    return true;
  }

  [[gnu::always_inline]] bool look_up(View cache, const std::uint32_t* line) const {
    if constexpr (Caches::by_kind) {
      return cache.access(kind_of_label(label_of(line)), *line);
    } else {
      return cache.access(memory::RecordKind::node, *line);  // such caches do not look at the kind
    }
  }

  // What is left of a planned visit after a miss.
  bool finish_visit(View cache, Cursor& cursor, NodeStatistics& statistics, Stop& stop) {
    const std::uint32_t* const end = cursor.line_end;
    while (cursor.line != end) {
      const std::uint32_t* missed = cursor.line;
      while (missed != end && look_up(cache, missed)) {
        ++missed;
      }
      if (missed == end) {
        settle(cursor, end, tests_of_label(label_of(end - 1)));
      } else if (!miss(cursor, statistics, missed, stop)) {
        return false;
      }
    }
    return true;
  }

  // Brings the time of a visit up to `line`, before which `tests` tests have begun.
  void settle(Cursor& cursor, const std::uint32_t* line, std::uint32_t tests) const {
    // No kind has fewer than before, so the kinds' counts do not borrow from each other.
    const std::uint32_t begun = tests - cursor.tests_begun;
    const std::uint32_t triangles = tests_of_kind(begun, accel::PrimitiveKind::triangle);
    const std::uint32_t spheres = tests_of_kind(begun, accel::PrimitiveKind::sphere);
    const std::uint32_t cones = tests_of_kind(begun, accel::PrimitiveKind::cone);
    spend(cursor, ticks_.test, triangles);
    spend(cursor, ticks_.sphere_test, spheres);
    spend(cursor, ticks_.cone_test, cones);
    spend(cursor, ticks_.lookup, std::int64_t{triangles} + spheres + cones);
    spend(cursor, ticks_.hit, line - cursor.line);
    cursor.tests_begun = tests;
    cursor.line = line;
  }

  // `line` of a visit has missed. False when the node has to stop for it.
  bool miss(Cursor& cursor, NodeStatistics& statistics, const std::uint32_t* line, Stop& stop) const {
    const std::uint32_t label = label_of(line);
    settle(cursor, line, tests_of_label(label));
    --hits_of(statistics, kind_of_label(label));
    ++misses_of(statistics, kind_of_label(label));
    if (!local_database_) {
      stop = Stop::miss;
      return false;
    }
    read_local(cursor, statistics, line_bytes_);
    ++cursor.line;
    return true;
  }

  [[nodiscard]] std::uint32_t label_of(const std::uint32_t* line) const {
    return plan_.labels[static_cast<std::size_t>(line - plan_.lines.data())];
  }

  // Makes record `index` the current one and reads it; `bytes` may span several records of an array.
  template <bool RunAhead>
  bool refer(View cache, Cursor& cursor, NodeStatistics& statistics, memory::RecordKind kind,
             std::uint64_t index, std::uint64_t bytes, Stop& stop) {
    cursor.at = input_.layout.address(kind, index);
    cursor.end = cursor.at + bytes;
    return touch<RunAhead>(cache, cursor, statistics, kind, stop);
  }

  // Reads what is left of the current record, unit by unit. False when the node has to stop.
  template <bool RunAhead>
  bool touch(View cache, Cursor& cursor, NodeStatistics& statistics, memory::RecordKind kind, Stop& stop) {
    while (cursor.at < cursor.end) {
      const memory::Address unit = cursor.at >> unit_shift_;
      cursor.kind = kind;
      if (cache.access(kind, static_cast<std::uint32_t>(unit))) {
        ++hits_of(statistics, kind);
        spend(cursor, ticks_.hit, 1);
        cursor.at = (unit + 1) << unit_shift_;
      } else {
        ++misses_of(statistics, kind);
        if (!local_database_) {
          stop = Stop::miss;
          return false;
        }
        read_local(cursor, statistics, missed_bytes(cursor));
        cursor.at = (unit + 1) << unit_shift_;
      }
      if constexpr (!RunAhead) {
        return false;
      }
    }
    return true;
  }

  // What is left of a leaf that is not planned: reading its list, then looking its objects' mailboxes up, if
  // there are any, and testing them one by one.
  template <bool RunAhead>
  bool finish_leaf(View cache, Cursor& cursor, NodeStatistics& statistics, Stop& stop) {
    if (cursor.list_count != 0) {
      const std::uint64_t bytes = std::uint64_t{cursor.list_count} * entry_bytes_;
      cursor.list_count = 0;
      const auto first = static_cast<std::uint64_t>(cursor.entry - entries_);
      if (!refer<RunAhead>(cache, cursor, statistics, memory::RecordKind::list, first, bytes, stop)) {
        return false;
      }
    }
    while (cursor.entry != cursor.entry_end) {
      const std::uint32_t primitive = *cursor.entry++;
      if (mailboxes_) {
        ++statistics.steps.lookups;
        spend(cursor, ticks_.lookup, 1);
        if (left_out(cursor)) {
          continue;
        }
      }
      begin_test(cursor, statistics.steps, primitive);
      if (!refer<RunAhead>(cache, cursor, statistics, memory::RecordKind::primitive, primitive,
                           input_.layout.record_bytes(memory::RecordKind::primitive, primitive), stop)) {
        return false;
      }
    }
    return true;
  }

  // Whether mailboxes left the entry at hand out; goes on to the next.
  static bool left_out(Cursor& cursor) {
    if (cursor.tested == nullptr) {
      return false;
    }
    return !tested_in_mask(cursor.tested, cursor.entry_number++);
  }

  // A test's computing, at its price.
  void begin_test(Cursor& cursor, StepCounts& steps, std::uint32_t primitive) const {
    cursor.time = sim::add_ticks(cursor.time, count_test(ticks_, input_.log.kind_of(primitive), steps));
  }

  template <bool RunAhead>
  bool refer_node(View cache, Cursor& cursor, NodeStatistics& statistics, std::uint32_t tree_node,
                  Stop& stop) {
    const std::uint32_t record = rank_ == nullptr ? tree_node : rank_[tree_node];
    return refer<RunAhead>(cache, cursor, statistics, memory::RecordKind::node, record, node_bytes_, stop);
  }

  template <bool RunAhead>
  bool take_leaf(View cache, Cursor& cursor, NodeStatistics& statistics, std::uint32_t leaf,
                 std::uint32_t entries, const std::uint32_t* tested, Stop& stop) {
    ++statistics.steps.leaves;
    statistics.steps.lists += entries != 0 ? 1 : 0;
    spend(cursor, ticks_.leaf, 1);
    cursor.list_count = entries;
    cursor.entry = entries_ + topology_[leaf].first;
    cursor.entry_end = cursor.entry + entries;
    cursor.tested = tested;
    cursor.entry_number = 0;
    return refer_node<RunAhead>(cache, cursor, statistics, leaf, stop) &&
           finish_leaf<RunAhead>(cache, cursor, statistics, stop);
  }

  // Any step, record by record: its compute cycles first, then its references.
  template <bool RunAhead>
  bool take_step(View cache, Cursor& cursor, NodeStatistics& statistics, std::uint32_t word, Stop& stop) {
    const std::uint32_t operand = operand_of(word);
    StepCounts& steps = statistics.steps;
    switch (step_of(word)) {
      case Step::branch:
        ++steps.branches;
        spend(cursor, ticks_.branch, 1);
        return refer_node<RunAhead>(cache, cursor, statistics, operand, stop);
      case Step::leaf:
        return take_leaf<RunAhead>(cache, cursor, statistics, operand, topology_[operand].count, nullptr,
                                   stop);
      case Step::partial_leaf: {
        const std::uint32_t tests = *cursor.word++;
        return take_leaf<RunAhead>(cache, cursor, statistics, operand, tests, nullptr, stop);
      }
      case Step::mailed_leaf: {
        const std::uint32_t entries = *cursor.word++;
        const std::uint32_t* const tested = cursor.word;
        cursor.word += mask_words(entries);
        return take_leaf<RunAhead>(cache, cursor, statistics, operand, entries, tested, stop);
      }
      case Step::ray:
        ++(steps.*ray_counters[operand & 3U]);
        spend(cursor, ticks_.ray[operand & 3U], 1);
        return true;
      case Step::shade:
        ++steps.shades;
        spend(cursor, ticks_.shade, 1);
        return refer<RunAhead>(cache, cursor, statistics, memory::RecordKind::material, operand,
                               input_.layout.record_bytes(memory::RecordKind::material), stop);
      case Step::cut:
        ++steps.cuts;
        spend(cursor, ticks_.cut, 1);
        return refer_node<RunAhead>(cache, cursor, statistics, operand, stop);
      case Step::pass:
        ++steps.passes;
        spend(cursor, ticks_.pass, 1);
        return refer<RunAhead>(cache, cursor, statistics, memory::RecordKind::material, operand,
                               input_.layout.record_bytes(memory::RecordKind::material), stop);
      case Step::light:
        ++steps.lights;
        spend(cursor, ticks_.light, 1);
        return true;
      case Step::texel:
        ++steps.texels;
        spend(cursor, ticks_.texel, 1);
        return refer<RunAhead>(cache, cursor, statistics, memory::RecordKind::texel,
                               input_.log.texture_begin[operand] + *cursor.word++,
                               input_.layout.record_bytes(memory::RecordKind::texel), stop);
    }
    return true;
  }

  void read_local(Cursor& cursor, NodeStatistics& statistics, std::uint32_t bytes) const {
    const std::int64_t width = input_.config.local.width;
    const sim::Ticks transfer = sim::multiply_ticks(local_beat_, (std::int64_t{bytes} + width - 1) / width);
    statistics.time[static_cast<std::size_t>(Activity::transfer)] += transfer;
    statistics.time[static_cast<std::size_t>(Activity::bank_access)] += local_access_;
    cursor.time = sim::add_ticks(cursor.time, sim::add_ticks(transfer, local_access_));
  }

  ReplayInput input_;
  Caches caches_;
  // Branches and leaves are the two lowest steps, so one comparison tells a planned step; nothing is planned
  // without a plan.
  static_assert(static_cast<std::uint32_t>(Step::branch) == 0 && static_cast<std::uint32_t>(Step::leaf) == 1);
  VisitPlan plan_;
  std::uint32_t plan_limit_ = 0;
  const accel::TopologyNode* topology_;
  const std::uint32_t* entries_;
  const std::uint32_t* rank_;  // null: records lie in the order of node numbers
  std::uint32_t node_bytes_;
  std::uint32_t entry_bytes_;
  std::uint32_t line_bytes_;
  unsigned unit_shift_;
  StepTicks ticks_;
  bool mailboxes_;
  sim::Ticks local_access_;
  sim::Ticks local_beat_;
  bool local_database_;
};

}  // namespace marti::processors
