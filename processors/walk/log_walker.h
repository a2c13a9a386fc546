// Walks a node through its log: spends the compute cycles of each step, looks its references up in the node's
// cache, and stops where the node needs something shared. It does not depend on events or queues.
#pragma once

#include <algorithm>
#include <bit>
#include <memory>
#include <span>
#include <utility>

#include "processors/cost/accounting.h"
#include "processors/cost/step_time.h"
#include "processors/machine/packets.h"
#include "processors/program/ray_tree.h"
#include "processors/program/work_log.h"
#include "processors/walk/behind_cache.h"
#include "processors/walk/cache_counting.h"
#include "processors/walk/kept_visits.h"
#include "processors/walk/lines_under_way.h"
#include "processors/walk/log_cursor.h"
#include "processors/walk/node_caches.h"
#include "processors/walk/node_order.h"
#include "processors/walk/replay_input.h"
#include "processors/walk/visit_plan.h"
#include "sim/prefetch.h"

namespace marti::processors::walk {

/// `Caches` is a class of node_caches.h, one of these guarded (guarded_caches.h), one that counts
/// (counted_caches.h; they may be guarded, too), or one that records its misses (stripped_log.cpp): its
/// member record(time, kind, line) is called at each miss; it returns `time` and the time of a hit.
template <class Caches>
class LogWalker {
 public:
  static constexpr bool steps_singly = true;  ///< can stop after every reference

  LogWalker(const ReplayInput& input, Caches caches)
      : input_(input),
        caches_(std::move(caches)),
        topology_(input.log.topology.nodes.data()),
        entries_(input.log.topology.entries.data()),
        rank_(input.node_rank.empty() ? nullptr : input.node_rank.data()),
        node_bytes_(input.layout.record_bytes(memory::RecordKind::node)),
        transform_bytes_(input.layout.record_bytes(memory::RecordKind::transform)),
        entry_bytes_(input.layout.record_bytes(memory::RecordKind::list)),
        line_bytes_(input.config.reference_bytes()),
        unit_shift_(static_cast<unsigned>(std::countr_zero(line_bytes_))),
        ticks_(cost::step_ticks(input.config, input.log)),
        behind_(input),
        passes_misses_on_(!behind_.only_reads()) {
    if (Caches::present && !counted && !guarded && !input.step_by_step && input.causes == nullptr) {
      plan_ = input.visits == nullptr ? KeptVisits().of(input) : input.visits->of(input);
      plan_limit_ = plan_->empty() ? 0 : 2U << program::operand_bits;
    }
  }

  [[nodiscard]] const cost::StepTicks& ticks() const { return ticks_; }
  [[nodiscard]] const BehindCache& behind() const { return behind_; }
  /// See PrivateSecondLevel::hit.
  std::optional<sim::Ticks> second_level_hit(std::uint32_t node, std::uint32_t line) {
    return behind_.second_level_hit(node, line);
  }
  [[nodiscard]] Caches& caches() { return caches_; }
  [[nodiscard]] const Caches& caches() const { return caches_; }

  /// Puts the cursor before the first step of its pixel.
  void begin_pixel(Cursor& cursor) const {
    const std::span<const std::uint32_t> words = input_.log.pixel(cursor.x, cursor.y);
    cursor.word = words.data();
    cursor.word_end = words.data() + words.size();
  }

  /// Takes the node's caches through a packet that it does not trace: no time passes, nothing is counted, and
  /// memory is not accessed.
  void warm_up(std::uint32_t node, const machine::Packet& packet) {
    cost::NodeStatistics unused;
    Cursor cursor;
    for (cursor.y = packet.y0; cursor.y < packet.y1; ++cursor.y) {
      for (cursor.x = packet.x0; cursor.x < packet.x1; ++cursor.x) {
        begin_pixel(cursor);
        while (advance<true>(node, cursor, unused) != Stop::end) {
          pass(cursor);
        }
      }
    }
  }

  /// Continues `node` from its cursor. Without RunAhead it stops after every reference.
  template <bool RunAhead>
  Stop advance(std::uint32_t node, Cursor& cursor, cost::NodeStatistics& statistics) {
    VisitTally tally;
    const Stop stop = advance<RunAhead>(node, cursor, statistics, tally);
    flush(tally, statistics);
    return stop;
  }
  /// As above, but planned visits are counted in `tally`, which goes on from one walk of the node to the next
  /// until flush().
  template <bool RunAhead>
  Stop advance(std::uint32_t node, Cursor& cursor, cost::NodeStatistics& statistics, VisitTally& tally) {
    Stop stop = Stop::hit;
    do {
      stop = walk<RunAhead>(caches_.view(node), cursor, statistics, tally);
      if (stop != Stop::miss || !behind_.second_level().present() || !serve(node, cursor, statistics)) {
        break;
      }
      stop = Stop::hit;
    } while (RunAhead);
    behind_.count_bytes(node);
    return stop;
  }
  /// Adds the visits of a tally to the statistics and clears it.
  void flush(VisitTally& tally, cost::NodeStatistics& statistics) const {
    add_visits(tally.counts, tally.visits, input_.log.mailboxes, statistics);
    tally = {};
  }

