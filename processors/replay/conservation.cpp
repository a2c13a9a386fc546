#include <string>

#include "processors/node/build_report.h"
#include "processors/node/memory_system.h"
#include "processors/replay/cache_laws.h"
#include "processors/replay/flow_conservation.h"
#include "processors/replay/replay.h"
#include "processors/walk/law.h"
#include "sim/error.h"

namespace marti::processors {

namespace {

sim::Ticks part(const TimeDivision& time, Activity activity) {
  return time[static_cast<std::size_t>(activity)];
}

void check_node(const NodeStatistics& node, sim::Ticks end, std::size_t number) {
  if (const sim::Ticks sum = sum_of(node.time); sum != end) {
    require(false, "the activities of node " + std::to_string(number) + " add up to " + std::to_string(sum) +
                       " ticks of " + std::to_string(end));
  }
  require(node.steps.pixels == node.writes, "finished pixels are pixel writes");
  require(node.steps.sphere_tests + node.steps.cone_tests <= node.steps.tests,
          "tests of spheres, cylinders and cones are tests");
}

void check_distributed(const ClusterResult& cluster) {
  if (!cluster.distributed) {
    return;
  }
  const auto& [accesses, network] = *cluster.distributed;
  const memory::InterconnectStatistics& traffic = cluster.interconnect;
  require(traffic.reads == accesses.local_reads + accesses.remote_reads &&
              traffic.writes == accesses.local_writes + accesses.remote_writes,
          "every access of a distributed memory is of the node's own or of another's");
  require(network.messages == 2 * accesses.remote_reads + accesses.remote_writes,
          "a read of another node's memory is two messages, a write one");
  std::int64_t served = 0;
  for (const memory::BankStatistics& bank : cluster.banks) {
    served += bank.accesses;
  }
  require(served == traffic.reads + traffic.writes, "every access is served by one memory");
}

void check_dram(const ClusterResult& cluster) {
  for (const memory::DramStatistics& channel : cluster.dram) {
    require(channel.row_hits + channel.row_misses + channel.row_conflicts ==
                channel.read_bursts + channel.write_bursts,
            "every burst of DRAM finds its row open, another row or none");
  }
}

void check_contexts(const MachineConfig& config, const MachineResult& result) {
  const sim::Ticks each = config.clock.cycles(config.switch_cycles);
  for (std::size_t node = 0; node < result.contexts.nodes.size(); ++node) {
    const ContextCounts& counts = result.contexts.nodes[node];
    require(part(result.nodes[node].time, Activity::switching) == sim::multiply_ticks(each, counts.switches),
            "switching is the switches' time");
    require(counts.useful + counts.useless == counts.issued, "prefetched lines are useful or useless");
  }
}

}  // namespace

void check_conservation(const WorkLog& log, const MachineConfig& config, const MachineResult& result) {
  for (std::size_t node = 0; node < result.nodes.size(); ++node) {
    check_node(result.nodes[node], result.end, node);
  }
  const StepCounts steps = result.steps();
  if (config.scheme == Scheme::image) {
    require(steps.pixels == static_cast<std::int64_t>(result.pixels),
            "every pixel that is handed out is written once");
    std::int64_t packets = 0;
    for (const NodeStatistics& node : result.nodes) {
      packets += node.packets;
    }
    require(packets == static_cast<std::int64_t>(result.packets), "every packet is traced once");
  } else {
    check_flow_conservation(log, config, result);
  }

  std::int64_t reads = 0;
  std::int64_t writes = 0;
  sim::Ticks interconnect_waits = 0;
  sim::Ticks bank_waits = 0;
  for (const ClusterResult& cluster : result.clusters) {
    const memory::InterconnectStatistics& traffic = cluster.interconnect;
    reads += traffic.reads;
    writes += traffic.writes;
    // Several may wait at the same time, so the sum of waits may overflow although the frame time does not.
    interconnect_waits = sim::add_ticks(interconnect_waits, traffic.waits.sum);
    require(!has_links(config) || traffic.busy <= sim::multiply_ticks(result.end, traffic.links),
            "links are not busy for longer than the frame");
    for (const memory::BankStatistics& bank : cluster.banks) {
      bank_waits = sim::add_ticks(bank_waits, bank.waits.sum);
    }
    check_distributed(cluster);
    check_dram(cluster);
  }
  const BuildCounts built = result.build.counts();
  const bool own_memories = config.placement == Placement::replicated || config.scheme == Scheme::space;
  const std::int64_t beyond = own_memories ? 0 : reads_beyond_caches(config, result) - built.local_misses;
  require(reads == beyond + built.locks,
          "every miss and prefetch that no private second level serves, and every lock, is one read of the "
          "interconnect");
  check_second_level_laws(config, result);
  check_counts(result.counts, result.references(), result.contexts.counts().issued, result.time());
  // With a replicated database everything is in the nodes' own memories; a second level serves own misses,
  // too.
  if (result.counts.sharing && !own_memories && config.l2.sharing != SecondLevel::private_caches) {
    require(result.counts.own_misses == built.local_misses,
            "the misses that only one node can have are those of what it has built in its own memory");
  }
  require(writes == steps.pixels + built.writes,
          "every pixel and every part of the tree is one write of the interconnect");
  // Posted writes wait too, but the nodes do not.
  const TimeDivision time = result.time();
  for (const memory::WaitStatistics& waits : result.l2.waits) {
    bank_waits = sim::add_ticks(bank_waits, waits.sum);
  }
  require(part(time, Activity::interconnect_wait) <= interconnect_waits,
          "nodes wait for the interconnect no longer than its transactions do");
  require(part(time, Activity::bank_wait) <= bank_waits, "nodes wait for banks no longer than accesses do");
  check_contexts(config, result);
  if (result.build.sharing != Sharing::given) {
    check_build(log, config, result.build);
  }
}

}  // namespace marti::processors
