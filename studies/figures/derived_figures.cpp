#include "studies/figures/derived_figures.h"

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "processors/cost/accounting.h"
#include "sim/error.h"
#include "sim/nearest.h"

namespace marti::studies::figures {

namespace {

Formula own(std::string_view name) { return Formula(name); }
Formula base(std::string_view name) { return Formula(name, Whose::base); }

// What figures call the kinds of ray.
constexpr std::array<std::string_view, processors::program::ray_kinds> ray_figures = {
    "camera", "shadow", "reflection", "refraction", "diffuse"};
std::string rays_of(std::string_view kind) { return "steps_" + std::string(kind) + "_rays"; }

Formula all_rays() {
  Formula sum = own(rays_of(ray_figures[0]));
  for (std::size_t kind = 1; kind < ray_figures.size(); ++kind) {
    sum = sum + own(rays_of(ray_figures.at(kind)));
  }
  return sum.named("all_rays");
}

// Adds figures to a list.
class Ratios {
 public:
  explicit Ratios(std::vector<FigureEntry>& all) : all_(all) {}
  void operator()(std::string_view name, std::string_view unit, std::string_view text, Better better,
                  const Formula& formula) const {
    all_.push_back({std::string(name), std::string(unit), std::string(text), Merge::ratio, better, formula});
  }

