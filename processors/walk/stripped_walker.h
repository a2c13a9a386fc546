// Walks a node through a stripped log (processors/walk/stripped_log.h), in LogWalker's place.
//
// The cache of a node is empty when it begins its first packet. References of LRU caches that would be looked
// up are first ones of the packet, so all of them miss then, and the tags stay untouched. The tags get the
// lines of the first packet when the node begins its second; a node that never does takes no memory for tags.
#pragma once

#include <bit>
#include <utility>

#include "processors/cost/step_time.h"
#include "processors/walk/behind_cache.h"
#include "processors/walk/log_cursor.h"
#include "processors/walk/replay_input.h"
#include "processors/walk/stripped_log.h"
#include "sim/prefetch.h"

namespace marti::processors::walk {

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
        ticks_(cost::step_ticks(input.config, input.log)),
        behind_(input),
        pixels_written_(input.config.pixels == machine::Pixels::written),
        tags_may_be_late_(stripped_.ways() != 0 && input.sample == nullptr) {}

  [[nodiscard]] const cost::StepTicks& ticks() const { return ticks_; }
  [[nodiscard]] const BehindCache& behind() const { return behind_; }

  /// The node begins the packet at its cursor. Hits are added for the whole packet at its end: do
  /// not read the statistics' hits before.
  void begin_packet(std::uint32_t node, Cursor& cursor, cost::NodeStatistics& statistics) {
    if (cursor.tags == Tags::empty && tags_may_be_late_) {
      cursor.tags = Tags::late;
      cursor.first_x = cursor.x;
      cursor.first_y = cursor.y;
    } else if (cursor.tags != Tags::present) [[unlikely]] {
      if (cursor.tags == Tags::late) {
        warm_up(node, cursor.first_x, cursor.first_y);
      }
      cursor.tags = Tags::present;
    }
    cursor.stripped = stripped_.packet(cursor.x, cursor.y).words.data();
    // The end of the packet counts all its references as hits and subtracts all misses so far from them. With
    // the earlier misses added here, only those of this packet are subtracted.
    cost::ReferenceCounts& counts = statistics.references;
    for (std::size_t kind = 0; kind < memory::record_kinds; ++kind) {
      counts.hits[kind] += counts.misses[kind];
    }
  }

  /// A packet's words come in the order of its pixels.
  static void begin_pixel(const Cursor& /*cursor*/) {}

  /// As LogWalker::warm_up.
  void warm_up(std::uint32_t node, const machine::Packet& packet) { warm_up(node, packet.x0, packet.y0); }

  /// Continues `node` from its cursor to its next miss or the end of its pixel. Hits are counted with the
  /// packet's totals, when the packet is finished.
  template <bool RunAhead>
  Stop advance(std::uint32_t node, Cursor& cursor, cost::NodeStatistics& statistics) {
    static_assert(RunAhead);
    const Stop stop = cursor.tags == Tags::late ? walk<true>(node, cursor, statistics)
                                                : walk<false>(node, cursor, statistics);
    behind_.count_bytes(node);
    return stop;
  }

  void finish_pixel(std::uint32_t node, Cursor& cursor, cost::NodeStatistics& statistics) {
    if (pixels_written_) {
      ++statistics.steps.pixels;
      spend(cursor, ticks_.pixel, 1);
    }
    if (cursor.x + 1 != cursor.packet.x1 || cursor.y + 1 != cursor.packet.y1) {
      return;
    }
    const StrippedLog::StrippedPacket stripped = stripped_.packet(cursor.x, cursor.y);
    sim::merge(statistics.steps, stripped.totals.steps);
    cost::ReferenceCounts& counts = statistics.references;
    for (std::size_t kind = 0; kind < memory::record_kinds; ++kind) {
      counts.hits[kind] += stripped.totals.references[kind] - counts.misses[kind];
    }
    if (cursor.tags != Tags::late) {
      end_packet(caches_.view(node), stripped);
    }
  }

