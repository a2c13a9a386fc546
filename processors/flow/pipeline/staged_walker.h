// A walk through the log that visits a leaf in two parts: first its record, then its list and the
// tests.
#pragma once

#include "processors/flow/pipeline/stages.h"
#include "processors/walk/log_walker.h"

namespace marti::processors::flow {

/// `Caches` is one of node_caches.h.
template <class Caches>
class StagedWalker : public walk::LogWalker<Caches> {
  using Base = walk::LogWalker<Caches>;
  using Base::entries_;
  using Base::input_;
  using Base::node_bytes_;
  using Base::plan_;
  using Base::plan_limit_;
  using Base::rank_;
  using Base::ticks_;
  using Base::topology_;

 public:
  using Base::Base;

  /// Whether the visit at `word`, of a whole leaf, has objects. Looks where the visit itself will look.
  [[nodiscard]] bool has_objects(std::uint32_t word) const {
    const walk::Visit* const visit = planned(word);
    return visit != nullptr ? visit->counts.of(walk::VisitCount::list) != 0
                            : topology_[program::operand_of(word)].count != 0;
  }

  /// Begins the first part of a visit to the leaf at cursor.word, its record; `advance` over no words (word
  /// equal to word_end) then reads it. cursor.word stays at the leaf, for begin_objects.
  void begin_record(walk::Cursor& cursor, cost::NodeStatistics& statistics) const {
    const std::uint32_t leaf = program::operand_of(*cursor.word);
    Base::note_node(cursor, leaf);
    ++statistics.steps.leaves;
    walk::spend(cursor, ticks_.leaf, 1);
    if (const walk::Visit* const visit = planned(*cursor.word)) {
      const std::uint32_t lines = visit->counts.of(walk::VisitCount::node_line);
      cost::hits_of(statistics, memory::RecordKind::node) += lines;
      begin_lines(cursor, visit->begin, lines, ticks_.leaf);
      return;
    }
    cursor.kind = memory::RecordKind::node;
    const std::uint32_t record = rank_ == nullptr ? leaf : rank_[leaf];
    cursor.at = record == walk::no_record ? 0 : input_.layout.address(cursor.kind, record);
    cursor.end = cursor.at + (record == walk::no_record ? 0 : node_bytes_);
  }

  /// Begins the second part of the visit, perhaps at another node: the leaf's list and tests. cursor.word
  /// moves past the leaf; `advance` over no words then reads and tests.
  void begin_objects(walk::Cursor& cursor, cost::NodeStatistics& statistics, walk::VisitTally& tally) const {
    const std::uint32_t* const word = cursor.word;
    Base::note_node(cursor, program::operand_of(*word));
    cursor.word += program::step_words(word);
    if (const walk::Visit* const visit = planned(*word)) {
      // All of the visit except what begin_record counted.
      const std::uint32_t lines = visit->counts.of(walk::VisitCount::node_line);
      Base::add(tally, visit->counts, statistics);
      --statistics.steps.leaves;
      cost::hits_of(statistics, memory::RecordKind::node) -= lines;
      begin_lines(cursor, visit->begin + lines, visit->lines - lines, ticks_.leaf + lines * ticks_.hit);
      return;
    }
    cursor.list_count = entries_read(word, input_.log.topology);
    statistics.steps.lists += cursor.list_count != 0 ? 1 : 0;
    cursor.entry = entries_ + topology_[program::operand_of(*word)].first;
    cursor.entry_end = cursor.entry + cursor.list_count;
    cursor.tested = program::step_of(*word) == program::Step::mailed_leaf ? word + 2 : nullptr;
    cursor.entry_number = 0;
  }

 private:
  // The plan of a whole leaf's visit; null when it has to be taken record by record.
  [[nodiscard]] const walk::Visit* planned(std::uint32_t word) const {
    if (word >= plan_limit_) {
      return nullptr;
    }
    const walk::Visit& visit = plan_->visits[program::operand_of(word)];
    return visit.lines == 0 ? nullptr : &visit;
  }
  // `time`: what the visit takes before the first of them, when all lines hit.
  void begin_lines(walk::Cursor& cursor, std::uint32_t first, std::uint32_t lines, sim::Ticks time) const {
    cursor.line = plan_->lines.data() + first;
    cursor.line_end = cursor.line + lines;
    cursor.visit_time = time;
  }
};

}  // namespace marti::processors::flow