 private:
  std::vector<FigureEntry>& all_;
};

// Which part of the lost speed-up an activity belongs to: its place in loss_names.
std::size_t loss_of(processors::cost::Activity activity) {
  using processors::cost::Activity;
  switch (activity) {
    case Activity::traversal:
    case Activity::intersection:
    case Activity::shading:
    case Activity::cache_access:
    case Activity::transfer:
    case Activity::bank_access:
      return 0;
    case Activity::interconnect_wait:
    case Activity::bank_wait:
      return 1;
    case Activity::message_wait:
    case Activity::idle:
      return 2;
    case Activity::building:
    case Activity::switching:
    case Activity::messaging:
    case Activity::lock_wait:
    case Activity::queue_full_wait:
    case Activity::dispatch_wait:
      break;
  }
  return 3;
}

// The time that all nodes spend on this part more than the base, in frame times. The time of nodes without
// work is no imbalance but a part of its own, the last one.
Formula lost(std::size_t loss) {
  const Formula idle_nodes =
      (own("time_without_work") - base("time_without_work")).named("more_time_without_work");
  std::optional<Formula> sum;
  for (std::size_t i = 0; i < processors::cost::activities; ++i) {
    if (loss_of(static_cast<processors::cost::Activity>(i)) == loss) {
      const std::string time = "time_" + std::string(processors::cost::activity_names[i]);
      const Formula more = (own(time) - base(time)).named("more_" + time);
      sum = sum ? *sum + more : more;
    }
  }
  return (!sum ? idle_nodes : loss == 2 ? *sum - idle_nodes : *sum) / own("end");
}

void add_speed(std::vector<FigureEntry>& all) {
  const auto add = [&all](const std::string& name, const std::string& text, Better better,
                          const Formula& formula, const std::string& unit = "1") {
    all.push_back({name, unit, text, Merge::ratio, better, formula});
  };
  add("speed_up", "how many times as fast as the base", Better::higher, base("end") / own("end"));
  add("efficiency", "speed-up, divided by how many times the base's nodes it has", Better::higher,
      base("end") * base("nodes") / (own("end") * own("nodes")), "fraction");
  add("serial_fraction", "that would explain the speed-up by Amdahl's law (Karp and Flatt 1990)",
      Better::lower,
      (own("nodes") * own("end") - base("nodes") * base("end")) /
          (base("end") * (own("nodes") - base("nodes"))));
  add("times_faster", "how many times as fast as the machine that all are compared with", Better::higher,
      Formula("end", Whose::compared) / own("end"));
  add("saturation", "nodes of a cluster from which on its busiest queue is full", Better::higher,
      own("queue_round") / (own("clusters") * own("busiest_queue")));
  constexpr std::array<std::string_view, loss_names.size()> lost_to = {
      "more work: steps, and misses that meet no queue", "waits for interconnect and banks",
      "waits for work, of nodes that had some",
      "building, switching, messages, locks, full queues and dispatching",
      "a lack of packets or rays: of nodes that never had work"};
  for (std::size_t i = 0; i < loss_names.size(); ++i) {
    add("lost_" + std::string(loss_names[i]), "nodes lost to " + std::string(lost_to.at(i)), Better::lower,
        lost(i));
  }
}

// The steps of the work log, as its totals count them.
Formula all_steps() {
  Formula sum = all_rays();
  for (const std::string_view step : {"branches", "transforms", "leaves", "tests", "shades", "lights",
                                      "texels", "cuts", "passes", "any_hits"}) {
    sum = sum + own("steps_" + std::string(step));
  }
  return sum.named("all_steps");
}

// What the time of links and data buses is spent on, each as a share of the whole. Data take whole beats, of
// which bytes may fill a part only.
void add_shares(std::vector<FigureEntry>& all) {
  const Ratios add_ratio(all);
  const auto add = [&](std::string_view name, std::string_view text, Better better, const Formula& part,
                       const Formula& whole) { add_ratio(name, "fraction", text, better, part / whole); };
  const Formula links = own("interconnect_busy") + own("interconnect_no_request");
  add("interconnect_share_data", "share of the links' time in which they move data, in whole beats",
      Better::higher, own("interconnect_data"), links);
  add("interconnect_share_address", "share in which a bus sends addresses", Better::lower,
      own("interconnect_busy") - own("interconnect_data") - own("interconnect_held"), links);
  add("interconnect_share_held",
      "share in which a held bus waits for its bank, or a network's bus for its latency", Better::lower,
      own("interconnect_held"), links);
  add("interconnect_share_no_request", "share in which nobody asks for them", Better::neither,
      own("interconnect_no_request"), links);
  const Formula network = own("network_busy") + own("network_no_request");
  add("network_share_data", "share of the links' time in which they move bytes, in whole beats",
      Better::higher, own("network_data"), network);
  add("network_share_latency", "share in which a network's bus waits for its latency", Better::lower,
      own("network_busy") - own("network_data"), network);
  add("network_share_no_request", "share in which they have no message", Better::neither,
      own("network_no_request"), network);
  const Formula buses = own("end") * own("dram_data_buses");
  add("dram_share_data", "share of the data buses' time in which they move data: of their peak",
      Better::higher, own("dram_data_busy"), buses);
  add("dram_share_rows", "share in which they wait for rows to be closed and opened", Better::lower,
      own("dram_bus_rows"), buses);
  add("dram_share_refresh", "share in which they wait for a refresh", Better::lower, own("dram_bus_refresh"),
      buses);
  add("dram_share_turn", "share in which they turn between reads and writes, ranks and bank groups",
      Better::lower, own("dram_bus_turn"), buses);
  add("dram_share_no_request", "share in which they have no request", Better::neither,
      own("dram_bus_no_request"), buses);
}

void add_memory(std::vector<FigureEntry>& all) {
  const Ratios add(all);
  const auto hit_ratio = [&](const std::string& name, const std::string& of, std::string_view text) {
    add(name, "fraction", text, Better::higher, own(of + "hits") / (own(of + "hits") + own(of + "misses")));
  };
  hit_ratio("hit_ratio", "", "of lines looked up in the first level");
  for (const std::string_view kind : memory::record_kind_names) {
    hit_ratio("hit_ratio_" + std::string(kind), std::string(kind) + "_",
              "of lines of this kind looked up in the first level");
  }
  hit_ratio("l2_hit_ratio", "l2_", "of lines looked up in the second level");
  const Formula thousand_steps = all_steps() / Formula(1000.0);
  add("misses_a_thousand_steps", "1", "of the first level, for a thousand steps of all nodes", Better::lower,
      own("misses") / thousand_steps);
  for (const std::string_view name : memory::record_kind_names) {
    const std::string kind(name);
    add("misses_a_thousand_steps_" + kind, "1", "those of lines of this kind", Better::lower,
        own(kind + "_misses") / thousand_steps);
  }
  add("l2_misses_a_thousand_steps", "1", "of the second level, for a thousand steps of all nodes",
      Better::lower, own("l2_misses") / thousand_steps);
  const Formula useful = own("contexts_useful");
  add("prefetch_accuracy", "fraction", "of the lines prefetched, those that were of use", Better::higher,
      useful / own("contexts_issued"));
  add("prefetch_lateness", "fraction", "of the prefetched lines of use, those that were still under way",
      Better::lower, own("contexts_late") / useful);
  add("prefetch_coverage", "fraction",
      "of the lines that would have missed but for prefetching, those that it had brought", Better::higher,
      useful / (useful + own("misses")));
  const Formula end = own("end");
  const auto of_links = [&end](const std::string& what) {
    return own("most_" + what + "_busy") / (end * (own(what + "_links") / own("clusters")));
  };
  add("interconnect_utilisation", "fraction",
      "share of the frame time that the busiest cluster's links transfer", Better::lower,
      of_links("interconnect"));
  add("bank_utilisation", "fraction", "share of the frame time that the busiest bank is busy", Better::lower,
      least(Formula(1.0), own("most_bank_busy") / end));
  add("mean_bank_utilisation", "fraction", "share of the frame time that the banks are busy", Better::lower,
      least(Formula(1.0), own("bank_busy") / (end * own("banks"))));
  const Formula bursts = own("dram_row_hits") + own("dram_row_misses") + own("dram_row_conflicts");
  add("dram_row_hit_ratio", "fraction", "of the bursts of DRAM, those that found their row open",
      Better::higher, own("dram_row_hits") / bursts);
  add("dram_row_conflict_ratio", "fraction", "of the bursts of DRAM, those that found another row open",
      Better::lower, own("dram_row_conflicts") / bursts);
  const Formula channel_time = end * own("banks");
  add("dram_refresh_share", "fraction",
      "share of the frame time for which a channel's oldest access waits for a refresh", Better::lower,
      own("dram_refresh_stall") / channel_time);
  add("dram_queue_length", "1", "mean number of accesses of a channel that have not got their data commands",
      Better::lower, own("dram_queued") / channel_time);
  add("dram_bandwidth", "byte/s", "data that DRAM moves, in whole bursts", Better::higher,
      own("dram_bytes") * Formula(1e12) / end);
  add("interconnect_bandwidth", "byte/s", "data that nodes and memory exchange", Better::higher,
      own("interconnect_bytes") * Formula(1e12) / end);
  add("network_bandwidth", "byte/s", "bytes of messages over all links that they cross", Better::higher,
      own("network_link_bytes") * Formula(1e12) / end);
  add_shares(all);
  add("network_utilisation", "fraction",
      "share of the frame time that messages hold the busiest cluster's links", Better::lower,
      of_links("network"));
  add("hops_a_message", "1", "links that a message crosses", Better::lower,
      own("network_hops") / own("network_messages"));
  // The lanes that have something to do, of all ten states.
  Formula with_work = own("simt_lanes_shading");
  for (const std::string state : {"slot", "unit", "scheduler", "cache", "memory", "box", "primitive"}) {
    with_work = with_work + own("simt_lanes_" + state);
  }
  add("simt_efficiency", "fraction",
      "SIMT nodes: of the cycles of lanes of warps with a packet, those in which a lane is neither held by "
      "its "
      "warp nor without a pixel",
      Better::higher, with_work / (with_work + own("simt_lanes_held") + own("simt_lanes_empty")));
  add("simt_lanes_an_access", "1", "SIMT nodes: lanes that share an access to a record", Better::higher,
      own("simt_records") / own("simt_accesses"));
  add("simt_lanes_filled", "1", "SIMT nodes: lanes with a ray of a warp that was formed by sorting (rt.sort)",
      Better::higher, own("simt_sorted_rays") / own("simt_sorted_warps"));
  add("simt_mean_lines", "1", "SIMT nodes: mean number of lines that a node has under way", Better::neither,
      own("simt_line_cycles") / own("simt_cycles"));
  add("simt_mean_warps", "1", "SIMT nodes: mean number of warps in a ray-tracing unit", Better::neither,
      own("simt_unit_cycles") / own("simt_cycles"));
  add("simt_full_share", "fraction",
      "SIMT nodes: of the cycles, those in which a look-up found no register for its line", Better::lower,
      own("simt_full_cycles") / own("simt_cycles"));
  add("simt_ray_latency", "cycle", "SIMT nodes: mean cycles from a ray's wish to be traced to its end",
      Better::lower, own("simt_ray_cycles") / own("simt_rays"));
  for (const std::string what : {"interconnect", "bank", "network"}) {
    add("mean_" + what + "_wait", "ps", "mean of the waits, those of no length included", Better::lower,
        own(what + "_wait_sum") / own(what + "_wait_count"));
  }
  add("messages_a_ray", "1", "where rays move: messages for each camera ray and ray made", Better::lower,
      own("network_messages") / own("flow_rays"));
  add("message_bytes_a_ray", "byte", "where rays move: bytes of messages for each of these rays",
      Better::lower, own("network_bytes") / own("flow_rays"));
  add("mean_queue_wait", "ps", "where rays move: mean time that a ray waits in a queue", Better::lower,
      own("flow_queued") / own("flow_taken"));
  add("mean_node_memory", "byte", "the database in a node's own memory, mean of the nodes", Better::lower,
      own("flow_memory") / own("nodes"));
  add("finish_balance", "fraction", "mean finish of the nodes by the latest", Better::higher,
      own("node_finish") / (own("nodes") * own("latest_finish")));
  for (const std::string_view activity : processors::cost::activity_names) {
    add("share_" + std::string(activity), "fraction",
        "share of the nodes' time in this activity (model.md, Accounting)", Better::lower,
        own("time_" + std::string(activity)) / (own("nodes") * end));
  }
}

void add_rays(std::vector<FigureEntry>& all) {
  const Ratios add(all);
  const auto a_second = [](const Formula& rays) { return rays * Formula(1e12) / own("end"); };
  add("rays_a_second", "1/s", "rays of all kinds traced in a second", Better::higher, a_second(all_rays()));
  for (const std::string_view kind : ray_figures) {
    add("rays_a_second_" + std::string(kind), "1/s", "those of this kind", Better::higher,
        a_second(own(rays_of(kind))));
  }
  add("visits_a_ray", "1", "branches, instances, leaves and nodes taken as one voxel that a ray visits, mean",
      Better::lower,
      (own("steps_branches") + own("steps_transforms") + own("steps_leaves") + own("steps_cuts")) /
          all_rays());
  add("memory_bytes_a_ray", "byte", "read from memory for a ray, by whole lines", Better::lower,
      own("memory_bytes_read") / all_rays());
}

// Units: 1 mJ is 1e12 fJ, 1 s is 1e12 ps, hence 1 W is 1e3 fJ a ps.
void add_energy(std::vector<FigureEntry>& all) {
  const Ratios add(all);
  const Formula total = own("energy_total");
  const Formula energy = total / Formula(1e12);
  const Formula rays = all_rays();
  add("energy", "mJ", "energy of the frame, where [energy] is on", Better::lower, energy);
  add("power", "W", "mean power: energy by frame time", Better::lower,
      total / (own("end") * Formula(1000.0)));
  add("rays_a_joule", "1", "rays of all kinds for a joule", Better::higher, rays / (total / Formula(1e15)));
  add("energy_a_ray", "nJ", "energy by rays of all kinds", Better::lower, total / Formula(1e6) / rays);
  add("energy_delay", "uJ s", "energy times frame time", Better::lower,
      total / Formula(1e9) * (own("end") / Formula(1e12)));
  add("area", "mm2", "area of nodes, caches and ray-tracing units", Better::lower,
      own("energy_area") / Formula(1e6));
  add("rays_a_second_mm2", "1/s", "rays of all kinds in a second, by area", Better::higher,
      rays * Formula(1e12) / own("end") / (own("energy_area") / Formula(1e6)));
}

const std::map<std::string, const FigureEntry*, std::less<>>& figures_by_name() {
  static const std::map<std::string, const FigureEntry*, std::less<>> all = [] {
    std::map<std::string, const FigureEntry*, std::less<>> made;
    for (const auto& entries : {counted_figures(), derived_figures()}) {
      for (const FigureEntry& entry : entries) {
        sim::ensure(made.emplace(entry.name, &entry).second, "two figures have one name");
      }
    }
    return made;
  }();
  return all;
}

}  // namespace

std::span<const FigureEntry> derived_figures() {
  static const std::vector<FigureEntry> figures = [] {
    std::vector<FigureEntry> made;
    add_speed(made);
    add_memory(made);
    add_rays(made);
    add_energy(made);
    return made;
  }();
  return figures;
}

std::string loss_text(std::string_view loss) {
  // The activity "idle" is another figure: it has the time of all nodes that wait for the last one, too.
  std::string text(loss == "idle" ? "no work at all" : loss);
  std::ranges::replace(text, '_', ' ');
  return text;
}

std::string_view gain_of(std::string_view loss) {
  if (loss == "extra_misses") {
    return "less time for hits and misses, as where all caches together hold more than one";
  }
  if (loss == "contention") {
    return "shorter waits for interconnect and banks";
  }
  return loss == "overhead" ? "shorter waits for packets and for full queues, or fewer switches of contexts"
                            : "shorter waits for work";
}

std::optional<double> figure_of(const MeasuredCounts& counts, std::string_view name) {
  const auto count = [&counts](std::string_view figure, Whose whose) -> std::optional<double> {
    const Counts* const row = whose == Whose::own    ? counts.own
                              : whose == Whose::base ? counts.base
                                                     : counts.compared;
    const std::optional<Count> value = row == nullptr ? std::nullopt : count_of(*row, figure);
    return value ? std::optional(static_cast<double>(*value)) : std::nullopt;
  };
  const auto at = figures_by_name().find(name);
  sim::ensure(at != figures_by_name().end(), "there is no figure of this name");
  return at->second->formula ? at->second->formula->value(count) : count(name, Whose::own);
}

std::optional<double> figure_of(const processors::machine::MachineConfig& machine,
                                const processors::replay::MachineResult& result, std::string_view name) {
  const Counts counts = counts_of(machine, result);
  return figure_of({&counts}, name);
}

const FigureEntry& figure_named(std::string_view name) {
  const auto at = figures_by_name().find(name);
  if (at == figures_by_name().end()) {
    std::vector<std::string> names;
    for (const auto& [known, entry] : figures_by_name()) {
      names.push_back(known);
    }
    throw sim::UserError("\"" + std::string(name) + "\" is no figure" + sim::did_you_mean(name, names) +
                         "; `marti figures` lists them");
  }
  return *at->second;
}

void require_direction(std::string_view name, std::string_view place) {
  const Better better = figure_named(name).better;
  if (better != Better::lower && better != Better::higher) {
    throw sim::UserError(
        std::string(place) + "of " + std::string(name) +
        " neither a lower nor a higher value is better; `marti figures` says of which it is");
  }
}

}  // namespace marti::studies::figures
