// A work log without the references whose outcome is known, for replays of machines with the same caches.
//
// What a packet finds in a cache depends on the packets that its node traced before it, but most outcomes do
// not. For a set-associative LRU cache of `ways` ways, walk one packet from an empty cache, and for a
// reference let d be the number of distinct other lines of its set that the packet has asked for since it
// last asked for this line, or, when it has not asked for it before, since the packet began.
//
//   the line was asked for before, d < ways   a hit, whatever the cache held when the packet began
//   d >= ways                                  a miss, whatever it held
//   not asked for before, d < ways             depends on what it held: the reference must be looked up
//
// Proof: LRU holds the `ways` lines of a set that were asked for last (Mattson, Gecsei, Slutz, Traiger,
// Evaluation techniques for storage hierarchies, IBM Systems Journal 9(2), 1970). In the first two cases the
// packet alone decides how many lines were asked for since. So sure hits are taken out, sure misses stay
// without a look-up, and only first references are looked up. A look-up moves its line to the front of the
// set. While only first references with d < ways have moved lines, the set holds in front the packet's d
// lines of it, in some order, and behind them the older lines in the order in which they were asked for; so
// the place of an older line is LRU's number of distinct lines since its last use, and the look-up has LRU's
// outcome. After a sure miss of a set all its first references are sure misses too, and it is not looked up
// again. When the packet ends, its last `ways` lines of each set are put in front in their order, after which
// the set is LRU's own. Which node traces the packet, and when, is not used.
//
// With other replacements only references to the line that its set was asked for last are taken out: they
// always hit and change nothing under FIFO, random replacement and tree-PLRU (Puzak, Analysis of cache
// replacement algorithms, thesis, University of Massachusetts, 1985; Wang and Baer, Efficient trace-driven
// simulation methods for cache performance analysis, SIGMETRICS 1990). All others are looked up.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "memory/record_kind.h"
#include "processors/cost/accounting.h"
#include "processors/machine/machine_config.h"
#include "processors/program/work_log.h"
#include "sim/large_pages.h"
#include "sim/work_meter.h"

namespace marti::processors::walk {

/// Steps and references of a whole packet; the pixels finished are not among the steps.
struct PacketTotals {
  cost::StepCounts steps;
  std::array<std::int64_t, memory::record_kinds> references{};
};

class StrippedLog {
 public:
  /// The properties of a machine that decide which lines it asks for, in which sets, and the cycles between:
  /// stripped logs for machines of equal keys are made in one pass. Empty for a machine that cannot use one:
  /// with another scheme than image, without caches, with a tree that is built, with contexts, prefetching,
  /// counting of more than hits and misses, or replacement that counts repeats (memory/victims.h).
  [[nodiscard]] static std::string key_of(const machine::MachineConfig& config);
  /// The ways of the LRU caches for which a log must be stripped to suit the machine; 0 where only references
  /// to the newest line may be taken out. Machines of equal keys and ways share a stripped log.
  [[nodiscard]] static std::uint32_t ways_of(const machine::MachineConfig& config);
  /// The most ways for which outcomes are worked out; with more, ways_of() is 0.
  static constexpr std::uint32_t most_ways = 16;

  /// Strips `log` for the key of `config` and for each of `ways`, in one pass on all host threads; the same
  /// at any number of them. An entry is null when a line number or a number of cycles does not fit, or when
  /// the words of all would take more than `most_bytes`, or so much more than the log that they save too
  /// little time for it; all are null for a machine without key. `meter`
  /// counts each packet, and after its stop() this throws sim::Stopped; null: nobody waits.
  [[nodiscard]] static std::vector<std::shared_ptr<const StrippedLog>> make(
      const program::WorkLog& log, const machine::MachineConfig& config, std::span<const std::uint32_t> ways,
      std::uint64_t most_bytes = std::numeric_limits<std::uint64_t>::max(), sim::WorkMeter* meter = nullptr);
  /// The stripped log for `config` alone.
  [[nodiscard]] static std::shared_ptr<const StrippedLog> make(
      const program::WorkLog& log, const machine::MachineConfig& config,
      std::uint64_t most_bytes = std::numeric_limits<std::uint64_t>::max(), sim::WorkMeter* meter = nullptr);

