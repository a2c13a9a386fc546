#include "studies/figures/counted_figures.h"

#include <algorithm>
#include <map>
#include <string>

#include "processors/cost/accounting.h"
#include "processors/node/memory_system.h"
#include "processors/replay/bounds.h"
#include "processors/replay/cache_laws.h"
#include "sim/error.h"
#include "studies/figures/counted_parts.h"
#include "studies/figures/machine_totals.h"

namespace marti::studies::figures {

using processors::cost::Activity;
using processors::machine::MachineConfig;
using processors::replay::MachineResult;

namespace {

void add_machine(FigureParts& parts, const MachineResult& r) {
  parts.add("end", {"ps", "frame time: when the last node and the last posted write are done", Merge::one},
            r.end);
  parts.add_count("nodes", {"1", "nodes of all clusters", Merge::one, Better::neither}, r.nodes.size());
  parts.add_count("clusters", {"1", "clusters", Merge::one, Better::neither}, r.clusters.size());
  parts.add_count("packets", {"1", "packets that the frame is divided into", Merge::one, Better::neither},
                  r.packets);
  parts.add_count(
      "database_bytes",
      {"byte", "one copy of the database as the frame begins, without the frame buffer", Merge::one},
      r.database_bytes);
  parts.add_count(
      "database_copies",
      {"1", "copies of the database: one for each cluster, or for each node when replicated", Merge::one},
      r.copies);
  parts.add("unloaded_miss",
            {"ps", "time of a miss that waits for no other; distributed: mean over all homes, for node 0",
             Merge::one},
            r.unloaded_miss);
  parts.add_count("events",
                  {"1", "events that the program handled, fewer where it knew the outcome without them",
                   Merge::one, Better::program},
                  r.events);
  parts.add_all("host_", "host", std::optional(r.host));
  const processors::cost::TimeSums time = r.time();
  for (std::size_t i = 0; i < processors::cost::activities; ++i) {
    parts.add("time_", processors::cost::activity_names[i],
              {"ps", "time of all nodes in this activity (model.md, Accounting)"}, time[i]);
  }
  sim::Sum without_work = 0;
  for (const processors::cost::NodeStatistics& node : r.nodes) {
    if (!processors::replay::had_work(node)) {
      for (const Activity activity : {Activity::idle, Activity::message_wait}) {
        without_work += node.time[static_cast<std::size_t>(activity)];
      }
    }
  }
  parts.add("time_without_work",
            {"ps", "part of time_idle and time_message_wait: of nodes that never had work"}, without_work);
  parts.add_all("steps_", "steps of all nodes", std::optional(r.steps()));
}

void add_references(FigureParts& parts, const MachineResult& r) {
  const processors::cost::ReferenceCounts counts = r.references();
  const auto records = processors::cost::records_of(r.steps(), r.leaf_records);
  parts.add("hits",
            {"1", "lines found in the nodes' own caches, first level; without a cache none", Merge::sum,
             Better::higher},
            counts.all_hits());
  parts.add("misses", {"1", "lines not found there; without a cache, parts of records read (model.md)"},
            counts.all_misses());
  for (std::size_t kind = 0; kind < memory::record_kinds; ++kind) {
    const std::string prefix = std::string(memory::record_kind_names[kind]) + "_";
    parts.add(prefix, "records",
              {"1", "records of this kind read by rays; the leaves of a bvh have none; pixels: written",
               Merge::sum, Better::neither},
              records[kind]);
    parts.add(prefix, "hits",
              {"1", "lines of this kind found in the first level", Merge::sum, Better::higher},
              counts.hits[kind]);
    parts.add(prefix, "misses", {"1", "lines of this kind not found there"}, counts.misses[kind]);
  }
}

void add_nodes(FigureParts& parts, const MachineResult& r, const MachineTotals& totals) {
  parts.add_all("node_", "all nodes", totals.node);
  const auto by_finish = [](const auto& a, const auto& b) { return a.finish < b.finish; };
  const auto [first, last] = std::minmax_element(r.nodes.begin(), r.nodes.end(), by_finish);
  const bool there = !r.nodes.empty();
  parts.add("earliest_finish",
            {"ps", "when the first node learned that no packet was left", Merge::least, Better::neither},
            there ? std::optional(first->finish) : std::nullopt);
  parts.add("latest_finish", {"ps", "when the last node did", Merge::largest},
            there ? std::optional(last->finish) : std::nullopt);
}

// What is left of the frame time of all links; 0 without links.
template <class S>
sim::Sum idle_of(sim::Ticks end, const std::optional<sim::Sums<S>>& links) {
  return links ? sim::Sum{end} * links->named("links") - links->named("busy") : sim::Sum{0};
}

void add_memory(FigureParts& parts, const MachineConfig& machine, const MachineResult& r,
                const MachineTotals& totals) {
  parts.add_all("interconnect_", "interconnects of all clusters (distributed memory: its network)",
                totals.interconnect);
  const bool links = totals.interconnect.has_value() && processors::node::has_links(machine);
  parts.add("interconnect_no_request",
            {"ps", "time for which links transfer nothing, because nobody asks for it", Merge::sum,
             Better::neither},
            only(links, idle_of(r.end, totals.interconnect)));
  parts.add("most_interconnect_busy",
            {"ps", "transfer time of the busiest cluster's interconnect", Merge::largest},
            only(totals.interconnect.has_value(), totals.most_interconnect_busy));
  add_waits(parts, "interconnect_wait_", "waits for the interconnects", totals.interconnect_waits);
  const bool banks = totals.bank.has_value();
  parts.add("banks",
            {"1", "banks of all clusters; distributed memory: the nodes' memories; DRAM: channels",
             Merge::sum, Better::neither},
            only(banks, totals.banks));
  parts.add_all("bank_", "all banks (distributed memory: the nodes' memories; DRAM: channels)", totals.bank);
  parts.add("most_bank_busy", {"ps", "busy time of the busiest bank", Merge::largest},
            only(banks, totals.most_bank_busy));
  add_waits(parts, "bank_wait_", "waits for the banks", totals.bank_waits);
  parts.add_all("dram_", "DRAM channels", totals.dram);
  parts.add_all("distributed_", "distributed memory", totals.distributed);
  parts.add_all("network_", "networks of all clusters", totals.network);
  parts.add("network_no_request", {"ps", "time for which links have no message", Merge::sum, Better::neither},
            only(totals.network.has_value(), idle_of(r.end, totals.network)));
  parts.add("most_network_busy",
            {"ps", "time that messages held the links of the busiest cluster's network", Merge::largest},
            only(totals.network.has_value(), totals.most_network_busy));
  add_waits(parts, "network_wait_", "waits for the networks' links", totals.network_waits);
}

void add_all(FigureParts& parts, const MachineConfig& machine, const MachineResult& result,
             const MachineTotals& totals) {
  add_machine(parts, result);
  add_references(parts, result);
  add_nodes(parts, result, totals);
  add_memory(parts, machine, result, totals);
  add_bounds(parts, machine, result, totals);
  add_flow_figures(parts, machine, result, totals);
  add_build_figures(parts, result);
  add_cache_figures(parts, result, totals);
  add_asked_figures(parts, machine, result);
  parts.add("memory_bytes_read",
            {"byte", "lines that banks and nodes' own memories read, whole ones where DRAM reads bursts"},
            processors::replay::reads_of_memory(machine, result) * machine.reference_bytes());
  parts.add_all("energy_", "where [energy] is on", result.energy);
}

}  // namespace

std::span<const FigureEntry> counted_figures() {
  static const std::vector<FigureEntry> figures = [] {
    std::vector<FigureEntry> made;
    FigureParts parts(&made);
    add_all(parts, {}, {}, {});
    return made;
  }();
  return figures;
}

Counts counts_of(const MachineConfig& machine, const MachineResult& result, const MachineTotals& totals) {
  FigureParts parts(nullptr);
  add_all(parts, machine, result, totals);
  return parts.take_values();
}

Counts counts_of(const MachineConfig& machine, const MachineResult& result) {
  return counts_of(machine, result, totals_of(result));
}

std::optional<Count> count_of(const Counts& counts, std::string_view figure) {
  static const std::map<std::string, std::size_t, std::less<>> places = [] {
    std::map<std::string, std::size_t, std::less<>> made;
    for (std::size_t i = 0; i < counted_figures().size(); ++i) {
      made.emplace(counted_figures()[i].name, i);
    }
    return made;
  }();
  const auto place = places.find(figure);
  sim::ensure(place != places.end() && place->second < counts.size(),
              "there is no counted figure of this name");
  return counts[place->second];
}

}  // namespace marti::studies::figures
