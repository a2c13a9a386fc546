#include "studies/sweep/plan/sweep_row.h"

#include <algorithm>
#include <array>

#include "memory/wait_statistics.h"
#include "processors/cost/accounting.h"
#include "processors/walk/attribution.h"
#include "studies/sweep/plan/row_parts.h"

namespace marti::studies {

namespace {

using processors::ClusterResult;
using processors::MachineConfig;
using processors::MachineResult;

// Adds a part's statistics to those of all parts of its kind, which have no value if there is no part.
template <class S>
void merge_into(std::optional<S>& sum, const S& part) {
  if (!sum) {
    sum.emplace();
  }
  sim::merge(*sum, part);
}

// Waits of many queues: counters and histogram.
struct Waits {
  std::optional<memory::WaitStatistics> sum;
  sim::LogHistogram histogram;

  void add(const memory::WaitStatistics& part) {
    merge_into(sum, part);
    histogram.merge(part.histogram);
  }
};

struct Sums {
  std::optional<memory::InterconnectStatistics> interconnect;
  std::optional<memory::BankStatistics> bank;
  std::optional<memory::DistributedStatistics> distributed;
  std::optional<memory::NetworkStatistics> network;
  std::optional<processors::NodeStatistics> node;
  std::optional<processors::FlowCounts> flow;
  Waits interconnect_waits;
  Waits bank_waits;
  Waits network_waits;
  Waits l2_waits;
  std::int64_t banks = 0;
  sim::Ticks most_interconnect_busy = 0;
  sim::Ticks most_bank_busy = 0;
  sim::Ticks most_network_busy = 0;

