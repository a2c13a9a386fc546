// Walks a node through a stripped log (processors/walk/stripped_log.h), in LogWalker's place.
#pragma once

#include <bit>
#include <span>
#include <utility>

#include "processors/cost/step_time.h"
#include "processors/walk/local_memory.h"
#include "processors/walk/log_cursor.h"
#include "processors/walk/replay_input.h"
#include "processors/walk/second_level.h"
#include "processors/walk/stripped_log.h"

namespace marti::processors {

/// `Caches` is one of node_caches.h. It has the members of LogWalker that ImageNodes calls.
template <class Caches>
class StrippedWalker {
 public:
  static constexpr bool steps_singly = false;

  StrippedWalker(const ReplayInput& input, Caches caches)
      : stripped_(*input.stripped),
        caches_(std::move(caches)),
        line_bytes_(input.config.reference_bytes()),
        line_shift_(static_cast<unsigned>(std::countr_zero(line_bytes_))),
        clock_(input.config.clock),
        ticks_(step_ticks(input.config, input.log)),
        local_(input.config.local),
        local_database_(input.config.placement == Placement::replicated),
        second_level_(input.config) {}

  [[nodiscard]] const StepTicks& ticks() const { return ticks_; }
  [[nodiscard]] const PrivateSecondLevel& second_level() const { return second_level_; }

  [[nodiscard]] std::span<const std::uint32_t> words_of(std::uint32_t x, std::uint32_t y) const {
    return stripped_.pixel(x, y);
  }

  /// Continues `node` from its cursor to its next miss or the end of its pixel. Hits are counted with the
  /// packet's totals, when the packet is finished.
  template <bool RunAhead>
  Stop advance(std::uint32_t node, Cursor& cursor, NodeStatistics& statistics) {
    static_assert(RunAhead);
    const auto cache = caches_.view(node);
    const std::uint32_t* word = cursor.word;
    sim::Ticks time = cursor.time;
    for (;;) {
      time = sim::add_ticks(time, clock_.cycles(word[0]));
      const std::uint32_t what = word[1];
      if (what == StrippedLog::end_of_pixel) {
        cursor.word = word;
        cursor.time = time;
        return Stop::end;
      }
      word += 2;
      const auto kind = static_cast<memory::RecordKind>(what & StrippedLog::end_of_pixel);
      const std::uint32_t line = what >> StrippedLog::kind_bits;
      if (cache.access(kind, line)) [[likely]] {
        time = sim::add_ticks(time, ticks_.hit);
        continue;
      }
      --hits_of(statistics, kind);
      ++misses_of(statistics, kind);
      cursor.time = time;
      if (!serve(node, line, cursor, statistics)) {
        cursor.word = word;
        cursor.at = memory::Address{line} << line_shift_;
        return Stop::miss;
      }
      time = cursor.time;
    }
  }

  void finish_pixel(Cursor& cursor, NodeStatistics& statistics) const {
    ++statistics.steps.pixels;
    spend(cursor, ticks_.pixel, 1);
    if (cursor.x + 1 == cursor.packet.x1 && cursor.y + 1 == cursor.packet.y1) {
      const PacketTotals& totals = stripped_.totals(cursor.x, cursor.y);
      sim::merge(statistics.steps, totals.steps);
      for (std::size_t kind = 0; kind < memory::record_kinds; ++kind) {
        statistics.references.hits[kind] += totals.references[kind];
      }
    }
  }

  [[nodiscard]] static memory::Address missed_address(const Cursor& cursor) { return cursor.at; }
  [[nodiscard]] std::uint32_t missed_bytes(const Cursor& /*cursor*/) const { return line_bytes_; }
  static void note_wait(const Cursor& /*cursor*/, const memory::Service& /*service*/) {}
  static void pass(Cursor& /*cursor*/) {}

 private:
  // Serves a miss that does not need the interconnect.
  bool serve(std::uint32_t node, std::uint32_t line, Cursor& cursor, NodeStatistics& statistics) {
    if (second_level_.access(node, line, cursor.time, statistics.time)) {
      return true;
    }
    if (!local_database_) {
      return false;
    }
    const memory::Service service = local_.read(line_bytes_, cursor.time);
    add_service(statistics.time, service);
    cursor.time = service.done;
    return true;
  }

  const StrippedLog& stripped_;
  Caches caches_;
  std::uint32_t line_bytes_;
  unsigned line_shift_;
  sim::Clock clock_;
  StepTicks ticks_;
  LocalMemory local_;
  bool local_database_;
  PrivateSecondLevel second_level_;
};

}  // namespace marti::processors
