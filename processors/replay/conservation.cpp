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

void check_dram(const ClusterResult& cluster) {
  for (const memory::DramStatistics& channel : cluster.dram) {
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

void check_simt(const program::WorkLog& log, const MachineResult& result) {
  for (std::size_t node = 0; node < result.simt.nodes.size(); ++node) {
    const walk::SimtCounts& counts = result.simt.nodes[node];
    walk::require(counts.joined <= result.nodes[node].references.all_hits(),
                  "a line that is joined is a hit");
    walk::require(counts.accesses <= counts.records, "each access has a lane that reads a record");
    walk::require(counts.rays <= counts.records, "a ray is in the unit to read a record");
  }
  if (result.simt.nodes.empty()) {
    return;
  }
  // Of a bvh a leaf that is taken as one voxel has no record.
  const cost::StepCounts steps = result.steps();
  const bool leaf_records = !accel::walks_bvh(log.traversal);
  const std::int64_t most = steps.branches + (leaf_records ? steps.leaves : 0) + steps.cuts + steps.lists +
                            steps.tests + steps.passes;
  const std::int64_t records = result.simt.counts().records;
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
    walk::require(!node::has_links(config) || traffic.busy <= sim::Sum{result.end} * traffic.links,
                  "links are not busy for longer than the frame");
    for (const memory::BankStatistics& bank : cluster.banks) {
      bank_waits += bank.waits.sum;
    }
    check_distributed(cluster);
    check_dram(cluster);
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
  walk::require(writes == pixel_writes + built.writes,
                "every pixel and every part of the tree is one write of the interconnect");
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
  check_simt(log, result);
  if (result.build.sharing != machine::Sharing::given) {
    node::check_build(log, config, result.build);
  }
}

}  // namespace marti::processors::replay
