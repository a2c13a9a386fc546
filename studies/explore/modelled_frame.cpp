#include "studies/explore/modelled_frame.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "processors/machine/packets.h"
#include "processors/node/packet_schedule.h"
#include "processors/replay/bounds.h"
#include "processors/replay/replay.h"
#include "processors/theory/closed_network.h"
#include "sim/mapped.h"
#include "sim/mix.h"
#include "studies/estimate/within.h"

namespace marti::studies::explore {

namespace {

using processors::machine::MachineConfig;
using processors::machine::PacketList;
using processors::program::WorkLog;

constexpr std::uint64_t most_timed = 96;  // packets
// Packets that a node takes through its cache before each, without time: enough for the small caches of the
// machines that take long to be timed.
constexpr std::uint64_t warm_up = 1;

std::vector<double> words_of(const WorkLog& log, const PacketList& packets) {
  std::vector<double> words(packets.size());
  for (std::uint64_t i = 0; i < packets.size(); ++i) {
    const processors::machine::Packet packet = packets[i];
    for (std::uint32_t y = packet.y0; y < packet.y1; ++y) {
      for (std::uint32_t x = packet.x0; x < packet.x1; ++x) {
        words[i] += static_cast<double>(log.pixel(x, y).size());
      }
    }
  }
  return words;
}

// One packet, by chance, of each of equal parts of the frame.
std::vector<std::uint64_t> spread(std::uint64_t packets) {
  const std::uint64_t parts = std::min(packets, most_timed);
  std::vector<std::uint64_t> chosen;
  for (std::uint64_t part = 0; part < parts; ++part) {
    const std::uint64_t first = part * packets / parts;
    const std::uint64_t end = (part + 1) * packets / parts;
    chosen.push_back(first + sim::mix(part) % (end - first));
  }
  return chosen;
}

// When the last of all packets is done where no node waits for another. All take `work` together, each by its
// words.
double handed_out(const MachineConfig& machine, const std::vector<double>& words, double work) {
  const double all = std::accumulate(words.begin(), words.end(), 0.0);
  const std::vector<sim::Ticks> times =
      sim::mapped(words, [&](const double each) { return sim::Ticks{std::llround(work * each / all)}; });
  // More nodes than packets would have nothing to do.
  const auto nodes = static_cast<std::uint32_t>(std::min<std::size_t>(machine.nodes, words.size()));
  return static_cast<double>(processors::node::schedule_packets(machine.host, nodes, times));
}

}  // namespace

std::optional<ModelledFrame> modelled_frame(const WorkLog& log, const MachineConfig& machine,
                                            sim::WorkMeter* meter) {
  const MachineConfig one = processors::machine::one_node_of(machine);
  if (estimate::not_sampled(machine)) {
    return std::nullopt;
  }
  const PacketList packets(log.width, log.height, machine.packets);
  const std::vector<double> words = words_of(log, packets);
  const std::vector<std::uint64_t> chosen = spread(packets.size());
  const processors::walk::PacketSample sample(chosen, packets.size(), warm_up);
  processors::replay::ReplayOptions options;
  options.sample = &sample;
  options.meter = meter;
  MachineConfig plain = one;
  plain.energy = {};
  const processors::replay::MachineResult timed = processors::replay::replay(log, plain, options);
  double timed_words = 0.0;
  for (const std::uint64_t packet : chosen) {
    timed_words += words[packet];
  }
  const double all_words = std::accumulate(words.begin(), words.end(), 0.0);
  if (timed_words <= 0.0) {
    return std::nullopt;
  }
  const double times = all_words / timed_words;
  ModelledFrame frame;
  frame.packets = chosen.size();
  frame.of_packets = packets.size();
  frame.end_of_one = times * static_cast<double>(timed.end);
  frame.end = frame.end_of_one;
  if (machine.nodes == 1) {
    return frame;
  }
  const double at_work = std::min<double>(machine.nodes, static_cast<double>(packets.size()));
  const double alone = handed_out(machine, words, frame.end_of_one);
  frame.end = alone;
  if (std::optional<processors::replay::Prediction> queues = processors::replay::predict(plain, timed)) {
    // The same reads, thinking and service as with one node, but with all nodes.
    queues->network.customers = static_cast<std::uint64_t>(at_work);
    const double even = times * static_cast<double>(queues->reads) /
                        processors::theory::mean_values(queues->network).throughput;
    frame.end = even + std::max(0.0, alone - frame.end_of_one / at_work);  // and the last packets
  }
  return frame;
}

}  // namespace marti::studies::explore