  void add_network(const memory::NetworkStatistics& part) {
    merge_into(network, part);
    network_waits.add(part.waits);
    most_network_busy = std::max(most_network_busy, part.busy);
  }
  void add_cluster(const ClusterResult& cluster) {
    merge_into(interconnect, cluster.interconnect);
    interconnect_waits.add(cluster.interconnect.waits);
    most_interconnect_busy = std::max(most_interconnect_busy, cluster.interconnect.busy);
    for (const memory::BankStatistics& part : cluster.banks) {
      merge_into(bank, part);
      bank_waits.add(part.waits);
      most_bank_busy = std::max(most_bank_busy, part.busy);
      ++banks;
    }
    if (cluster.distributed) {
      merge_into(distributed, cluster.distributed->accesses);
      add_network(cluster.distributed->network);
    }
  }
};

Sums sums_of(const MachineResult& result) {
  Sums sums;
  for (const ClusterResult& cluster : result.clusters) {
    sums.add_cluster(cluster);
  }
  for (const memory::NetworkStatistics& network : result.flow.networks) {
    sums.add_network(network);
  }
  for (const processors::NodeStatistics& node : result.nodes) {
    merge_into(sums.node, node);
  }
  for (const processors::FlowCounts& node : result.flow.nodes) {
    merge_into(sums.flow, node);
  }
  for (const memory::WaitStatistics& waits : result.l2.waits) {
    sums.l2_waits.add(waits);
  }
  return sums;
}

// A value if there is such a part.
template <class Value>
std::optional<Value> only(bool there, Value value) {
  return there ? std::optional(value) : std::nullopt;
}

void add_machine(RowParts& parts, const MachineResult& r) {
  parts.add("end", "ps", "frame time: when the last node and the last posted write are done", r.end);
  parts.add_count("nodes", "1", "nodes of all clusters", r.nodes.size());
  parts.add_count("clusters", "1", "clusters", r.clusters.size());
  parts.add_count("packets", "1", "packets of the frame", r.packets);
  parts.add_count("database_bytes", "byte", "one copy of the database as the frame begins", r.database_bytes);
  parts.add_count("database_copies", "1", "copies of the database", r.copies);
  parts.add("unloaded_miss", "ps", "a miss that meets no other transaction", r.unloaded_miss);
  parts.add_count("events", "1", "events of the simulation", r.events);
  parts.add_all("host_", "host", std::optional(r.host));
  const processors::TimeDivision time = r.time();
  for (std::size_t i = 0; i < processors::activities; ++i) {
    parts.add("time_", processors::activity_names[i], "ps", "time of all nodes: this activity", time[i]);
  }
  parts.add_all("steps_", "steps of all nodes", std::optional(r.steps()));
}

void add_references(RowParts& parts, const MachineResult& r) {
  const processors::ReferenceCounts counts = r.references();
  const auto records = processors::records_of(r.steps());
  parts.add("hits", "1", "lines found in the nodes' own caches, first level", counts.all_hits());
  parts.add("misses", "1", "lines not found there", counts.all_misses());
  for (std::size_t kind = 0; kind < memory::record_kinds; ++kind) {
    const std::string prefix = std::string(memory::record_kind_names[kind]) + "_";
    parts.add(prefix, "records", "1", "records of this kind referred to", records[kind]);
    parts.add(prefix, "hits", "1", "lines of this kind found in the first level", counts.hits[kind]);
    parts.add(prefix, "misses", "1", "lines of this kind not found there", counts.misses[kind]);
  }
}

void add_nodes(RowParts& parts, const MachineResult& r, const Sums& sums) {
  parts.add_all("node_", "all nodes", sums.node);
  const auto by_finish = [](const auto& a, const auto& b) { return a.finish < b.finish; };
  const auto [first, last] = std::minmax_element(r.nodes.begin(), r.nodes.end(), by_finish);
  const bool there = !r.nodes.empty();
  parts.add("earliest_finish", "ps", "when the first node learned that no packet was left",
            there ? std::optional(first->finish) : std::nullopt);
  parts.add("latest_finish", "ps", "when the last node did",
            there ? std::optional(last->finish) : std::nullopt);
}

void add_memory(RowParts& parts, const Sums& sums) {
  parts.add_all("interconnect_", "interconnects of all clusters", sums.interconnect);
  parts.add("most_interconnect_busy", "ps", "transfer time of the busiest cluster's interconnect",
            only(sums.interconnect.has_value(), sums.most_interconnect_busy));
  parts.add_all("interconnect_wait_", "waits for the interconnects", sums.interconnect_waits.sum);
  const bool banks = sums.bank.has_value();
  parts.add("banks", "1", "banks of all clusters", only(banks, sums.banks));
  parts.add_all("bank_", "all banks", sums.bank);
  parts.add("most_bank_busy", "ps", "busy time of the busiest bank", only(banks, sums.most_bank_busy));
  parts.add_all("bank_wait_", "waits for the banks", sums.bank_waits.sum);
  parts.add_all("distributed_", "distributed memory", sums.distributed);
  parts.add_all("network_", "networks of all clusters", sums.network);
  parts.add("most_network_busy", "ps", "time that messages held the links of the busiest cluster's network",
            only(sums.network.has_value(), sums.most_network_busy));
  parts.add_all("network_wait_", "waits for the networks' links", sums.network_waits.sum);
}

void add_flow(RowParts& parts, const MachineConfig& machine, const MachineResult& r, const Sums& sums) {
  const processors::FlowResult& flow = r.flow;
  const bool there = sums.flow.has_value();
  const bool space = there && machine.scheme == processors::Scheme::space;
  parts.add_all("flow_", "rays of all nodes", sums.flow);
  parts.add("flow_rays", "1", "camera rays the host sent and rays made", only(there, flow.rays));
  parts.add("flow_collected", "1", "contributions that reached the host", only(there, flow.collected));
  parts.add("flow_most_in_flight", "1", "most rays at a time, of all clusters",
            only(there, flow.most_in_flight));
  const bool memory = !flow.memory_bytes.empty();
  const auto [least, most] = std::minmax_element(flow.memory_bytes.begin(), flow.memory_bytes.end());
  parts.add_count("flow_least_memory", "byte", "the database in a node's own memory: the least of a node",
                  memory ? std::optional(*least) : std::nullopt);
  parts.add_count("flow_most_memory", "byte", "the database in a node's own memory: the most of a node",
                  memory ? std::optional(*most) : std::nullopt);
  std::uint64_t all = 0;
  for (const std::uint64_t bytes : flow.memory_bytes) {
    sim::ensure(!__builtin_add_overflow(all, bytes, &all), "a counter of a row overflowed");
  }
  parts.add_count("flow_memory", "byte", "the database in the nodes' own memories, all together",
                  only(memory, all));
  parts.add_count("regions", "1", "space: regions cut out of the tree", only(space, flow.regions));
  parts.add_count("top_nodes", "1", "space: tree nodes that every node has", only(space, flow.top_nodes));
  parts.add_count("duplicated_primitives", "1", "space: records beyond one of each, in a cluster",
                  only(space, flow.duplicated_primitives));
  parts.add("sampling_work", "ps", "space: computing of a pre-pass before the frame",
            only(space, flow.sampling_work));
}

void add_build(RowParts& parts, const MachineResult& r) {
  const processors::BuildResult& build = r.build;
  const bool there = build.sharing != processors::Sharing::given;
  parts.add("build_start_up", "ps", "when the initial trees are there", only(there, build.start_up));
  parts.add("build_start_up_wait", "ps", "waits of all nodes for it", only(there, build.start_up_wait));
  parts.add("build_databases", "1", "copies of the initial tree", only(there, build.databases));
  parts.add("build_trees", "1", "copies of what is below it", only(there, build.trees));
  parts.add("build_wasted_splits", "1", "splits that another node of the database had made too",
            there ? std::optional(build.wasted_splits()) : std::nullopt);
  parts.add_count("build_levels", "1", "levels of the tree", only(there, build.levels.size()));
  parts.add_all("build_", "building, all nodes", only(there, build.counts()));
  parts.add_all("tree_", "all levels of the trees", only(there, build.all_levels()));
}

void add_caches(RowParts& parts, const MachineResult& r, const Sums& sums) {
  parts.add_all("l2_", "second level", only(!r.l2.caches.empty(), r.l2.counters()));
  parts.add_all("l2_wait_", "waits of hits for lines on their way to a shared second level",
                sums.l2_waits.sum);
  parts.add_all("contexts_", "all nodes", only(!r.contexts.nodes.empty(), r.contexts.counts()));
}

// What is counted only when it is asked for.
void add_counts(RowParts& parts, const MachineConfig& machine, const MachineResult& r) {
  const auto& classes = r.counts.miss_classes;
  for (std::size_t i = 0; i < memory::miss_classes; ++i) {
    std::optional<std::int64_t> all;
    for (std::size_t kind = 0; classes && kind < memory::record_kinds; ++kind) {
      all = all.value_or(0) + (*classes)[kind][i];
    }
    parts.add("all_misses_", memory::miss_class_names[i], "1", "misses of this class", all);
  }
  for (std::size_t kind = 0; kind < memory::record_kinds; ++kind) {
    const std::string prefix = std::string(memory::record_kind_names[kind]) + "_misses_";
    for (std::size_t i = 0; i < memory::miss_classes; ++i) {
      parts.add(prefix, memory::miss_class_names[i], "1", "misses of records of this kind, of this class",
                classes ? std::optional((*classes)[kind][i]) : std::nullopt);
    }
  }
  const auto& sharing = r.counts.sharing;
  parts.add("sharing_fetches", "1", "lines fetched",
            sharing ? std::optional(sharing->fetches) : std::nullopt);
  parts.add("sharing_distinct_lines", "1", "lines that anybody of a cluster fetched",
            sharing ? std::optional(sharing->distinct) : std::nullopt);
  parts.add("sharing_lines_of_one", "1", "of these, fetched by one node only",
            sharing ? std::optional(sharing->by(1)) : std::nullopt);
  parts.add("sharing_lines_of_all", "1", "of these, fetched by every node of the cluster",
            sharing ? std::optional(sharing->by(machine.nodes)) : std::nullopt);
  const auto attributed = [&](const auto& of) {
    std::optional<processors::AttributionCounts> sum;
    if (r.counts.attribution) {
      sum.emplace();
      for (const processors::AttributionRow& row : *r.counts.attribution) {
        if (of(row)) {
          merge_into(sum, row.counts);
        }
      }
    }
    return sum;
  };
  for (std::size_t ray = 0; ray < processors::ray_kinds; ++ray) {
    const std::string name(processors::ray_kind_names[ray]);
    parts.add_all(name + "_ray_", "for " + name + " rays",
                  attributed([ray](const processors::AttributionRow& row) {
                    return static_cast<std::size_t>(row.ray) == ray && !row.splitting;
                  }));
  }
  parts.add_all("split_", "for splitting branches of the tree",
                attributed([](const processors::AttributionRow& row) { return row.splitting; }));
}

void add_row(RowParts& parts, const MachineConfig& machine, const MachineResult& result, const Sums& sums) {
  add_machine(parts, result);
  add_references(parts, result);
  add_nodes(parts, result, sums);
  add_memory(parts, sums);
  add_flow(parts, machine, result, sums);
  add_build(parts, result);
  add_caches(parts, result, sums);
  add_counts(parts, machine, result);
}

constexpr std::array<std::string_view, 4> histogram_names = {"interconnect_wait", "bank_wait", "network_wait",
                                                             "l2_wait"};

}  // namespace

std::span<const Column> sweep_columns() {
  static const std::vector<Column> columns = [] {
    std::vector<Column> made;
    RowParts parts(&made);
    add_row(parts, {}, {}, {});
    return made;
  }();
  return columns;
}

std::span<const std::string_view> sweep_histogram_names() { return histogram_names; }

SweepRow sweep_row(const MachineConfig& machine, const MachineResult& result) {
  const Sums sums = sums_of(result);
  RowParts parts(nullptr);
  add_row(parts, machine, result, sums);
  SweepRow row;
  row.counters = parts.take_values();
  const std::array<const Waits*, histogram_names.size()> waits = {&sums.interconnect_waits, &sums.bank_waits,
                                                                  &sums.network_waits, &sums.l2_waits};
  for (std::size_t i = 0; i < waits.size(); ++i) {
    if (waits[i]->histogram.count() == 0) {
      continue;
    }
    SweepHistogram& histogram = row.histograms.emplace_back();
    histogram.what = histogram_names[i];
    for (const sim::LogHistogram::Bucket& bucket : waits[i]->histogram.buckets()) {
      histogram.buckets.push_back({bucket.lowest, bucket.highest, bucket.count});
    }
  }
  return row;
}

}  // namespace marti::studies
