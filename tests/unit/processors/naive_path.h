// A second way to find the critical path of a plain machine: one held bus whose banks take no time, one
// context, packets of one pixel that are given out beforehand, write buffers without end. All reads and
// writes are listed from what an observer is told, the bus serves the list, and the path is sought back from
// the end.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <tuple>
#include <vector>

#include "processors/machine/machine_config.h"
#include "processors/walk/observer.h"
#include "sim/error.h"
#include "tests/support/naive_flow_path.h"
#include "tests/support/random_machine.h"

namespace marti::test {

/// Makes a random machine one of the plain ones.
inline void make_plain(Random& random, processors::machine::MachineConfig& machine) {
  machine.clusters = 1;
  machine.placement = processors::machine::Placement::shared;
  machine.l2.sharing = processors::machine::SecondLevel::none;
  machine.interconnect.kind = memory::InterconnectKind::bus;
  machine.interconnect.mode = memory::BusMode::held;
  machine.interconnect.arbitration = memory::Arbitration::fifo;
  machine.interconnect.cycles_per_beat = pick(random, 1, 3);
  machine.banks.access_cycles = 0;
  machine.banks.busy_cycles = 0;
  machine.write_buffer = 200;
  machine.packets.width = 1;
  machine.packets.height = 1;
  machine.operations = {1, 1, 1, 1, 1, 1, 1, 1};  // no pixel is traced in no time
  machine.host.assignment = random() % 2 == 0 ? processors::machine::Assignment::interleaved
                                              : processors::machine::Assignment::blocks;
}

class NaivePath final : public processors::walk::Observer {
 public:
  NaivePath(processors::walk::Observer& next, const processors::machine::MachineConfig& machine)
      : next_(next), machine_(machine), began_(machine.nodes) {}

  void begin(const processors::walk::ReplayInput& input) override { next_.begin(input); }
  void spent(std::uint32_t node, processors::walk::NodeState state, sim::Ticks from, sim::Ticks to,
             processors::walk::PixelPlace pixel) override {
    next_.spent(node, state, from, to, pixel);
    spans_.push_back({node, from, to, state});
  }
  void began_packet(std::uint32_t node, std::uint64_t /*packet*/, sim::Ticks start) override {
    began_[node].push_back(start);
  }
  void end(sim::Ticks time) override { next_.end(time); }

  /// The path, the last piece first.
  [[nodiscard]] std::vector<NaivePiece> path(sim::Ticks end) const {
    const std::vector<Tenure> tenures = serve();
    std::vector<NaivePiece> path;
    std::optional<Tenure> tenure;
    std::uint32_t node = 0;
    while (node < began_.size() && finish_of(node) != end) {
      ++node;
    }
    if (node == began_.size()) {
      tenure = *std::find_if(tenures.begin(), tenures.end(), [&](const Tenure& t) { return t.end == end; });
    }
    for (sim::Ticks at = end; at != 0;) {
      if (tenure) {
        node = tenure->node;
        at = tenure->start;
        add_piece(path, {at, tenure->end, node, processors::path::PathKind::transfer});
        tenure = at == tenure->ask ? std::nullopt : ending(tenures, at, std::nullopt);
      } else if (const Span* const work = work_ending(node, at)) {
        add_piece(path, {work->from, at, node});
        at = work->from;
      } else {
        tenure = ending(tenures, at, node);
      }
    }
    return path;
  }

 private:
  struct Span {
    std::uint32_t node;
    sim::Ticks from, to;
    processors::walk::NodeState state;
  };
  struct Tenure {
    sim::Ticks ask = 0;
    bool write = false;
    std::uint32_t node = 0;
    sim::Ticks length = 0;
    sim::Ticks start = 0;
    sim::Ticks end = 0;
  };

  [[nodiscard]] sim::Ticks finish_of(std::uint32_t node) const {
    sim::Ticks finish = 0;
    for (const Span& span : spans_) {
      if (span.node == node && span.state != processors::walk::NodeState::idle) {
        finish = std::max(finish, span.to);
      }
    }
    return finish;
  }
  [[nodiscard]] const Span* work_ending(std::uint32_t node, sim::Ticks at) const {
    for (const Span& span : spans_) {
      if (span.node == node && span.to == at && span.state == processors::walk::NodeState::working) {
        return &span;
      }
    }
    return nullptr;
  }
  // The tenure that ends at that time; `node`: the read of this node that does.
  static std::optional<Tenure> ending(const std::vector<Tenure>& tenures, sim::Ticks at,
                                      std::optional<std::uint32_t> node) {
    for (const Tenure& tenure : tenures) {
      if (tenure.end == at && (!node || (tenure.node == *node && !tenure.write))) {
        return tenure;
      }
    }
    throw sim::InternalError("no tenure ends then");
  }

  // All tenures of the bus in order. A pixel is written when the node's next packet begins, or at its end.
  [[nodiscard]] std::vector<Tenure> serve() const {
    std::vector<Tenure> tenures;
    for (std::size_t i = 0; i < spans_.size(); ++i) {
      const Span& span = spans_[i];
      if (span.state == processors::walk::NodeState::transfer) {
        const bool waited = i > 0 && spans_[i - 1].node == span.node && spans_[i - 1].to == span.from &&
                            spans_[i - 1].state == processors::walk::NodeState::interconnect_wait;
        tenures.push_back({waited ? spans_[i - 1].from : span.from, false, span.node, span.to - span.from});
      }
    }
    const memory::InterconnectConfig& bus = machine_.interconnect;
    const std::int64_t beats = (std::int64_t{machine_.layout.pixel_bytes} + bus.width - 1) / bus.width;
    const sim::Ticks write = bus.clock.cycles(bus.address_cycles + beats * bus.cycles_per_beat);
    for (std::uint32_t node = 0; node < began_.size(); ++node) {
      for (std::size_t i = 0; i < began_[node].size(); ++i) {
        const bool last = i + 1 == began_[node].size();
        tenures.push_back({last ? finish_of(node) : began_[node][i + 1], true, node, write});
      }
    }
    std::sort(tenures.begin(), tenures.end(), [](const Tenure& a, const Tenure& b) {
      return std::tie(a.ask, a.write, a.node) < std::tie(b.ask, b.write, b.node);
    });
    sim::Ticks free = 0;
    for (Tenure& tenure : tenures) {
      tenure.start = std::max(tenure.ask, free);
      tenure.end = free = tenure.start + tenure.length;
    }
    return tenures;
  }

  processors::walk::Observer& next_;
  const processors::machine::MachineConfig& machine_;
  std::vector<std::vector<sim::Ticks>> began_;  // of each node: when its packets began
  std::vector<Span> spans_;
};

}  // namespace marti::test