  // A word for each reference: the cycles since the end of the reference before, or since the beginning of
  // the pixel, in its lower half; above them the reference's record kind, whether it is a sure miss, and its
  // line. A pixel ends with the cycles to the end of its steps and end_of_pixel.
  static constexpr unsigned what_bits = 4;
  static constexpr std::uint32_t kind_mask = 7;
  static constexpr std::uint32_t sure_miss = 8;
  static constexpr std::uint32_t end_of_pixel = 15;
  static constexpr std::uint32_t what_mask = 15;
  static constexpr std::uint32_t most_lines = 1U << (32U - what_bits);

  struct StrippedPacket {
    std::span<const std::uint64_t> words;  ///< of its pixels, row by row
    /// Lines, each with some record kind of its cache, that are asked for when the packet ends, without time
    /// and uncounted.
    std::span<const std::uint32_t> at_end;
    const PacketTotals& totals;
  };
  /// The packet that pixel (x, y) belongs to.
  [[nodiscard]] StrippedPacket packet(std::uint32_t x, std::uint32_t y) const {
    const Band& band = bands_[y / packet_height_];
    const std::size_t number = x / packet_width_;
    const Place& place = band.places[number];
    const Place& next = band.places[number + 1];
    return {band.words.subspan(place.word, next.word - place.word),
            band.at_end.subspan(place.at_end, next.at_end - place.at_end),
            (*totals_)[y / packet_height_][number]};
  }

  [[nodiscard]] const std::string& key() const { return key_; }
  [[nodiscard]] std::uint32_t ways() const { return ways_; }
  /// Whether `config` describes a machine that this log was stripped for.
  [[nodiscard]] bool suits(const machine::MachineConfig& config) const {
    return key_ == key_of(config) && ways_ == ways_of(config);
  }
  /// Whether this may be the stripped form of `log`: image and tree have the same size.
  [[nodiscard]] bool fits(const program::WorkLog& log) const {
    return width_ == log.width && height_ == log.height && nodes_ == log.topology.nodes.size();
  }
  /// Number of references that are left.
  [[nodiscard]] std::uint64_t references() const;
  /// Bytes of host memory that its words take.
  [[nodiscard]] std::uint64_t bytes_of_words() const;

 private:
  struct Place {
    std::uint32_t word = 0;
    std::uint32_t at_end = 0;
  };
  // One row of packets, written by one thread.
  struct Band {
    std::span<const std::uint64_t> words;
    std::span<const std::uint32_t> at_end;
    std::vector<Place> places = std::vector<Place>(1);  // where each packet begins, and one past the last
    bool fits = true;
  };
  using Totals = std::vector<std::vector<PacketTotals>>;  // of each packet, row by row
  class BandWriter;
  template <std::uint32_t Depth, bool Split>
  class PacketCaches;
  template <class Caches>
  class Stripper;

  StrippedLog(const program::WorkLog& log, std::string key, std::uint32_t ways,
              const machine::PacketConfig& packets)
      : key_(std::move(key)),
        ways_(ways),
        width_(log.width),
        height_(log.height),
        nodes_(log.topology.nodes.size()),
        packet_width_(packets.width),
        packet_height_(packets.height) {}

  std::string key_;
  std::uint32_t ways_;
  std::uint32_t width_;
  std::uint32_t height_;
  std::size_t nodes_;
  std::uint32_t packet_width_;
  std::uint32_t packet_height_;
  std::vector<Band> bands_;
  sim::LargeBlocks<std::uint64_t> words_;   // of all bands
  sim::LargeBlocks<std::uint32_t> at_end_;  // of all bands
  std::shared_ptr<const Totals> totals_;
};

}  // namespace marti::processors::walk