  /// Ends a pixel whose steps are done: what is left is to convert and store it, unless the host collects it.
  void finish_pixel(std::uint32_t /*node*/, Cursor& cursor, cost::NodeStatistics& statistics) const {
    if (input_.config.pixels == machine::Pixels::written) {
      ++statistics.steps.pixels;
      spend(cursor, ticks_.pixel, 1);
    }
  }

  /// Address and bytes of the reference that missed: a whole line with a cache, else the referenced bytes
  /// within the interleave unit.
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
  /// What was counted beyond hits and misses; empty where nothing is.
  [[nodiscard]] CacheCountResult counts() const {
    if constexpr (counted) {
      return caches_.counting().result();
    } else {
      return {};
    }
  }
  /// Counts what the wait for the reference that missed was for, where that is counted.
  void note_wait(const Cursor& cursor, const memory::Service& service) const {
    if constexpr (counted) {
      caches_.counting().wait(cursor.kind, cursor.origin, service);
    }
  }
  /// Notes which ray the steps that follow are of, where that is counted: for schemes in which rays move.
  static void note_ray(Cursor& cursor, const program::LoggedRay& ray) {
    if constexpr (counted) {
      cursor.origin.begin_ray(ray.operand());
    }
  }
  /// Prefetches what advance() uses beside the first cache line of the cursor and the misses.
  static void prefetch(const Cursor& cursor, const cost::NodeStatistics& statistics) {
    sim::prefetch(cursor);
    sim::prefetch(statistics.references.hits);
    sim::prefetch(statistics.steps);
  }
  /// Prefetches the next words and lines that the cursor comes to.
  static void prefetch_steps(const Cursor& cursor) {
    sim::prefetch_line(cursor.word);
    sim::prefetch_line(cursor.line);
  }
  /// Moves the cursor past the reference that missed, which has been served.
  void pass(Cursor& cursor) const {
    if (in_visit(cursor)) {
      pass_line(cursor);
    } else {
      cursor.at = ((cursor.at >> unit_shift_) + 1) << unit_shift_;
    }
  }

 protected:
  using View = typename Caches::View;
  static constexpr bool guarded = requires { Caches::guarded; };
  static constexpr bool counted = are_counted<Caches>;
  static constexpr bool records = requires { Caches::records; };

  // Counts a planned visit, all of whose lines hit.
  [[gnu::always_inline]] void add(VisitTally& tally, const VisitCounts& visit,
                                  cost::NodeStatistics& statistics) const {
    tally.counts += visit;
    if (++tally.visits == most_summed_visits) [[unlikely]] {
      flush(tally, statistics);
    }
  }

  static bool in_visit(const Cursor& cursor) { return cursor.line != cursor.line_end; }
  // Moves the cursor past a line of a planned visit that has missed. The cursor's `time` includes
  // the miss already; `visit_time` goes on as if the line had hit.
  void pass_line(Cursor& cursor) const {
    ++cursor.line;
    cursor.visit_time += ticks_.hit;
  }
  // Whether something is left of a step that is taken record by record.
  static bool in_step(const Cursor& cursor) {
    return cursor.at < cursor.end || cursor.list_count != 0 || cursor.entry != cursor.entry_end;
  }

  template <bool RunAhead>
  Stop walk(View cache, Cursor& cursor, cost::NodeStatistics& statistics, VisitTally& tally) {
    Stop stop = Stop::hit;
    if constexpr (Caches::present && !records) {
      if (in_visit(cursor) && !finish_visit(cache, cursor, statistics, stop)) {
        return stop;
      }
    }
    if (in_step(cursor) && (!touch<RunAhead>(cache, cursor, statistics, cursor.kind, stop) ||
                            !finish_leaf<RunAhead>(cache, cursor, statistics, stop))) {
      return stop;
    }
    if (branch_read(cache, cursor, stop)) {
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
      if (!take_step<RunAhead>(cache, cursor, statistics, *cursor.word++, stop) ||
          branch_read(cache, cursor, stop)) {
        return stop;
      }
    }
    return Stop::end;
  }

