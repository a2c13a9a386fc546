// A work log without the references that are sure to hit, for many replays with the same caches.
//
// A reference to the line that its set was asked for last always hits, whatever the rest of the set holds,
// and changes nothing there under LRU, FIFO, random replacement and tree-PLRU: the line is still there, and
// it is already the newest. Such references are found with a direct-mapped filter of as many sets as the
// cache has (Puzak, "Analysis of cache replacement algorithms", thesis, University of Massachusetts, 1985;
// Wang and Baer, "Efficient trace-driven simulation methods for cache performance analysis", SIGMETRICS
// 1990). Here the filter is emptied before each packet, so that every reference taken out is a hit at
// whichever node and at whatever time the packet is traced. What is left are references with the cycles
// between them; machines that differ in nodes, ways, replacement, clocks, memory or interconnect share them.
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

namespace marti::processors {

/// Steps and references of a whole packet; the pixels finished are not among the steps.
struct PacketTotals {
  StepCounts steps;
  std::array<std::int64_t, memory::record_kinds> references{};
};

class StrippedLog {
 public:
  /// The properties of a machine that decide what is taken out: machines of equal keys share a stripped log.
  /// Empty for a machine that cannot use one: with another scheme than image, without caches, with a tree
  /// that is built, with contexts, prefetching, or counting of more than hits and misses.
  [[nodiscard]] static std::string key_of(const MachineConfig& config);

  /// Strips `log` on all host threads; the same at any number of them. Null when a line number or a number of
  /// cycles does not fit, when the words would take more than `most_bytes`, or for a machine without key.
  [[nodiscard]] static std::unique_ptr<const StrippedLog> make(
      const WorkLog& log, const MachineConfig& config,
      std::uint64_t most_bytes = std::numeric_limits<std::uint64_t>::max());

  // Two words for each reference: the cycles since the end of the reference before, or since the beginning of
  // the pixel; then its line and its record kind. A pixel ends with the cycles to the end of its steps and
  // end_of_pixel.
  static constexpr unsigned kind_bits = 3;
  static constexpr std::uint32_t most_lines = 1U << (32U - kind_bits);
  static constexpr std::uint32_t end_of_pixel = (1U << kind_bits) - 1U;

  /// The words of a pixel, followed by words of later pixels.
  [[nodiscard]] std::span<const std::uint32_t> pixel(std::uint32_t x, std::uint32_t y) const {
    const Band& band = bands_[y / packet_height_];
    return std::span(band.words).subspan(band.begin[std::size_t{y % packet_height_} * width_ + x]);
  }
  /// The totals of the packet that pixel (x, y) belongs to.
  [[nodiscard]] const PacketTotals& totals(std::uint32_t x, std::uint32_t y) const {
    return bands_[y / packet_height_].totals[x / packet_width_];
  }
  [[nodiscard]] const std::string& key() const { return key_; }
  /// Whether this may be the stripped form of `log`: image and tree have the same size.
  [[nodiscard]] bool fits(const WorkLog& log) const {
    return width_ == log.width && height_ == log.height && nodes_ == log.topology.nodes.size();
  }
  /// Number of references that are left.
  [[nodiscard]] std::uint64_t references() const;
  /// Bytes of host memory that its words take.
  [[nodiscard]] std::uint64_t bytes_of_words() const;

 private:
  // One row of packets.
  struct Band {
    std::vector<std::uint32_t> words;
    std::vector<std::uint32_t> begin;  // of each pixel, row by row
    std::vector<PacketTotals> totals;  // of each packet, from left to right
    bool fits = true;
  };
  class Stripper;

  StrippedLog(const WorkLog& log, std::string key, const PacketConfig& packets)
      : key_(std::move(key)),
        width_(log.width),
        height_(log.height),
        nodes_(log.topology.nodes.size()),
        packet_width_(packets.width),
        packet_height_(packets.height) {}

  std::string key_;
  std::uint32_t width_;
  std::uint32_t height_;
  std::size_t nodes_;
  std::uint32_t packet_width_;
  std::uint32_t packet_height_;
  std::vector<Band> bands_;
};

}  // namespace marti::processors
