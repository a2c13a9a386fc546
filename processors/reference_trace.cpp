#include "processors/reference_trace.h"

#include <span>

#include "processors/log_walker.h"

namespace marti::processors {

namespace {

// A cache in which nothing is ever found: the walk stops at every reference.
struct EmptyCaches : NoCaches {
  static constexpr bool present = true;
};

template <class Caches>
void walk_packets(const ReplayInput& input, const std::vector<std::uint64_t>& packets,
                  const std::function<void(const Reference&)>& take) {
  LogWalker<Caches> walker(input, Caches{});
  NodeStatistics statistics;
  for (const std::uint64_t number : packets) {
    const Packet packet = input.packets[number];
    for (std::uint32_t y = packet.y0; y < packet.y1; ++y) {
      for (std::uint32_t x = packet.x0; x < packet.x1; ++x) {
        const std::span<const std::uint32_t> words = input.log.pixel(x, y);
        Cursor cursor;
        cursor.word = words.data();
        cursor.word_end = words.data() + words.size();
        while (walker.template advance<true>(0, cursor, statistics) == Stop::miss) {
          take({cursor.kind, cursor.at, false});
          walker.pass(cursor);
        }
        const std::uint64_t pixel = std::uint64_t{y} * input.log.width + x;
        take({memory::RecordKind::pixel, input.layout.address(memory::RecordKind::pixel, pixel), true});
      }
    }
  }
}

}  // namespace

void ReferenceTrace::begin(const ReplayInput& input) {
  log_ = &input.log;
  config_ = input.config;
  config_.placement = Placement::shared;  // every reference is to stop the walk,
  config_.l2 = {};                        // and none is to be served by a second level
  layout_ = input.layout;
  packets_ = input.packets;
  node_rank_.assign(input.node_rank.begin(), input.node_rank.end());
  packets_of_.assign(input.config.all_nodes(), {});
}

void ReferenceTrace::spent(std::uint32_t /*node*/, NodeState /*state*/, sim::Ticks /*from*/,
                           sim::Ticks /*to*/, PixelPlace /*pixel*/) {}

void ReferenceTrace::began_packet(std::uint32_t node, std::uint64_t packet, sim::Ticks /*start*/) {
  packets_of_[node].push_back(packet);
}

void ReferenceTrace::for_each(std::uint32_t node, const std::function<void(const Reference&)>& take) const {
  const ReplayInput input = {.log = *log_,
                             .config = config_,
                             .layout = *layout_,
                             .packets = *packets_,
                             .node_rank = node_rank_,
                             .step_by_step = true};
  if (config_.cache.organisation == CacheOrganisation::none) {
    walk_packets<NoCaches>(input, packets_of_[node], take);
  } else {
    walk_packets<EmptyCaches>(input, packets_of_[node], take);
  }
}

}  // namespace marti::processors