  // True when a branch's record was read and the node has to stop to prefetch the branch's children.
  static bool branch_read(View cache, Cursor& cursor, Stop& stop) {
    if constexpr (guarded) {
      if (cursor.branch != Cursor::no_branch && cache.wants_children(cursor.branch)) {
        stop = Stop::due;
        return true;
      }
      cursor.branch = Cursor::no_branch;
    }
    return false;
  }

  // Takes all planned visits up to the next step that has to be taken record by record; its working values
  // are in registers. False when the node has to stop.
  bool visit_planned(View cache, Cursor& cursor, cost::NodeStatistics& statistics, VisitTally& tally,
                     Stop& stop) {
    const std::uint32_t* word = cursor.word;
    const std::uint32_t* const word_end = cursor.word_end;
    const std::uint32_t limit = plan_limit_;
    sim::Ticks time = cursor.time;
    VisitTally sum = tally;
    for (; word != word_end && *word < limit; ++word) {
      const Visit& visit = plan_->visits[program::operand_of(*word)];
      if (visit.lines == 0) [[unlikely]] {
        break;
      }
      const std::uint32_t* const first = plan_->lines.data() + visit.begin;
      const std::uint32_t* const end = first + visit.lines;
      const std::uint32_t* line = first;
      // All lines of a visit are counted as hits. miss() corrects the count; where misses are recorded, only
      // the sum of hits and misses is used.
      add(sum, visit.counts, statistics);
      if constexpr (records) {
        for (; line != end; ++line) {
          if (!look_up(cache, line)) {
            const std::uint64_t label = label_of(line);
            (void)caches_.record(sim::add_ticks(time, time_of_label(label)), kind_of_label(label), *line);
          }
        }
      } else {
        while (line != end && look_up(cache, line)) {
          ++line;
        }
        if (line != end) [[unlikely]] {
          cursor.time = time;
          cursor.word = word + 1;
          cursor.visit_time = 0;
          cursor.line = first;
          cursor.line_end = end;
          if (!miss(cursor, statistics, line, stop) || !finish_visit(cache, cursor, statistics, stop)) {
            tally = sum;
            return false;
          }
          time = cursor.time;
          continue;
        }
      }
      time = sim::add_ticks(time, visit.time);
    }
    cursor.word = word;
    cursor.time = time;
    tally = sum;
    return true;
  }

  [[gnu::always_inline]] bool look_up(View cache, const std::uint32_t* line) const {
    if constexpr (counted) {
      return cache.access(kind_of_label(label_of(line)), *line, Use{});  // not reached: nothing is planned
    } else if constexpr (Caches::by_kind) {
      return cache.access(kind_of_label(label_of(line)), *line);
    } else {
      return cache.access(memory::RecordKind::node, *line);  // such caches ignore the kind
    }
  }

  // Takes the rest of a planned visit after a miss. False when the node has to stop.
  bool finish_visit(View cache, Cursor& cursor, cost::NodeStatistics& statistics, Stop& stop) {
    const std::uint32_t* const end = cursor.line_end;
    while (cursor.line != end) {
      const std::uint32_t* missed = cursor.line;
      while (missed != end && look_up(cache, missed)) {
        ++missed;
      }
      if (missed == end) {
        settle_visit(cursor, end, time_of_label(label_of(end - 1)) + ticks_.hit);
      } else if (!miss(cursor, statistics, missed, stop)) {
        return false;
      }
    }
    return true;
  }

  // `line` of a visit has missed. False when the node has to stop for it.
  bool miss(Cursor& cursor, cost::NodeStatistics& statistics, const std::uint32_t* line, Stop& stop) {
    const std::uint64_t label = label_of(line);
    settle_visit(cursor, line, time_of_label(label));
    --cost::hits_of(statistics, kind_of_label(label));
    ++cost::misses_of(statistics, kind_of_label(label));
    if (passes_misses_on_) {
      stop = Stop::miss;
      return false;
    }
    read_alone(cursor, statistics, line_bytes_);
    pass_line(cursor);
    return true;
  }

  [[nodiscard]] std::uint64_t label_of(const std::uint32_t* line) const {
    return plan_->labels[static_cast<std::size_t>(line - plan_->lines.data())];
  }

  // Makes record `index` the current one and reads it; `bytes` may span several records of an array.
  template <bool RunAhead>
  bool refer(View cache, Cursor& cursor, cost::NodeStatistics& statistics, memory::RecordKind kind,
             std::uint64_t index, std::uint64_t bytes, Stop& stop) {
    cursor.at = input_.layout.address(kind, index);
    cursor.end = cursor.at + bytes;
    if (counted && !of_tree(kind)) {
      cursor.origin.level = 0;
    }
    return touch<RunAhead>(cache, cursor, statistics, kind, stop);
  }

