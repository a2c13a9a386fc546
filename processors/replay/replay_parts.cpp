#include "processors/replay/replay_parts.h"

#include <algorithm>
#include <numeric>

#include "memory/passed_on.h"
#include "processors/node/memory_system.h"
#include "processors/path/watched_memory.h"
#include "processors/walk/observer.h"
#include "sim/mix.h"

namespace marti::processors::replay {

namespace {

// A cluster's memory system with someone who hears what it is asked for.
class HeardMemory final : public memory::PassedOn {
 public:
  HeardMemory(const machine::MachineConfig& config, const memory::InterconnectSite& site,
              walk::Observer& observer)
      : PassedOn(node::make_memory_system(config, site)),
        site_(site),
        ports_of_node_(config.ports_of_node()),
        observer_(observer) {}

  void read(const memory::Transaction& transaction) override {
    tell(transaction, false);
    PassedOn::read(transaction);
  }
  void write(const memory::Transaction& transaction) override {
    tell(transaction, true);
    PassedOn::write(transaction);
  }

 private:
  void tell(const memory::Transaction& transaction, bool write) {
    observer_.requested({site_.engine.now(), (site_.first_component + transaction.port) / ports_of_node_,
                         transaction.address, transaction.bytes, write});
  }

  memory::InterconnectSite site_;
  std::uint32_t ports_of_node_;
  walk::Observer& observer_;
};

}  // namespace

machine::PacketList packets_of(const program::WorkLog& log, const machine::MachineConfig& config,
                               std::uint64_t packet_seed) {
  machine::PacketList packets(log.width, log.height, config.packets);
  if (packet_seed == 0) {
    return packets;
  }
  constexpr std::uint64_t in_a_row = 16;
  std::vector<std::uint64_t> order(packets.size());
  std::iota(order.begin(), order.end(), std::uint64_t{0});
  const auto drawn = [packet_seed](std::uint64_t packet) { return sim::mix(sim::mix(packet_seed) + packet); };
  for (std::uint64_t first = 0; first < order.size(); first += in_a_row) {
    const auto begin = order.begin() + static_cast<std::ptrdiff_t>(first);
    const auto end = order.begin() + static_cast<std::ptrdiff_t>(std::min(order.size(), first + in_a_row));
    std::sort(begin, end, [&](std::uint64_t a, std::uint64_t b) { return drawn(a) < drawn(b); });
  }
  return packets.only(order);
}

Interconnects connect_memory(const machine::MachineConfig& config, sim::Engine& engine,
                             std::uint8_t memory_class, node::NodeArray& nodes, path::PathRecorder* path,
                             walk::Observer* observer) {
  Interconnects interconnects;
  std::vector<memory::Interconnect*> links;
  const std::uint32_t ports = config.nodes * config.ports_of_node();
  for (std::uint32_t cluster = 0; cluster < config.clusters; ++cluster) {
    const memory::InterconnectSite site = {engine,
                                           nodes.client(cluster),
                                           static_cast<std::uint8_t>(node::EventClass::reply),
                                           cluster * ports,
                                           ports,
                                           memory_class,
                                           config.kind == machine::NodeKind::simt};
    if (path != nullptr) {
      interconnects.push_back(std::make_unique<path::WatchedMemory>(config, site, *path));
    } else if (observer != nullptr && observer->hears_requests()) {
      interconnects.push_back(std::make_unique<HeardMemory>(config, site, *observer));
    } else {
      interconnects.push_back(node::make_memory_system(config, site));
    }
    links.push_back(interconnects.back().get());
  }
  nodes.connect(links);
  return interconnects;
}

void add_cluster(const memory::Interconnect& memory, sim::Ticks end, MachineResult& result) {
  ClusterResult& cluster =
      result.clusters.emplace_back(ClusterResult{memory.statistics(), memory.bank_statistics()});
  cluster.dram = memory.dram_statistics(end);
  if (const memory::DistributedStatistics* const accesses = memory.distribution()) {
    cluster.distributed = {*accesses, *memory.network_statistics()};
  }
  if (const memory::SharedCacheStatistics* const cache = memory.cache_statistics()) {
    result.l2.caches.push_back(cache->lookups);
    result.l2.waits.push_back(cache->waits);
  }
}

MachineResult common_result(const machine::MachineConfig& config, const sim::Engine& engine,
                            const node::NodeArray& nodes, const Interconnects& interconnects,
                            const memory::Layout& layout, sim::Ticks end) {
  MachineResult result;
  result.end = end;
  result.nodes = nodes.statistics();
  for (const auto& interconnect : interconnects) {
    add_cluster(*interconnect, end, result);
  }
  if (config.l2.sharing == machine::SecondLevel::private_caches) {
    result.l2 = nodes.second_level();
  }
  result.counts = nodes.cache_counts();
  result.build = nodes.build_result();
  result.contexts = nodes.context_result();
  result.simt = nodes.simt_result();
  result.database_bytes = layout.database_bytes();
  result.copies = config.placement == machine::Placement::replicated ? config.all_nodes() : config.clusters;
  result.events = engine.events();
  result.host_bytes_per_node = nodes.bytes_per_node();
  result.unloaded_miss = interconnects.front()->unloaded_read(config.reference_bytes());
  return result;
}

}  // namespace marti::processors::replay