  /// Prefetches what advance() uses beside the first cache line of the cursor and the misses: nothing.
  static void prefetch(const Cursor& /*cursor*/, const cost::NodeStatistics& /*statistics*/) {}
  /// Prefetches the next words again: where nodes are many, these are out of the host's caches when the node
  /// has its turn.
  static void prefetch_steps(const Cursor& cursor) { sim::prefetch_line(cursor.stripped); }

  [[nodiscard]] static memory::Address missed_address(const Cursor& cursor) { return cursor.at; }
  [[nodiscard]] std::uint32_t missed_bytes(const Cursor& /*cursor*/) const { return line_bytes_; }
  static void note_wait(const Cursor& /*cursor*/, const memory::Service& /*service*/) {}
  static void pass(Cursor& /*cursor*/) {}

 private:
  using View = typename Caches::View;

  static memory::RecordKind kind_of(std::uint32_t what) {
    return static_cast<memory::RecordKind>(what & StrippedLog::kind_mask);
  }

  [[gnu::always_inline]] static bool look_up(const View& cache, std::uint32_t what) {
    return cache.access(kind_of(what), what >> StrippedLog::what_bits);
  }

  // Takes the node's cache through the packet at (x, y).
  void warm_up(std::uint32_t node, std::uint32_t x, std::uint32_t y) {
    const StrippedLog::StrippedPacket stripped = stripped_.packet(x, y);
    const View cache = caches_.view(node);
    for (const std::uint64_t word : stripped.words) {
      if (const auto what = static_cast<std::uint32_t>(word >> 32U); (what & StrippedLog::sure_miss) == 0) {
        (void)look_up(cache, what);
      }
    }
    end_packet(cache, stripped);
  }

  static void end_packet(const View& cache, const StrippedLog::StrippedPacket& packet) {
    for (const std::uint32_t what : packet.at_end) {
      (void)look_up(cache, what);
    }
  }

  // `Empty`: no reference is looked up, because the cache held nothing when the packet began.
  template <bool Empty>
  Stop walk(std::uint32_t node, Cursor& cursor, cost::NodeStatistics& statistics) {
    const View cache = caches_.view(node);
    const std::uint64_t* word = cursor.stripped;
    sim::Ticks time = cursor.time;
    for (;;) {
      time = sim::add_ticks(time, clock_.cycles(static_cast<std::uint32_t>(*word)));
      const auto what = static_cast<std::uint32_t>(*word >> 32U);
      ++word;
      if ((what & StrippedLog::sure_miss) == 0) {
        if (!Empty && look_up(cache, what)) [[likely]] {
          time = sim::add_ticks(time, ticks_.hit);
          continue;
        }
      } else if ((what & StrippedLog::what_mask) == StrippedLog::end_of_pixel) {
        cursor.stripped = word;
        cursor.time = time;
        return Stop::end;
      }
      const memory::RecordKind kind = kind_of(what);
      const std::uint32_t line = what >> StrippedLog::what_bits;
      ++cost::misses_of(statistics, kind);
      if (behind_.second_level_holds(node, line, time, statistics.time)) {
        continue;
      }
      if (!behind_.reads_alone()) {
        cursor.stripped = word;
        cursor.time = time;
        cursor.at = memory::Address{line} << line_shift_;
        // Many nodes take turns, too many for the host to see how each goes on in its words.
        sim::prefetch_line(word + 8);
        return Stop::miss;
      }
      (void)behind_.read(line_bytes_, time, statistics.time);
    }
  }

  const StrippedLog& stripped_;
  Caches caches_;
  std::uint32_t line_bytes_;
  unsigned line_shift_;
  sim::Clock clock_;
  cost::StepTicks ticks_;
  BehindCache behind_;
  bool pixels_written_;
  bool tags_may_be_late_;
};

}  // namespace marti::processors::walk
