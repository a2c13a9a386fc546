// What a node's misses meet before they need the interconnect: a private second level, the node's own memory,
// or an ideal interconnect, whose reads always take the same time.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "processors/walk/local_memory.h"
#include "processors/walk/replay_input.h"
#include "processors/walk/second_level.h"

namespace marti::processors::walk {

class BehindCache {
 public:
  explicit BehindCache(const ReplayInput& input)
      : local_(input.config.local),
        second_level_(input.config),
        own_read_(input.own_reads),
        reads_alone_(input.own_reads || input.config.placement == machine::Placement::replicated),
        nodes_(input.config.nodes),
        own_read_bytes_(input.own_reads ? input.config.clusters : 0) {}

  /// Whether a node serves all its misses by itself, with nothing to look up.
  [[nodiscard]] bool only_reads() const { return reads_alone_ && !second_level_.present(); }
  /// Whether what the second level does not hold is read without the interconnect.
  [[nodiscard]] bool reads_alone() const { return reads_alone_; }
  [[nodiscard]] const PrivateSecondLevel& second_level() const { return second_level_; }

  /// Looks a miss up in the node's second level, if it has one. A hit's time is added to `time` and
  /// `division`.
  bool second_level_holds(std::uint32_t node, std::uint32_t line, sim::Ticks& time,
                          cost::TimeDivision& division) {
    return second_level_.present() && second_level_.access(node, line, time, division);
  }

  /// See PrivateSecondLevel::hit.
  std::optional<sim::Ticks> second_level_hit(std::uint32_t node, std::uint32_t line) {
    return second_level_.hit(node, line);
  }

  /// A read without the interconnect, from `time` on, which is set to its end.
  memory::Service read(std::uint32_t bytes, sim::Ticks& time, cost::TimeDivision& division) {
    const memory::Service service =
        own_read_ ? memory::Service{sim::add_ticks(time, *own_read_), 0, *own_read_, 0, 0}
                  : local_.read(bytes, time);
    if (own_read_) {
      read_bytes_ += bytes;
    }
    cost::add_service(division, service);
    time = service.done;
    return service;
  }

  /// Counts the bytes that `node` has read over an ideal interconnect since the last call.
  void count_bytes(std::uint32_t node) {
    if (!own_read_bytes_.empty()) {
      own_read_bytes_[node / nodes_] += std::exchange(read_bytes_, 0);
    }
  }
  /// Bytes that the nodes of a cluster have read over an ideal interconnect without asking it.
  [[nodiscard]] std::int64_t own_read_bytes(std::uint32_t cluster) const { return own_read_bytes_[cluster]; }

 private:
  LocalMemory local_;
  PrivateSecondLevel second_level_;
  std::optional<sim::Ticks> own_read_;
  bool reads_alone_;
  std::uint32_t nodes_;
  std::vector<std::int64_t> own_read_bytes_;  // of each cluster; empty where the interconnect is asked
  std::int64_t read_bytes_ = 0;               // over the ideal interconnect, since count_bytes()
};

}  // namespace marti::processors::walk
