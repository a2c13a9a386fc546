#include "processors/replay/replay.h"

#include <memory>
#include <optional>
#include <string>

#include "processors/machine/packets.h"
#include "processors/node/node_array.h"
#include "processors/node/work_ahead.h"
#include "processors/path/path_recorder.h"
#include "processors/replay/bounds.h"
#include "processors/replay/energy_counts.h"
#include "processors/replay/host_bytes.h"
#include "processors/replay/interval_sampler.h"
#include "processors/replay/machine_parts.h"
#include "processors/replay/pipeline.h"
#include "processors/replay/record_laws.h"
#include "processors/replay/replay_parts.h"
#include "processors/replay/space.h"
#include "processors/simt/simt_nodes.h"
#include "processors/walk/left_out.h"
#include "processors/walk/node_order.h"
#include "processors/walk/observer.h"
#include "processors/walk/record_places.h"
#include "processors/walk/stripped_log.h"
#include "sim/engine.h"
#include "sim/error.h"
#include "sim/key_error.h"

namespace marti::processors::replay {

namespace {

// The plan by which the tree is built; std::nullopt when the tree is given.
std::optional<walk::TreePlan> plan_of(const program::WorkLog& log, const machine::MachineConfig& config,
                                      const ReplayOptions& options) {
  std::optional<walk::TreePlan> plan = walk::tree_plan_of(log, config, options.starts);
  if (!plan && !options.starts.empty()) {
    throw sim::UserError("build.sharing: start states of branches need another than \"given\"");
  }
  if (config.build.sharing == machine::Sharing::none && !plan->lazy().empty()) {
    throw sim::UserError("build.sharing: \"none\" leaves no branch to be split during the frame");
  }
  return plan;
}

// Decides what the replay leaves out, and sets `input` accordingly.
walk::LeftOut leave_out(const ReplayOptions& options, walk::ReplayInput& input) {
  walk::LeftOut left;
  if (options.step_by_step || options.with_contexts) {
    return left;
  }
  const machine::MachineConfig& config = input.config;
  if (!options.keep_lookups && walk::why_lookups(config, input.layout) == nullptr) {
    input.line_set = walk::lines_of(input.layout, config.cache.cache.line);
    left.lookups = true;
  }
  // Observers need every read. Replays with a sample need the events.
  const bool plain = options.observer == nullptr && options.sample == nullptr;
  if (!options.keep_read_events && plain && walk::why_read_events(config) == nullptr) {
    input.own_reads = memory::ideal_read(config.interconnect);
    left.read_events = true;
  }
  return left;
}

// How many threads do work of nodes that wait for memory.
unsigned helpers_of(const walk::ReplayInput& input, const ReplayOptions& options) {
  const bool plain = input.observer == nullptr && input.sample == nullptr && !input.step_by_step &&
                     !input.with_contexts && node::why_not_ahead(input.config) == nullptr;
  return plain && options.threads > 1 && input.config.all_nodes() >= options.fewest_nodes_of_threads
             ? options.threads - 1
             : 0;
}

std::uint64_t pixels_of(const machine::PacketList& packets, const program::WorkLog& log,
                        const walk::PacketSample* sample) {
  if (sample == nullptr) {
    return std::uint64_t{log.width} * log.height;
  }
  std::uint64_t pixels = 0;
  for (std::uint64_t i = 0; i < packets.size(); ++i) {
    const machine::Packet packet = packets[i];
    pixels += std::uint64_t{packet.x1 - packet.x0} * (packet.y1 - packet.y0);
  }
  return pixels;
}

}  // namespace

cost::StepCounts MachineResult::steps() const {
  cost::StepCounts sum;
  for (const cost::NodeStatistics& node : nodes) {
    sim::merge(sum, node.steps);
  }
  return sum;
}

cost::ReferenceCounts MachineResult::references() const {
  cost::ReferenceCounts sum;
  for (const cost::NodeStatistics& node : nodes) {
    sum += node.references;
  }
  return sum;
}

cost::TimeSums MachineResult::time() const {
  cost::TimeSums sum{};
  for (const cost::NodeStatistics& node : nodes) {
    for (std::size_t i = 0; i < cost::activities; ++i) {
      sum[i] += node.time[i];
    }
  }
  return sum;
}

namespace {

MachineResult replay_contexts(const program::WorkLog& log, const machine::MachineConfig& config,
                              const ReplayOptions& options) {
  std::optional<walk::TreePlan> plan = plan_of(log, config, options);
  const memory::Layout layout = walk::layout_of(log, config, plan);
  sim::ensure(options.packet_seed == 0 || options.sample == nullptr, "a sample has its own order of packets");
  const machine::PacketList all_packets = packets_of(log, config, options.packet_seed);
  const machine::PacketList packets =
      options.sample == nullptr ? all_packets : all_packets.only(options.sample->chosen());
  const std::vector<std::uint32_t> rank = walk::node_ranks(log, config);
  sim::Engine engine;
  engine.reserve_for(std::size_t{config.all_nodes()} * config.contexts);
  node::Host host(config.host, packets.size(), config.all_nodes(), options.meter);
  walk::ReplayInput input = {log,
                             config,
                             layout,
                             packets,
                             rank,
                             options.step_by_step,
                             plan ? &*plan : nullptr,
                             options.report_built,
                             options.observer,
                             options.stripped,
                             options.with_contexts,
                             options.sample,
                             &all_packets};
  input.causes = options.path;
  input.visits = plan ? nullptr : options.visits;
  const walk::LeftOut left_out = leave_out(options, input);
  if (options.stripped != nullptr) {
    sim::ensure(options.stripped->fits(log) && !options.step_by_step && !options.with_contexts &&
                    options.stripped->suits(config),
                "a stripped log is walked by a machine that it was not made for");
  }
  sim::ensure(options.path == nullptr || options.observer != nullptr,
              "a critical path is recorded of exact replays that are observed");
  sim::ensure(options.intervals == nullptr ||
                  (options.observer != nullptr && options.stripped == nullptr && options.sample == nullptr),
              "intervals are of whole replays that are observed");
  if (options.observer != nullptr) {
    options.observer->begin(input);
  }
  const auto complete = [&](MachineResult& result) {
    result.host = host.statistics();
    result.packets = packets.size();
  };
  const auto check = [&](MachineResult& result) {
    result.left_out = left_out;
    result.pixels = pixels_of(packets, log, options.sample);
    check_conservation(log, config, result);
    check_bounds(config, result);
  };
  if (const auto division =
          division_of(input, options.threads, options.parts, options.fewest_nodes_of_threads)) {
    MachineResult result = replay_parts(input, host, *division, options.start_seed);
    complete(result);
    check(result);
    return result;
  }
  input.helpers = helpers_of(input, options);
  const std::unique_ptr<node::NodeArray> nodes = config.kind == machine::NodeKind::simt
                                                     ? simt::make_simt_nodes(input, engine, host)
                                                     : node::make_node_array(input, engine, host);
  const Interconnects interconnects =
      connect_memory(config, engine, static_cast<std::uint8_t>(node::EventClass::memory), *nodes,
                     options.path, options.observer);
  for (const node::EventClass c :
       {node::EventClass::step, node::EventClass::dispatch, node::EventClass::reply, node::EventClass::read,
        node::EventClass::write, node::EventClass::memory}) {
    engine.attach(static_cast<std::uint8_t>(c), *nodes);
  }
  const auto result_at = [&](sim::Ticks end) {
    MachineResult result = common_result(config, engine, *nodes, interconnects, layout, end);
    complete(result);
    return result;
  };
  IntervalSampler sampler(options.intervals, engine, *nodes, result_at);
  sampler.run(options.start_seed);
  nodes->finish();
  sampler.finish();

  if (options.observer != nullptr) {
    options.observer->end(nodes->end());
  }
  MachineResult result = result_at(nodes->end());
  result.events -= sampler.events();
  result.packet_figures = nodes->packet_figures();
  check(result);
  return result;
}

// A machine of many nodes with many contexts each has more of them than there are packets. Replays step by
// step keep them all, so that comparisons with these hold what is said of the others.
MachineResult replay_image(const program::WorkLog& log, const machine::MachineConfig& config,
                           const ReplayOptions& options) {
  const machine::MachineConfig used = without_idle_contexts(config, log.width, log.height);
  if (used.contexts == config.contexts || options.step_by_step) {
    return replay_contexts(log, config, options);
  }
  ReplayOptions with_contexts = options;
  with_contexts.with_contexts = true;
  MachineResult result = replay_contexts(log, used, with_contexts);
  const std::int64_t idle = config.contexts - used.contexts;
  if (config.host.assignment == machine::Assignment::dynamic) {
    result.host.requests += idle * config.all_nodes();
  }
  if (config.interconnect.kind == memory::InterconnectKind::ideal &&
      config.placement != machine::Placement::distributed) {
    for (ClusterResult& cluster : result.clusters) {
      cluster.interconnect.links += idle * config.nodes;  // one for each context
    }
  }
  return result;
}

MachineResult replay_scheme(const program::WorkLog& log, const machine::MachineConfig& config,
                            const ReplayOptions& options) {
  switch (config.scheme) {
    case machine::Scheme::image:
      break;
    case machine::Scheme::pipeline:
      return replay_pipeline(log, config, options);
    case machine::Scheme::space:
      return replay_space(log, config, options);
  }
  return replay_image(log, config, options);
}

}  // namespace

MachineResult replay(const program::WorkLog& log, const machine::MachineConfig& config,
                     const ReplayOptions& options) {
  machine::check(config);
  machine::check_prefetch(config.prefetch, log.traversal);
  energy::check_energy(config);
  if (options.sample != nullptr) {
    check_sampled(config);
  }
  if (config.kind == machine::NodeKind::simt && log.mailboxes) {
    throw sim::KeyError("node.kind",
                        "\"simt\" does not combine with mailboxes: lanes of many rays are in a leaf at once");
  }
  if (log.order == accel::WalkOrder::treelet_first &&
      (config.layout.node_order != memory::NodeOrder::treelets ||
       walk::treelet_records(config.layout) != log.treelet_records)) {
    throw sim::KeyError("layout.treelet",
                        "the frame was traced with treelets of at most " +
                            std::to_string(log.treelet_records) +
                            " nodes, and the machine has others; trace it again (rt.order)");
  }
  if (config.rt.stack > 0 && !accel::walks_bvh(log.traversal)) {
    throw sim::KeyError("rt.stack", "only the walk of a bvh keeps entries that wait; set it to 0");
  }
  if ((config.prefetch.stack > 0 || config.rt.stack > 0) && !log.has_entered()) {
    throw sim::KeyError(config.prefetch.stack > 0 ? "prefetch.stack" : "rt.stack",
                        "the frame was traced without noting which children rays enter, as that of a machine "
                        "with other nodes is; begin anew with node.kind = \"simt\"");
  }
  if ((config.rt.sort == machine::RaySort::direction || config.rt.sort == machine::RaySort::origin) &&
      !log.has_ray_words()) {
    throw sim::KeyError("rt.sort",
                        "the frame was traced without noting where rays begin and go; begin anew with this "
                        "rt.sort");
  }
  if (config.rt.share != machine::RtShare::none && !log.has_meets()) {
    throw sim::KeyError(
        "rt.share",
        "the frame was traced without noting what each ray meets, which only a bvh can; begin "
        "anew with this rt.share");
  }
  if (config.layout.leaf == memory::LeafLayout::inline_records && !accel::walks_bvh(log.traversal)) {
    throw sim::KeyError("layout.leaf", "\"inline\" is for a bvh; use \"list\"");
  }
  const auto complete = [&](MachineResult& result) {
    result.leaf_records = !accel::walks_bvh(log.traversal);
    work_out_energy(log, config, result);
  };
  Intervals intervals;
  ReplayOptions passed_on = options;
  if (options.intervals != nullptr) {
    intervals.length = options.intervals->length;
    intervals.counted = [&](MachineResult result) {
      complete(result);
      options.intervals->counted(result);
    };
    passed_on.intervals = &intervals;
    passed_on.step_by_step = true;  // else a node counts much of its work ahead of its time
  }
  MachineResult result = replay_scheme(log, config, passed_on);
  complete(result);
  check_records(log, config, result);
  return result;
}

const char* why_one_thread(const machine::MachineConfig& config, std::uint32_t fewest_nodes) {
  if (why_no_parts(config, fewest_nodes) == nullptr) {
    return nullptr;
  }
  const char* const why = node::why_not_ahead(config);
  return why == nullptr && config.all_nodes() < fewest_nodes ? "it has few nodes" : why;
}

void work_out_energy(const program::WorkLog& log, const machine::MachineConfig& config,
                     MachineResult& result) {
  result.energy.reset();
  if (config.energy.on()) {
    result.energy = energy::energy_of(config, energy_counts(log, config, result));
  }
}

}  // namespace marti::processors::replay
