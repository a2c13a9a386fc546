// Replaying only some of a frame's packets: which ones, how caches are warmed, and what each packet took.
//
// What a node's caches hold when it begins a packet comes from the packets before it. Where those are left
// out the caches are colder than in the whole frame, and misses are overestimated; so a node may first walk
// the packets left out through its tags, without time and without traffic ("functional warming": Wunderlich,
// Wenisch, Falsafi, Hoe, "SMARTS: accelerating microarchitecture simulation via rigorous statistical
// sampling", ISCA 2003, section 4).
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "processors/cost/accounting.h"
#include "sim/mix.h"
#include "sim/time.h"

namespace marti::processors::walk {

/// The packets that are replayed, by their numbers in the order in which the host hands packets out.
class PacketSample {
 public:
  static constexpr std::uint64_t all_before = std::numeric_limits<std::uint64_t>::max();

  /// `chosen` must be below `packets`, ascending, each once, and at least one; throws InternalError else. A
  /// node warms its caches with at most the last `warm_up` packets left out since its previous one.
  PacketSample(std::vector<std::uint64_t> chosen, std::uint64_t packets, std::uint64_t warm_up);

  [[nodiscard]] std::span<const std::uint64_t> chosen() const { return chosen_; }

  /// Calls use(packet), in ascending order, for each packet that a node warms its caches with before packet
  /// `next`: had every packet been handed out, the node would have had one in every round of `nodes` packets.
  /// Which packet of a round it would have had depends on when the nodes fall idle, so a pseudo-random one is
  /// taken. (Every `nodes`-th packet would lie in few columns of the image, and caches would hit too often.)
  /// `last` is the number of the node's previous packet plus one, or 0 when there is none.
  template <class Use>
  void for_each_warmed(std::uint64_t last, std::uint64_t next, std::uint64_t nodes, const Use& use) const {
    for (std::uint64_t back = std::min((next - last) / nodes, warm_up_); back > 0; --back) {
      const std::uint64_t later = next - back * nodes + sim::mix(next ^ sim::mix(back)) % nodes;
      const std::uint64_t packet = std::clamp(later - std::min(later, nodes / 2), last, next - 1);
      if (!is_chosen_[packet]) {
        use(packet);
      }
    }
  }

 private:
  std::vector<std::uint64_t> chosen_;
  std::vector<bool> is_chosen_;
  std::uint64_t warm_up_;
};

/// What a packet took at its node, from its start to the node's next request to the host.
struct PacketFigures {
  sim::Ticks time = 0;
  sim::Ticks busy = 0;  ///< of it, not waiting for anything
  std::int64_t references = 0;
  std::int64_t misses = 0;
  friend bool operator==(const PacketFigures&, const PacketFigures&) = default;
};

/// Measures the figures of each packet.
class PacketMeter {
 public:
  /// With `packets` 0 it measures nothing.
  PacketMeter(std::uint64_t packets, std::size_t nodes)
      : figures_(packets), open_(packets == 0 ? 0 : nodes) {}

  [[nodiscard]] bool on() const { return !figures_.empty(); }
  void begin(std::uint32_t node, std::uint64_t packet, sim::Ticks start,
             const cost::NodeStatistics& statistics) {
    open_[node] = {true,
                   packet,
                   {start, start - cost::sum_of(statistics.time), statistics.references.references(),
                    statistics.references.all_misses()}};
  }
  /// The node asks for its next packet, which ends the one it has, if any. During a replay `statistics` have
  /// the time of waits only.
  void end(std::uint32_t node, sim::Ticks now, const cost::NodeStatistics& statistics) {
    const Open& open = open_[node];
    if (open.any) {
      figures_[open.packet] = {now - open.before.time, now - cost::sum_of(statistics.time) - open.before.busy,
                               statistics.references.references() - open.before.references,
                               statistics.references.all_misses() - open.before.misses};
    }
  }
  [[nodiscard]] const std::vector<PacketFigures>& figures() const { return figures_; }

 private:
  struct Open {
    bool any = false;
    std::uint64_t packet = 0;
    PacketFigures before;  // its time is the packet's start
  };
  std::vector<PacketFigures> figures_;
  std::vector<Open> open_;
};

}  // namespace marti::processors::walk
