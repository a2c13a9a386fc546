#include "studies/figures/derived_figures.h"

#include <map>
#include <string>
#include <vector>

#include "processors/cost/accounting.h"
#include "sim/error.h"
#include "sim/nearest.h"

namespace marti::studies {

namespace {

Formula own(std::string_view name) { return Formula(name); }
Formula base(std::string_view name) { return Formula(name, Whose::base); }

// Times of all nodes, less those of the base, in frame times: so many nodes are lost.
Formula lost(std::initializer_list<std::string_view> more,
             std::initializer_list<std::string_view> less = {}) {
  std::optional<Formula> sum;
  const auto add = [&sum](const Formula& part) { sum = sum ? *sum + part : part; };
  for (const std::string_view time : more) {
    add(own(time) - base(time));
  }
  for (const std::string_view time : less) {
    add(base(time) - own(time));
  }
  return *sum / own("end");
}

void add_speed(std::vector<FigureEntry>& all) {
  const auto add = [&all](std::string_view name, std::string_view text, Better better,
                          const Formula& formula) {
    all.push_back({std::string(name), "1", std::string(text), Merge::ratio, better, formula});
  };
  add("speed_up", "how many times as fast as the base", Better::higher, base("end") / own("end"));
  add("efficiency", "speed-up for each time that it has the nodes of the base", Better::higher,
      base("end") * base("nodes") / (own("end") * own("nodes")));
  add("serial_fraction", "that would explain the speed-up by Amdahl's law (Karp and Flatt 1990)",
      Better::lower,
      (own("nodes") * own("end") - base("nodes") * base("end")) /
          (base("end") * (own("nodes") - base("nodes"))));
  add("times_faster", "how many times as fast as the machine that all are compared with", Better::higher,
      Formula("end", Whose::compared) / own("end"));
  add("lost_extra_misses", "nodes lost to more work: steps, and misses that meet no queue", Better::lower,
      lost({"time_traversal", "time_intersection", "time_shading", "time_cache_access", "time_transfer",
            "time_bank_access"}));
  add("lost_contention", "nodes lost to waits for interconnect and banks", Better::lower,
      lost({"time_interconnect_wait", "time_bank_wait"}));
  add("lost_imbalance", "nodes lost to waits for work, of nodes that had some", Better::lower,
      lost({"time_idle", "time_message_wait"}, {"time_without_work"}));
  add("lost_overhead", "nodes lost to building, switching, messages, locks, full queues and dispatching",
      Better::lower,
      lost({"time_building", "time_switching", "time_messaging", "time_lock_wait", "time_queue_full_wait",
            "time_dispatch_wait"}));
  add("lost_idle", "nodes that never had work", Better::lower, lost({"time_without_work"}));
}

void add_memory(std::vector<FigureEntry>& all) {
  const auto add = [&all](std::string_view name, std::string_view unit, std::string_view text, Better better,
                          const Formula& formula) {
    all.push_back({std::string(name), std::string(unit), std::string(text), Merge::ratio, better, formula});
  };
  const auto hit_ratio = [&](const std::string& name, const std::string& of, std::string_view text) {
    add(name, "1", text, Better::higher, own(of + "hits") / (own(of + "hits") + own(of + "misses")));
  };
  hit_ratio("hit_ratio", "", "of lines looked up in the first level");
  for (const std::string_view kind : memory::record_kind_names) {
    hit_ratio("hit_ratio_" + std::string(kind), std::string(kind) + "_",
              "of lines of this kind looked up in the first level");
  }
  hit_ratio("l2_hit_ratio", "l2_", "of lines looked up in the second level");
  const Formula end = own("end");
  const auto of_links = [&end](const std::string& what) {
    return own("most_" + what + "_busy") / (end * (own(what + "_links") / own("clusters")));
  };
  add("interconnect_utilisation", "1", "share of the frame time that the busiest cluster's links transfer",
      Better::lower, of_links("interconnect"));
  add("bank_utilisation", "1", "share of the frame time that the busiest bank is busy", Better::lower,
      least(Formula(1.0), own("most_bank_busy") / end));
  add("mean_bank_utilisation", "1", "share of the frame time that the banks are busy", Better::lower,
      least(Formula(1.0), own("bank_busy") / (end * own("banks"))));
  add("network_utilisation", "1", "share of the frame time that messages hold the busiest cluster's links",
      Better::lower, of_links("network"));
  add("hops_a_message", "1", "links that a message crosses", Better::lower,
      own("network_hops") / own("network_messages"));
  for (const std::string what : {"interconnect", "bank", "network"}) {
    add("mean_" + what + "_wait", "ps", "mean of the waits, those of no length included", Better::lower,
        own(what + "_wait_sum") / own(what + "_wait_count"));
  }
  add("finish_balance", "1", "mean finish of the nodes by the latest", Better::higher,
      own("node_finish") / (own("nodes") * own("latest_finish")));
  for (const std::string_view activity : processors::activity_names) {
    const bool computing = activity == "traversal" || activity == "intersection" || activity == "shading";
    add("share_" + std::string(activity), "1", "share of the nodes' time in this activity",
        computing ? Better::neither : Better::lower,
        own("time_" + std::string(activity)) / (own("nodes") * end));
  }
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
    return made;
  }();
  return figures;
}

std::optional<double> figure_of(const MeasuredCounts& counts, std::string_view name) {
  const auto count = [&counts](std::string_view figure, Whose whose) -> std::optional<double> {
    const Counts* const row = whose == Whose::own    ? counts.own
                              : whose == Whose::base ? counts.base
                                                     : counts.compared;
    const std::optional<std::int64_t> value = row == nullptr ? std::nullopt : count_of(*row, figure);
    return value ? std::optional(static_cast<double>(*value)) : std::nullopt;
  };
  const auto at = figures_by_name().find(name);
  sim::ensure(at != figures_by_name().end(), "there is no figure of this name");
  return at->second->formula ? at->second->formula->value(count) : count(name, Whose::own);
}

std::optional<double> figure_of(const processors::MachineConfig& machine,
                                const processors::MachineResult& result, std::string_view name) {
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

}  // namespace marti::studies