  // What follows is read for this node of the tree.
  void note_node(Cursor& cursor, std::uint32_t tree_node) const {
    if constexpr (counted) {
      cursor.origin.level = topology_[tree_node].level;
    }
  }

  bool access(View cache, const Cursor& cursor, std::uint32_t line) const {
    if constexpr (counted) {
      const memory::Address next = (memory::Address{line} + 1) << unit_shift_;
      const auto bytes = static_cast<std::uint32_t>(std::min(cursor.end, next) - cursor.at);
      return cache.access(cursor.kind, line, Use{cursor.origin, cursor.time, cursor.at, bytes});
    } else {
      return cache.access(cursor.kind, line);
    }
  }

  // Reads the rest of the current record, unit by unit. False when the node has to stop.
  template <bool RunAhead>
  bool touch(View cache, Cursor& cursor, cost::NodeStatistics& statistics, memory::RecordKind kind,
             Stop& stop) {
    while (cursor.at < cursor.end) {
      const memory::Address unit = cursor.at >> unit_shift_;
      cursor.kind = kind;
      if constexpr (guarded) {
        if (cache.awaits(kind, static_cast<std::uint32_t>(unit), cursor.time) != LinesUnderWay::none) {
          stop = Stop::due;
          return false;
        }
      }
      if (access(cache, cursor, static_cast<std::uint32_t>(unit))) {
        ++cost::hits_of(statistics, kind);
        spend(cursor, ticks_.hit, 1);
        cursor.at = (unit + 1) << unit_shift_;
      } else if constexpr (records) {
        ++cost::misses_of(statistics, kind);
        cursor.time = caches_.record(cursor.time, kind, static_cast<std::uint32_t>(unit));
        cursor.at = (unit + 1) << unit_shift_;
      } else {
        ++cost::misses_of(statistics, kind);
        if (passes_misses_on_) {
          stop = Stop::miss;
          return false;
        }
        read_alone(cursor, statistics, missed_bytes(cursor));
        cursor.at = (unit + 1) << unit_shift_;
      }
      if constexpr (!RunAhead) {
        return false;
      }
    }
    return true;
  }

