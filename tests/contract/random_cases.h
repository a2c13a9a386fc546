// A random machine of each kind that a replay times, with a log that it can time, and an observer that adds
// up what it is told.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "processors/replay/replay.h"
#include "processors/walk/observer.h"
#include "tests/support/random_flow.h"

namespace marti::test {

struct TimedCase {
  processors::program::WorkLog log;
  processors::machine::MachineConfig machine;
  processors::replay::ReplayOptions options;
};

inline TimedCase image_case(Random& random) {
  TimedCase made{any_log(random), random_machine(random), {}};
  add_random_second_level(random, made.machine);
  add_random_dram(random, made.machine);
  return made;
}

/// Nodes that can hold several contexts, now and then with one.
inline TimedCase contexts_case(Random& random) {
  TimedCase made{any_log(random), random_machine(random, 8), {}};
  add_random_contexts(random, made.log.traversal < accel::Traversal::grid, made.machine);
  add_random_dram(random, made.machine);
  made.options.with_contexts = true;
  return made;
}

/// More contexts than there are packets: those that never get one are left out of a replay, but for one step
/// by step.
inline TimedCase idle_contexts_case(Random& random) {
  TimedCase made = contexts_case(random);
  made.machine.contexts = static_cast<std::uint32_t>(pick(random, 2, 100));
  return made;
}

/// The tree is built on the machine, by any of the ways and from any state of the tree.
inline TimedCase building_case(Random& random) {
  TimedCase made{random_log_with_tree(random), random_machine(random), {}};
  add_random_build(random, made.machine);
  if (random() % 3 == 0) {
    made.options.starts = random_starts(random, made.log.topology,
                                        made.machine.build.sharing != processors::machine::Sharing::none);
  }
  add_random_dram(random, made.machine);
  return made;
}

/// Nodes that build the tree and have several contexts, prefetch, or both.
inline TimedCase building_contexts_case(Random& random) {
  TimedCase made = building_case(random);
  add_random_contexts(random, made.log.traversal < accel::Traversal::grid, made.machine);
  made.machine.banks.dram.reset();
  add_random_dram(random, made.machine);
  made.options.with_contexts = true;
  return made;
}

inline TimedCase pipeline_case(Random& random) {
  TimedCase made{any_log(random), random_machine(random), {}};
  make_random_pipeline(random, made.machine);
  add_random_second_level(random, made.machine);
  add_random_dram(random, made.machine);
  return made;
}

inline TimedCase space_case(Random& random) {
  TimedCase made{any_log(random, false), random_machine(random), {}};
  make_random_space(random, made.machine);
  add_random_second_level(random, made.machine);
  if (made.machine.l2.sharing == processors::machine::SecondLevel::shared) {
    made.machine.l2.sharing = processors::machine::SecondLevel::none;  // there is no shared memory behind it
  }
  return made;
}

/// Adds up all that it observes, and counts contradictions to the interface.
class Watcher final : public processors::walk::Observer {
 public:
  using NodeState = processors::walk::NodeState;
  using PixelPlace = processors::walk::PixelPlace;

  void begin(const processors::walk::ReplayInput& input) override {
    until.resize(input.config.all_nodes());
    states.resize(input.config.all_nodes());
    misses.resize(input.config.all_nodes());
    packet_of_.resize(input.config.all_nodes());
    given_tree_ = input.config.build.sharing == processors::machine::Sharing::given;
    begun.resize(input.packets.size());
    packets_ = &input.packets;
    asked_of.resize(input.config.clusters);
    nodes_of_cluster_ = input.config.nodes;
    width_ = input.log.width;
    height_ = input.log.height;
  }
  void spent(std::uint32_t node, NodeState state, sim::Ticks from, sim::Ticks to, PixelPlace pixel) override {
    faults += from != until[node] || to < from ? 1 : 0;
    until[node] = to;
    states[node][static_cast<std::size_t>(state)] += to - from;
    if (!pixel.none()) {
      faults += pixel.x >= width_ || pixel.y >= height_ ? 1 : 0;
      faults += state == NodeState::idle || state == NodeState::dispatch_wait ? 1 : 0;
      pixel_time[{pixel.x, pixel.y}] += to - from;
    }
    // Only where the tree is given: what a node waits for while it builds may be another packet's.
    if (given_tree_ && !pixel.none() && state != NodeState::working && packet_of_[node]) {
      const processors::machine::Packet packet = (*packets_)[*packet_of_[node]];
      faults += pixel.x < packet.x0 || pixel.x >= packet.x1 || pixel.y < packet.y0 || pixel.y >= packet.y1;
    }
  }
  void missed(std::uint32_t node, std::int64_t count, PixelPlace pixel) override {
    misses[node] += count;
    pixel_misses += pixel.none() ? 0 : count;
  }
  void began_packet(std::uint32_t node, std::uint64_t packet, sim::Ticks start) override {
    faults += start != until[node] ? 1 : 0;
    ++begun[packet];
    packet_of_[node] = packet;
  }
  void resumed_packet(std::uint32_t node, std::uint64_t packet) override { packet_of_[node] = packet; }
  [[nodiscard]] bool hears_requests() const override { return true; }
  void requested(const processors::walk::Request& request) override {
    faults += request.time < asked_until_ ? 1 : 0;
    asked_until_ = request.time;
    memory::InterconnectStatistics& asked = asked_of[request.node / nodes_of_cluster_];
    ++(request.write ? asked.writes : asked.reads);
    asked.bytes += request.bytes;
  }
  void end(sim::Ticks time) override { ended = time; }

  std::vector<sim::Ticks> until;
  std::vector<std::array<sim::Ticks, processors::walk::node_states>> states;
  std::vector<std::int64_t> misses;
  std::vector<int> begun;  // how often each packet
  std::map<std::pair<std::uint32_t, std::uint32_t>, sim::Ticks> pixel_time;
  std::int64_t pixel_misses = 0;
  std::vector<memory::InterconnectStatistics> asked_of;  // of each cluster's memory
  sim::Ticks ended = -1;
  int faults = 0;

 private:
  std::vector<std::optional<std::uint64_t>> packet_of_;  // that each node is at work on
  bool given_tree_ = true;
  std::uint32_t nodes_of_cluster_ = 1;
  sim::Ticks asked_until_ = 0;
  const processors::machine::PacketList* packets_ = nullptr;
  std::uint32_t width_ = 0;
  std::uint32_t height_ = 0;
};

}  // namespace marti::test
