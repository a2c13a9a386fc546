#include "processors/replay.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>

#include "memory/layout.h"
#include "memory/set_tags.h"
#include "processors/node_array.h"
#include "processors/node_order.h"
#include "processors/packets.h"
#include "sim/engine.h"
#include "sim/error.h"

namespace marti::processors {

namespace {

// How the tree is built; nothing when it is given.
std::optional<TreePlan> plan_of(const WorkLog& log, const MachineConfig& config,
                                const ReplayOptions& options) {
  if (config.build.sharing == Sharing::given) {
    if (!options.starts.empty()) {
      throw sim::UserError("build.sharing: start states of branches need another than \"given\"");
    }
    return std::nullopt;
  }
  std::vector<BranchStart> starts =
      options.starts.empty() ? branch_starts(log.topology, config.build) : options.starts;
  check_starts(log.topology, starts);
  TreePlan plan(log.topology, std::move(starts), config);
  if (config.build.sharing == Sharing::none && !plan.lazy().empty()) {
    throw sim::UserError("build.sharing: \"none\" leaves no branch to be split during the frame");
  }
  return plan;
}

memory::Layout layout_of(const WorkLog& log, const MachineConfig& config, std::optional<TreePlan>& plan) {
  const memory::RecordCounts counts = {plan ? plan->initial_nodes() : log.topology.nodes.size(),
                                       plan ? plan->initial_entries() : log.topology.entries.size(),
                                       log.primitives,
                                       log.materials,
                                       log.texture_begin.empty() ? 0 : log.texture_begin.back(),
                                       std::uint64_t{log.width} * log.height};
  const memory::Layout layout(config.layout, counts, log.quadrics.size());
  const std::uint32_t unit = config.cache.organisation == CacheOrganisation::none ? config.banks.interleave
                                                                                  : config.cache.cache.line;
  if (plan) {
    plan->place_behind(layout, unit);
  }
  if (std::max(layout.end(), plan ? plan->end() : 0) / unit >= memory::no_line) {
    throw sim::UserError("the database has 2^32 or more lines; use longer cache lines");
  }
  return layout;
}

}  // namespace

StepCounts MachineResult::steps() const {
  StepCounts sum;
  for (const NodeStatistics& node : nodes) {
    sim::merge(sum, node.steps);
  }
  return sum;
}

ReferenceCounts MachineResult::references() const {
  ReferenceCounts sum;
  for (const NodeStatistics& node : nodes) {
    sum += node.references;
  }
  return sum;
}

TimeDivision MachineResult::time() const {
  TimeDivision sum{};
  for (const NodeStatistics& node : nodes) {
    for (std::size_t i = 0; i < activities; ++i) {
      sum[i] = sim::add_ticks(sum[i], node.time[i]);
    }
  }
  return sum;
}

MachineResult replay(const WorkLog& log, const MachineConfig& config, const ReplayOptions& options) {
  check(config);
  check_prefetch(config.prefetch, log.traversal);
  std::optional<TreePlan> plan = plan_of(log, config, options);
  const memory::Layout layout = layout_of(log, config, plan);
  const PacketList packets(log.width, log.height, config.packets);
  const std::vector<std::uint32_t> rank = config.layout.node_order == memory::NodeOrder::depth_first
                                              ? depth_first_rank(log.topology)
                                              : std::vector<std::uint32_t>{};
  sim::Engine engine;
  engine.reserve(std::size_t{config.all_nodes()} * config.contexts + 1);
  Host host(config.host, packets.size(), config.all_nodes());
  const std::unique_ptr<NodeArray> nodes =
      make_node_array({log, config, layout, packets, rank, options.step_by_step, plan ? &*plan : nullptr,
                       options.report_built, options.with_contexts},
                      engine, host);

  std::vector<std::unique_ptr<memory::Interconnect>> interconnects;
  std::vector<memory::Interconnect*> links;
  const std::uint32_t ports = config.nodes * config.ports_of_node();
  for (std::uint32_t cluster = 0; cluster < config.clusters; ++cluster) {
    interconnects.push_back(
        memory::make_interconnect(config.interconnect, config.banks,
                                  {engine, nodes->client(cluster),
                                   static_cast<std::uint8_t>(EventClass::reply), cluster * ports, ports}));
    links.push_back(interconnects.back().get());
  }
  nodes->connect(links);
  for (const EventClass c :
       {EventClass::step, EventClass::dispatch, EventClass::reply, EventClass::read, EventClass::write}) {
    engine.attach(static_cast<std::uint8_t>(c), *nodes);
  }
  nodes->start(options.start_seed);
  // Every event moves some node on by at least one step of a finite log, so no limit is needed.
  engine.run(std::numeric_limits<std::uint64_t>::max());
  nodes->finish();

  MachineResult result;
  result.end = nodes->end();
  result.nodes = nodes->statistics();
  for (const auto& interconnect : interconnects) {
    result.clusters.push_back({interconnect->statistics(), interconnect->bank_statistics()});
  }
  result.host = host.statistics();
  result.build = nodes->build_result();
  result.contexts = nodes->context_result();
  result.packets = packets.size();
  result.database_bytes = layout.database_bytes();
  result.copies = config.placement == Placement::replicated ? config.all_nodes() : config.clusters;
  result.events = engine.events();
  result.host_bytes_per_node = nodes->bytes_per_node();
  result.unloaded_miss = interconnects.front()->unloaded_read(
      config.cache.organisation == CacheOrganisation::none ? config.banks.interleave
                                                           : config.cache.cache.line);
  check_conservation(log, config, result);
  return result;
}

}  // namespace marti::processors