  // Takes the rest of a leaf that is not planned: reads its list, then tests its objects one by one, each
  // after the look-up of its mailbox where there are mailboxes.
  template <bool RunAhead>
  bool finish_leaf(View cache, Cursor& cursor, cost::NodeStatistics& statistics, Stop& stop) {
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
      if (input_.log.mailboxes) {
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

  // Whether the mailboxes left the current entry's test out; moves on to the next entry.
  static bool left_out(Cursor& cursor) {
    if (cursor.tested == nullptr) {
      return false;
    }
    return !program::tested_in_mask(cursor.tested, cursor.entry_number++);
  }

  // Counts a test and spends its compute time.
  void begin_test(Cursor& cursor, cost::StepCounts& steps, std::uint32_t primitive) const {
    cursor.time = sim::add_ticks(cursor.time, cost::count_test(ticks_, input_.log.kind_of(primitive), steps));
  }

  template <bool RunAhead>
  bool refer_node(View cache, Cursor& cursor, cost::NodeStatistics& statistics, std::uint32_t tree_node,
                  Stop& stop) {
    note_node(cursor, tree_node);
    const std::uint32_t record = rank_ == nullptr ? tree_node : rank_[tree_node];
    if (record == no_record) {
      return true;
    }
    return refer<RunAhead>(cache, cursor, statistics, memory::RecordKind::node, record, node_bytes_, stop);
  }

  template <bool RunAhead>
  bool take_leaf(View cache, Cursor& cursor, cost::NodeStatistics& statistics, std::uint32_t leaf,
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

  // Takes any step record by record: its compute cycles first, then its references.
  template <bool RunAhead>
  bool take_step(View cache, Cursor& cursor, cost::NodeStatistics& statistics, std::uint32_t word,
                 Stop& stop) {
    const std::uint32_t operand = program::operand_of(word);
    cost::StepCounts& steps = statistics.steps;
    switch (program::step_of(word)) {
      case program::Step::branch:
        ++steps.branches;
        spend(cursor, ticks_.branch, 1);
        if constexpr (guarded) {
          cursor.branch = operand;
        }
        return refer_node<RunAhead>(cache, cursor, statistics, operand, stop);
      case program::Step::leaf:
        return take_leaf<RunAhead>(cache, cursor, statistics, operand, topology_[operand].count, nullptr,
                                   stop);
      case program::Step::partial_leaf: {
        const std::uint32_t tests = *cursor.word++;
        return take_leaf<RunAhead>(cache, cursor, statistics, operand, tests, nullptr, stop);
      }
      case program::Step::mailed_leaf: {
        const std::uint32_t entries = *cursor.word++;
        const std::uint32_t* const tested = cursor.word;
        cursor.word += program::mask_words(entries);
        return take_leaf<RunAhead>(cache, cursor, statistics, operand, entries, tested, stop);
      }
      case program::Step::ray:
        if (counted) {
          cursor.origin.begin_ray(operand);
        }
        ++(steps.*cost::ray_counters[program::ray_number_of(operand)]);
        spend(cursor, ticks_.ray[program::ray_number_of(operand)], 1);
        return true;
      case program::Step::shade:
        ++steps.shades;
        spend(cursor, ticks_.shade, 1);
        return refer<RunAhead>(cache, cursor, statistics, memory::RecordKind::material, operand,
                               input_.layout.record_bytes(memory::RecordKind::material), stop);
      case program::Step::cut:
        ++steps.cuts;
        spend(cursor, ticks_.cut, 1);
        return refer_node<RunAhead>(cache, cursor, statistics, operand, stop);
      case program::Step::transform:
        ++steps.transforms;
        spend(cursor, ticks_.transform, 1);
        if constexpr (guarded) {
          cursor.branch = operand;
        }
        note_node(cursor, operand);
        return refer<RunAhead>(cache, cursor, statistics, memory::RecordKind::transform, rank_[operand],
                               transform_bytes_, stop);
      case program::Step::pass:
        ++steps.passes;
        spend(cursor, ticks_.pass, 1);
        return refer<RunAhead>(cache, cursor, statistics, memory::RecordKind::material, operand,
                               input_.layout.record_bytes(memory::RecordKind::material), stop);
      case program::Step::any_hit:
        ++steps.any_hits;
        spend(cursor, ticks_.any_hit, 1);
        return refer<RunAhead>(cache, cursor, statistics, memory::RecordKind::material, operand,
                               input_.layout.record_bytes(memory::RecordKind::material), stop);
      case program::Step::light:
        ++steps.lights;
        spend(cursor, ticks_.light, 1);
        return true;
      case program::Step::texel:
        ++steps.texels;
        spend(cursor, ticks_.texel, 1);
        return refer<RunAhead>(cache, cursor, statistics, memory::RecordKind::texel,
                               input_.log.texture_begin[operand] + *cursor.word++,
                               input_.layout.record_bytes(memory::RecordKind::texel), stop);
    }
    return true;
  }

  // Serves a miss of a machine with a second level. False when it needs the interconnect.
  bool serve(std::uint32_t node, Cursor& cursor, cost::NodeStatistics& statistics) {
    const auto line = static_cast<std::uint32_t>(missed_address(cursor) >> unit_shift_);
    if (!behind_.second_level_holds(node, line, cursor.time, statistics.time)) {
      if (!behind_.reads_alone()) {
        return false;
      }
      read_alone(cursor, statistics, line_bytes_);
    } else if constexpr (counted) {
      caches_.counting().second_level_hit(cursor.kind, cursor.origin);
    }
    pass(cursor);
    return true;
  }

  // A read without the interconnect.
  void read_alone(Cursor& cursor, cost::NodeStatistics& statistics, std::uint32_t bytes) {
    note_wait(cursor, behind_.read(bytes, cursor.time, statistics.time));
  }

  ReplayInput input_;
  Caches caches_;
  // Branches and leaves are the two lowest steps, so one comparison tells a planned step. plan_limit_ is 0
  // without a plan.
  static_assert(static_cast<std::uint32_t>(program::Step::branch) == 0 &&
                static_cast<std::uint32_t>(program::Step::leaf) == 1);
  std::shared_ptr<const VisitPlan> plan_;  // null where no visit is planned
  std::uint32_t plan_limit_ = 0;
  const accel::TopologyNode* topology_;
  const std::uint32_t* entries_;
  const std::uint32_t* rank_;  // null: records lie in the order of node numbers
  std::uint32_t node_bytes_;
  std::uint32_t transform_bytes_;
  std::uint32_t entry_bytes_;
  std::uint32_t line_bytes_;
  unsigned unit_shift_;
  cost::StepTicks ticks_;
  BehindCache behind_;
  bool passes_misses_on_;  ///< to the second level or the interconnect
};

}  // namespace marti::processors::walk
