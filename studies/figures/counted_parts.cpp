#include "studies/figures/counted_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "memory/miss_classes.h"
#include "processors/cost/accounting.h"
#include "processors/flow/pipeline/stages.h"
#include "processors/node/memory_system.h"
#include "processors/replay/bounds.h"
#include "processors/walk/attribution.h"
#include "sim/error.h"
#include "studies/figures/flow_figures.h"

namespace marti::studies::figures {

using processors::machine::MachineConfig;
using processors::replay::MachineResult;

void add_waits(FigureParts& parts, const std::string& prefix, std::string_view whose,
               const std::optional<memory::WaitStatistics>& waits) {
  parts.add_all(prefix, whose, waits);
  for (const int percent : {50, 95, 99}) {
    parts.add(
        prefix, "p" + std::to_string(percent),
        {"ps", fmt::format("{}: {} % are not longer than this, at most an eighth too long", whose, percent),
         Merge::one},
        waits ? std::optional<Count>(waits->histogram.percentile(percent)) : std::nullopt);
  }
}

void add_bounds(FigureParts& parts, const MachineConfig& machine, const MachineResult& r,
                const MachineTotals& totals) {
  using memory::InterconnectKind;
  using processors::cost::ActivityKind;
  const processors::replay::FrameBounds bounds = processors::replay::frame_bounds(machine, r);
  parts.add("bound", {"ps", "no frame in which node, link and bank have this work is shorter", Merge::one},
            bounds.least());
  const bool links = machine.placement == processors::machine::Placement::shared &&
                     processors::node::has_links(machine) && totals.interconnect.has_value();
  // A held bus waits for its bank. How long a DRAM bank takes depends on the accesses before.
  const bool banks = links && totals.bank.has_value() && !machine.banks.dram &&
                     !(machine.interconnect.kind == InterconnectKind::bus &&
                       machine.interconnect.mode == memory::BusMode::held);
  const processors::cost::TimeSums time = r.time();
  const Count round =
      processors::cost::sum_of_kinds({ActivityKind::computing, ActivityKind::memory, ActivityKind::delay},
                                     [&](std::size_t i) { return time[i]; });
  const Count queues =
      links ? totals.interconnect->named("busy") + (banks ? totals.bank->named("busy") : 0) : 0;
  parts.add("queue_round",
            {"ps", "time of all nodes without queues and idling, or of all queues if that is longer",
             Merge::one, Better::neither},
            only(links, std::max(round, queues)));
  parts.add("busiest_queue", {"ps", "busy time of the busiest link or bank that nodes wait for", Merge::one},
            only(links, banks ? std::max(bounds.interconnect, totals.most_bank_busy) : bounds.interconnect));
}

void add_flow_figures(FigureParts& parts, const MachineConfig& machine, const MachineResult& r,
                      const MachineTotals& totals) {
  const processors::flow::FlowResult& flow = r.flow;
  const bool there = totals.flow.has_value();
  const bool space = there && machine.scheme == processors::machine::Scheme::space;
  parts.add_all("flow_", "rays of all nodes", totals.flow);
  parts.add("flow_rays", {"1", "camera rays the host sent and rays made", Merge::sum, Better::neither},
            only(there, flow.rays));
  parts.add("flow_collected", {"1", "contributions that reached the host", Merge::sum, Better::neither},
            only(there, flow.collected));
  parts.add("flow_most_in_flight", {"1", "most rays at a time, of all clusters together", Merge::one},
            only(there, flow.most_in_flight));
  const bool memory = !flow.memory_bytes.empty();
  const auto [least, most] = std::minmax_element(flow.memory_bytes.begin(), flow.memory_bytes.end());
  parts.add_count("flow_least_memory",
                  {"byte", "the database in a node's own memory: the least of a node", Merge::least},
                  memory ? std::optional(*least) : std::nullopt);
  parts.add_count("flow_most_memory",
                  {"byte", "the database in a node's own memory: the most of a node", Merge::largest},
                  memory ? std::optional(*most) : std::nullopt);
  std::uint64_t all = 0;
  for (const std::uint64_t bytes : flow.memory_bytes) {
    sim::ensure(!__builtin_add_overflow(all, bytes, &all), "a counted figure overflowed");
  }
  parts.add_count("flow_memory", {"byte", "the database in the nodes' own memories, all together"},
                  only(memory, all));
  parts.add_count("regions", {"1", "space: regions cut out of the tree", Merge::one, Better::neither},
                  only(space, flow.regions));
  parts.add_count("top_nodes", {"1", "space: tree nodes that every node has", Merge::one},
                  only(space, flow.top_nodes));
  parts.add_count("duplicated_primitives",
                  {"1", "space: records beyond one of each, in a cluster", Merge::one},
                  only(space, flow.duplicated_primitives));
  parts.add("sampling_work",
            {"ps", "space: computing of one node for the pre-pass of sampled regions, before the frame",
             Merge::one},
            only(space, flow.sampling_work));
  const bool pipeline = there && machine.scheme == processors::machine::Scheme::pipeline;
  const FlowFigures figures = pipeline ? flow_figures(machine, r) : FlowFigures();
  for (std::size_t stage = 0; stage < processors::machine::pipeline_stages; ++stage) {
    parts.add("stage_", std::string(processors::flow::stage_names[stage]) + "_busy",
              {"ps", "pipeline: time in which the nodes of this stage worked", Merge::one, Better::neither},
              pipeline ? std::optional(figures.stages[stage].work) : std::nullopt);
  }
}

void add_build_figures(FigureParts& parts, const MachineResult& r) {
  const processors::node::BuildResult& build = r.build;
  const bool there = build.sharing != processors::machine::Sharing::given;
  parts.add("build_start_up",
            {"ps", "when the initial trees are there and the host begins; part of end", Merge::one},
            only(there, build.start_up));
  parts.add("build_start_up_wait", {"ps", "waits of all nodes for it; part of time_dispatch_wait"},
            only(there, build.start_up_wait));
  parts.add("build_databases", {"1", "copies of the initial tree", Merge::one}, only(there, build.databases));
  parts.add("build_trees", {"1", "copies of what is below it", Merge::one}, only(there, build.trees));
  parts.add("build_wasted_splits", {"1", "splits that another node of the database had made too"},
            there ? std::optional(build.wasted_splits()) : std::nullopt);
  parts.add_count("build_levels", {"1", "levels of the tree", Merge::one, Better::neither},
                  only(there, build.levels.size()));
  parts.add_all("build_", "building, all nodes", only(there, build.counts()));
  parts.add_all("tree_", "all levels of the trees", only(there, build.all_levels()));
}

void add_cache_figures(FigureParts& parts, const MachineResult& r, const MachineTotals& totals) {
  parts.add_all("l2_", "second level", only(!r.l2.caches.empty(), r.l2.counters()));
  add_waits(parts, "l2_wait_", "waits of hits for lines on their way to a shared second level",
            totals.l2_waits);
  parts.add_all("simt_", "SIMT nodes", only(!r.simt.nodes.empty(), r.simt.counts()));
  parts.add_all("contexts_", "all nodes", only(!r.contexts.nodes.empty(), r.contexts.counts()));
}

void add_asked_figures(FigureParts& parts, const MachineConfig& machine, const MachineResult& r) {
  const auto& classes = r.counts.miss_classes;
  for (std::size_t i = 0; i < memory::miss_classes; ++i) {
    std::optional<std::int64_t> all;
    for (std::size_t kind = 0; classes && kind < memory::record_kinds; ++kind) {
      all = all.value_or(0) + (*classes)[kind][i];
    }
    parts.add("all_misses_", memory::miss_class_names[i], {"1", "misses of this class"}, all);
  }
  for (std::size_t kind = 0; kind < memory::record_kinds; ++kind) {
    const std::string prefix = std::string(memory::record_kind_names[kind]) + "_misses_";
    for (std::size_t i = 0; i < memory::miss_classes; ++i) {
      parts.add(prefix, memory::miss_class_names[i], {"1", "misses of records of this kind, of this class"},
                classes ? std::optional((*classes)[kind][i]) : std::nullopt);
    }
  }
  const auto& sharing = r.counts.sharing;
  parts.add("sharing_fetches", {"1", "lines fetched"},
            sharing ? std::optional(sharing->fetches) : std::nullopt);
  parts.add("sharing_distinct_lines",
            {"1", "different lines that a cluster fetched", Merge::sum, Better::neither},
            sharing ? std::optional(sharing->distinct) : std::nullopt);
  parts.add("sharing_lines_of_one", {"1", "of these, fetched by one node only", Merge::sum, Better::neither},
            sharing ? std::optional(sharing->by(1)) : std::nullopt);
  parts.add("sharing_lines_of_all",
            {"1", "of these, fetched by every node of the cluster", Merge::sum, Better::neither},
            sharing ? std::optional(sharing->by(machine.nodes)) : std::nullopt);
  const auto attributed = [&](const auto& of) {
    std::optional<processors::walk::AttributionCounts> sum;
    if (r.counts.attribution) {
      sum.emplace();
      for (const processors::walk::AttributionRow& row : *r.counts.attribution) {
        if (of(row)) {
          sim::merge(*sum, row.counts);
        }
      }
    }
    return sum;
  };
  for (std::size_t ray = 0; ray < processors::program::ray_kinds; ++ray) {
    const std::string name(processors::program::ray_kind_names[ray]);
    parts.add_all(name + "_ray_", "for " + name + " rays",
                  attributed([ray](const processors::walk::AttributionRow& row) {
                    return static_cast<std::size_t>(row.ray) == ray && !row.splitting;
                  }));
  }
  constexpr std::uint32_t bounces = 5;
  for (std::uint32_t bounce = 0; bounce < bounces; ++bounce) {
    const bool last = bounce + 1 == bounces;
    parts.add_all(
        "bounce_" + std::to_string(bounce) + "_",
        "for rays after " + std::to_string(bounce) + (last ? " surface points or more" : " surface points"),
        attributed([bounce, last](const processors::walk::AttributionRow& row) {
          return !row.splitting && (row.bounce == bounce || (last && row.bounce > bounce));
        }));
  }
  parts.add_all("split_", "for splitting branches of the tree",
                attributed([](const processors::walk::AttributionRow& row) { return row.splitting; }));
}

}  // namespace marti::studies::figures
