#include "processors/walk/packets_of_nodes.h"

namespace marti::processors::walk {

void PacketsOfNodes::begin(const ReplayInput& input) {
  log_ = &input.log;
  config_ = input.config;
  config_.placement = machine::Placement::shared;  // so that every miss stops a walk,
  config_.l2 = {};                                 // and no second level serves it
  layout_ = input.layout;
  packets_ = input.packets;
  node_rank_.assign(input.node_rank.begin(), input.node_rank.end());
  packets_of_.assign(input.config.all_nodes(), {});
}

void PacketsOfNodes::spent(std::uint32_t /*node*/, NodeState /*state*/, sim::Ticks /*from*/,
                           sim::Ticks /*to*/, PixelPlace /*pixel*/) {}

void PacketsOfNodes::began_packet(std::uint32_t node, std::uint64_t packet, sim::Ticks /*start*/) {
  packets_of_[node].push_back(packet);
}

ReplayInput PacketsOfNodes::input(bool step_by_step) const {
  return {.log = *log_,
          .config = config_,
          .layout = *layout_,
          .packets = *packets_,
          .node_rank = node_rank_,
          .step_by_step = step_by_step};
}

}  // namespace marti::processors::walk
