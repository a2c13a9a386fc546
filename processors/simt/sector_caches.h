// The first-level caches of all SIMT nodes: tags of lines and, where lines have sectors, a bit for each.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "processors/machine/machine_config.h"
#include "processors/walk/node_caches.h"
#include "processors/walk/record_places.h"
#include "processors/walk/replay_input.h"

namespace marti::processors::simt {

/// Units are sectors, or lines where those have none: addresses divided by MachineConfig::reference_bytes().
class SectorCaches {
 public:
  explicit SectorCaches(const walk::ReplayInput& input)
      : tags_(input.config),
        shift_(static_cast<unsigned>(std::countr_zero(input.config.cache.cache.line) -
                                     std::countr_zero(input.config.reference_bytes()))),
        lines_((walk::memory_lines(input.config, input.layout, nullptr) >> shift_) + 1),
        sectors_(shift_ == 0 ? 0 : input.config.all_nodes()) {}

  /// The number of a unit among those of all of a node's caches.
  [[nodiscard]] std::uint64_t key(std::uint32_t node, memory::RecordKind kind, std::uint32_t unit) {
    return std::uint64_t{tags_.view(node).cache_of(kind)} << 32U | unit;
  }

  /// Looks a unit up, which makes its line the most recent one or brings it in. Whether it was there.
  bool access(std::uint32_t node, memory::RecordKind kind, std::uint32_t unit) {
    const bool there = tags_.view(node).access(kind, unit >> shift_);
    if (shift_ == 0) {
      return there;
    }
    std::uint8_t& bits = bits_of(node, kind, unit);
    const std::uint8_t before = there ? bits : 0;
    bits = before | bit(unit);
    return (before & bit(unit)) != 0;
  }

  /// Whether access() would find the unit.
  [[nodiscard]] bool holds(std::uint32_t node, memory::RecordKind kind, std::uint32_t unit) {
    return tags_.view(node).holds(kind, unit >> shift_) &&
           (shift_ == 0 || (bits_of(node, kind, unit) & bit(unit)) != 0);
  }

 private:
  [[nodiscard]] std::uint8_t bit(std::uint32_t unit) const {
    return static_cast<std::uint8_t>(1U << (unit & ((1U << shift_) - 1U)));
  }
  [[nodiscard]] std::uint8_t& bits_of(std::uint32_t node, memory::RecordKind kind, std::uint32_t unit) {
    std::vector<std::uint8_t>& bits = sectors_[node];
    const std::size_t place = tags_.view(node).cache_of(kind) * lines_ + (unit >> shift_);
    if (place >= bits.size()) {
      bits.resize(place + place / 2 + 1);
    }
    return bits[place];
  }

  walk::AnyCaches tags_;
  unsigned shift_;                                  // from units to lines
  std::uint64_t lines_;                             // of memory
  std::vector<std::vector<std::uint8_t>> sectors_;  // of each node: the sectors of each line of each cache
};

}  // namespace marti::processors::simt
