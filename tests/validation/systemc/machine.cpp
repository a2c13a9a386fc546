#include "tests/validation/systemc/machine.h"

#include <algorithm>
#include <string>

#include "sim/error.h"

namespace marti::oracle {

Machine::Machine(const sc_core::sc_module_name& name, const processors::program::WorkLog& log,
                 const processors::machine::MachineConfig& config)
    : sc_module(name),
      ticks_(processors::cost::step_ticks(config, log)),
      database_(config.layout, log),
      turns_("turns"),
      host_("host", turns_, config.host, cut_into_packets(log.width, log.height, config.packets),
            config.clusters * config.nodes) {
  refuse_what_is_not_modelled(config);
  for (std::uint32_t cluster = 0; cluster < config.clusters; ++cluster) {
    interconnects_.push_back(make_interconnect(turns_, config.interconnect, config.banks, config.nodes,
                                               ("interconnect_" + std::to_string(cluster)).c_str()));
    for (std::uint32_t port = 0; port < config.nodes; ++port) {
      const std::uint32_t number = cluster * config.nodes + port;
      nodes_.push_back(std::make_unique<Node>(("node_" + std::to_string(number)).c_str(), turns_, number,
                                              config, log, database_, ticks_));
      nodes_.back()->socket.bind(interconnects_.back()->sockets[port]);
      nodes_.back()->host.bind(host_);
    }
  }
}

MachineFigures Machine::figures() const {
  MachineFigures figures;
  for (const auto& node : nodes_) {
    sim::ensure(node->finished(), "a node of the SystemC model has not finished");
    figures.nodes.push_back(node->statistics());
    figures.end = std::max({figures.end, node->statistics().finish, node->last_write()});
  }
  for (processors::cost::NodeStatistics& node : figures.nodes) {
    node.time[static_cast<std::size_t>(processors::cost::Activity::idle)] = figures.end - node.finish;
  }
  for (const auto& interconnect : interconnects_) {
    ClusterFigures cluster{interconnect->statistics(), interconnect->waits().times(), {}};
    for (const Bank& bank : interconnect->banks()) {
      cluster.banks.push_back({bank.statistics(), bank.waits().times()});
    }
    figures.clusters.push_back(std::move(cluster));
  }
  figures.host = host_.statistics();
  figures.packets = host_.packets();
  return figures;
}

}  // namespace marti::oracle
