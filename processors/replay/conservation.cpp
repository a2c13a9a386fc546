#include "processors/node/build_report.h"
#include "processors/node/memory_system.h"
#include "processors/replay/cache_laws.h"
#include "processors/replay/flow_conservation.h"
#include "processors/replay/replay.h"
#include "processors/walk/law.h"
#include "sim/error.h"

namespace marti::processors::replay {

namespace {

template <class Division>
auto part(const Division& time, cost::Activity activity) {
  return time[static_cast<std::size_t>(activity)];
}

void check_node(const cost::NodeStatistics& node, sim::Ticks end, bool simt) {
  walk::require_equal(cost::sum_of(node.time), end, "the activities of a node add up to the frame time");
  walk::require(simt ? node.steps.pixels >= node.writes && (node.steps.pixels == 0) == (node.writes == 0)
                     : node.steps.pixels == node.writes,
                "finished pixels are pixel writes, and of a SIMT node one write may have several");
  walk::require(node.steps.sphere_tests + node.steps.cone_tests <= node.steps.tests,
                "tests of spheres, cylinders and cones are tests");
}

void check_distributed(const ClusterResult& cluster) {
  if (!cluster.distributed) {
    return;
  }
  const auto& [accesses, network] = *cluster.distributed;
  const memory::InterconnectStatistics& traffic = cluster.interconnect;
  walk::require(traffic.reads == accesses.local_reads + accesses.remote_reads &&
                    traffic.writes == accesses.local_writes + accesses.remote_writes,
                "every access of a distributed memory is of the node's own or of another's");
  walk::require(network.messages == 2 * accesses.remote_reads + accesses.remote_writes,
                "a read of another node's memory is two messages, a write one");
  std::int64_t served = 0;
  for (const memory::BankStatistics& bank : cluster.banks) {
    served += bank.accesses;
  }
  walk::require(served == traffic.reads + traffic.writes, "every access is served by one memory");
}

// What the links of a bus or crossbar do. Those of a network are checked as a network's.
void check_links(const memory::InterconnectStatistics& traffic, const machine::MachineConfig& config,
                 sim::Ticks end) {
  const memory::InterconnectConfig& link = config.interconnect;
  walk::require(traffic.busy <= sim::Sum{end} * traffic.links,
                "links are not busy for longer than the frame");
  if (config.placement == machine::Placement::distributed) {
    return;
  }
  const bool bus = link.kind == memory::InterconnectKind::bus;
  const sim::Sum addresses =
      bus ? sim::Sum{link.clock.cycles(link.address_cycles)} * (traffic.reads + traffic.writes) : sim::Sum{0};
  walk::require(traffic.busy == traffic.data + addresses + traffic.held,
                "links move data, send an address for each transaction of a bus, or are held");
  walk::require(traffic.held == 0 || (bus && link.mode == memory::BusMode::held),
                "only a held bus is held while its bank works");
}

void check_network(const memory::NetworkStatistics& network, const memory::NetworkConfig& config,
                   sim::Ticks end) {
  const sim::Sum latency = config.kind == memory::NetworkKind::bus
                               ? sim::Sum{config.clock.cycles(config.hop_cycles)} * network.messages
                               : sim::Sum{0};
  walk::require(network.busy == network.data + latency,
                "a network's links move bytes; its bus has a latency");
  walk::require(network.busy <= sim::Sum{end} * network.links,
                "a network's links are not busy for longer than the frame");
}

void check_dram(const ClusterResult& cluster, const machine::MachineConfig& config, sim::Ticks end) {
  for (const memory::DramStatistics& channel : cluster.dram) {
    const sim::Ticks burst = config.banks.dram->period * config.banks.dram->timing.bl;
    walk::require(channel.data_busy == sim::multiply_ticks(burst, channel.read_bursts + channel.write_bursts),
                  "the data buses of DRAM move data for the time of its bursts");
    walk::require(channel.bus_no_request >= 0, "no data of DRAM move after the end of the frame");
    walk::require(sim::Sum{channel.data_busy} + channel.bus_rows + channel.bus_refresh + channel.bus_turn +
                          channel.bus_no_request ==
                      sim::Sum{end} * channel.data_buses,
                  "what the data buses of DRAM do adds up to the frame time");
    walk::require(channel.row_hits + channel.row_misses + channel.row_conflicts ==
                      channel.read_bursts + channel.write_bursts,
                  "every burst of DRAM finds its row open, another row or none");
  }
}

void check_contexts(const machine::MachineConfig& config, const MachineResult& result) {
  const sim::Ticks each = config.clock.cycles(config.switch_cycles);
  for (std::size_t node = 0; node < result.contexts.nodes.size(); ++node) {
    const walk::ContextCounts& counts = result.contexts.nodes[node];
    walk::require(part(result.nodes[node].time, cost::Activity::switching) ==
                      sim::multiply_ticks(each, counts.switches),
                  "switching is the switches' time");
    walk::require(counts.useful + counts.useless == counts.issued, "prefetched lines are useful or useless");
  }
}

void check_simt(const program::WorkLog& log, const machine::MachineConfig& config,
                const MachineResult& result) {
  for (std::size_t node = 0; node < result.simt.nodes.size(); ++node) {
    const walk::SimtCounts& counts = result.simt.nodes[node];
    walk::require(counts.joined <= result.nodes[node].references.all_hits(),
                  "a line that is joined is a hit");
    walk::require(counts.accesses <= counts.records, "each access has a lane that reads a record");
    walk::require(counts.rays <= counts.records, "a ray is in the unit to read a record");
    walk::require(counts.fills <= counts.spills, "lines of stacks are written before they are read");
  }
  if (result.simt.nodes.empty()) {
    return;
  }
  const walk::SimtCounts counts = result.simt.counts();
  walk::require(
      config.rt.sort == machine::RaySort::none
          ? counts.sorted_rays == 0 && counts.sorted_warps == 0
          : counts.sorted_rays == counts.rays + counts.returns && counts.sorted_warps == counts.traces,
      "each ray that reads a record is sorted, or none is");
  walk::require(counts.sorted_rays <= counts.sorted_warps * config.simt.lanes &&
                    counts.sorted_warps <= counts.sorted_rays,
                "a warp of sorted rays has a ray, and no more rays than lanes");
  walk::require(config.rt.share != machine::RtShare::none || counts.helps == 0,
                "lanes help each other where they may");
  // Of a bvh a leaf that is taken as one voxel has no record.
  const cost::StepCounts steps = result.steps();
  const bool leaf_records = !accel::walks_bvh(log.traversal);
  const std::int64_t most = steps.branches + steps.transforms + (leaf_records ? steps.leaves : 0) +
                            steps.cuts + steps.lists + steps.tests + steps.passes;
  const std::int64_t records = counts.records - counts.fills;
  walk::require(records <= most && records >= most - (leaf_records ? 0 : steps.cuts),
                "lanes read each record of their rays once");
}

}  // namespace

void check_conservation(const program::WorkLog& log, const machine::MachineConfig& config,
                        const MachineResult& result) {
  for (const cost::NodeStatistics& node : result.nodes) {
    check_node(node, result.end, !result.simt.nodes.empty());
  }
  const cost::StepCounts steps = result.steps();
  if (config.scheme == machine::Scheme::image) {
    const bool written = config.pixels == machine::Pixels::written;
    walk::require(steps.pixels == (written ? static_cast<std::int64_t>(result.pixels) : 0),
                  "every pixel that is handed out is written once, or collected");
    std::int64_t packets = 0;
    for (const cost::NodeStatistics& node : result.nodes) {
      packets += node.packets;
    }
    walk::require(packets == static_cast<std::int64_t>(result.packets), "every packet is traced once");
  } else {
    check_flow_conservation(log, config, result);
  }

  std::int64_t reads = 0;
  std::int64_t writes = 0;
  sim::Sum interconnect_waits = 0;
  sim::Sum bank_waits = 0;
  for (const ClusterResult& cluster : result.clusters) {
    const memory::InterconnectStatistics& traffic = cluster.interconnect;
    reads += traffic.reads;
    writes += traffic.writes;
    interconnect_waits += traffic.waits.sum;
    if (node::has_links(config)) {
      check_links(traffic, config, result.end);
    }
    if (cluster.distributed) {
      check_network(cluster.distributed->network, config.network, result.end);
    }
    for (const memory::BankStatistics& bank : cluster.banks) {
      bank_waits += bank.waits.sum;
    }
    check_distributed(cluster);
    check_dram(cluster, config, result.end);
  }
  for (const memory::NetworkStatistics& network : result.flow.networks) {
    check_network(network, config.network, result.end);
  }
  const node::BuildCounts built = result.build.counts();
  const bool own_memories =
      config.placement == machine::Placement::replicated || config.scheme == machine::Scheme::space;
  const std::int64_t beyond = own_memories ? 0 : reads_beyond_caches(config, result) - built.local_misses;
  walk::require(
      reads == beyond + built.locks,
      "every miss and prefetch that no private second level serves, and every lock, is one read of the "
      "interconnect");
  check_second_level_laws(config, result);
  walk::check_counts(result.counts, result.references(), result.contexts.counts().issued, result.time(),
                     result.simt.nodes.empty());
  // With a replicated database everything is in the nodes' own memories; a second level serves own misses,
  // too.
  if (result.counts.sharing && !own_memories && config.l2.sharing != machine::SecondLevel::private_caches) {
    walk::require(result.counts.own_misses == built.local_misses,
                  "the misses that only one node can have are those of what it has built in its own memory");
  }
  std::int64_t pixel_writes = 0;
  for (const cost::NodeStatistics& node : result.nodes) {
    pixel_writes += node.writes;
  }
  walk::require(writes == pixel_writes + built.writes + result.simt.counts().spills,
                "every pixel, every part of the tree and every line of a stack is one write of the "
                "interconnect");
  // Posted writes wait too, but the nodes do not.
  const cost::TimeSums time = result.time();
  // A SIMT node waits in whole cycles.
  const sim::Sum rounded =
      result.simt.nodes.empty() ? sim::Sum{0} : sim::Sum{config.clock.period()} * (reads + 1);
  for (const memory::WaitStatistics& waits : result.l2.waits) {
    bank_waits += waits.sum;
  }
  walk::require(part(time, cost::Activity::interconnect_wait) <= interconnect_waits + rounded,
                "nodes wait for the interconnect no longer than its transactions do");
  walk::require(part(time, cost::Activity::bank_wait) <= bank_waits + rounded,
                "nodes wait for banks no longer than accesses do");
  check_contexts(config, result);
  check_simt(log, config, result);
  if (result.build.sharing != machine::Sharing::given) {
    node::check_build(log, config, result.build);
  }
}

}  // namespace marti::processors::replay
