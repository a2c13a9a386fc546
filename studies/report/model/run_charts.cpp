#include "studies/report/model/run_charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include "processors/cost/accounting.h"
#include "processors/energy/energy.h"
#include "studies/figures/derived_figures.h"
#include "studies/report/model/chart_library.h"
#include "studies/tables/cell_number.h"
#include "studies/tables/json_table.h"

namespace marti::studies::report {

namespace {

using Json = nlohmann::ordered_json;

// Adds counts of a file that somebody may have changed; if they overflow, add_run_charts() names the file.
std::int64_t plus(std::int64_t a, std::int64_t b) {
  std::int64_t sum = 0;
  if (__builtin_add_overflow(a, b, &sum)) {
    throw std::overflow_error("has counts that do not fit in 64 bits");
  }
  return sum;
}

std::int64_t times(std::int64_t a, std::int64_t b) {
  std::int64_t product = 0;
  if (__builtin_mul_overflow(a, b, &product)) {
    throw std::overflow_error("has counts that do not fit in 64 bits");
  }
  return product;
}

void add(ReportData& report, const tables::Table& table, const std::string& note = {}) {
  if (!table.rows().empty()) {
    report.charts.push_back(make_chart(table.name(), table, note));
  }
}

tables::Table cycles_table(const tables::RunJson& run) {
  tables::Table table("run_cycles", "Where the nodes' time goes",
                      {tables::text_column("activity", "see docs/internals/model.md, Accounting"),
                       tables::integer_column("ps", "ps", "time of all nodes"),
                       tables::real_column("share", "fraction", "of all nodes' time")});
  double all = 0.0;
  for (const std::string_view activity : processors::cost::activity_names) {
    all += run.count("figures.machine.time_" + std::string(activity));
  }
  for (const std::string_view activity : processors::cost::activity_names) {
    const tables::Cell ps = tables::cell_of(run.find("figures.machine.time_" + std::string(activity)));
    if (const double number = tables::number_of(ps).value_or(0.0); number > 0.0) {
      table.add_row({activity, ps, number / all});
    }
  }
  return table;
}

tables::Table energy_table(const tables::RunJson& run) {
  tables::Table table("run_energy", "Where the energy goes",
                      {tables::text_column("part", "see docs/internals/model.md, Energy"),
                       tables::integer_column("fj", "fJ", "energy of the frame"),
                       tables::real_column("share", "fraction", "of all energy")});
  const double all = run.count("figures.machine.energy_total");
  for (std::size_t i = 0; all > 0.0 && i < processors::energy::energy_parts; ++i) {
    const std::string part(processors::energy::EnergyResult::counters().at(i).name);
    const std::int64_t fj = whole(run, "figures.machine.energy_" + part);
    table.add_row({part, fj, static_cast<double>(fj) / all});
  }
  return table;
}

tables::Table loss_table(const tables::RunJson& run) {
  tables::Table table("run_loss", "Where the lost speed-up went",
                      {tables::text_column("part", "see docs/internals/model.md, Speed-up"),
                       tables::real_column("lost", "1", "of the ideal speed-up; below 0: won")});
  if (run.count("figures.machine.nodes") <= 1.0) {
    return table;
  }
  std::vector<double> parts;
  for (const std::string_view loss : figures::loss_names) {
    if (const std::optional<double> lost = run.number("figures.machine.lost_" + std::string(loss))) {
      parts.push_back(*lost);
    }
  }
  // A store of an older format has not all of them.
  for (std::size_t i = 0; parts.size() == figures::loss_names.size() && i < parts.size(); ++i) {
    table.add_row({figures::loss_names[i], parts[i]});
  }
  return table;
}

tables::Table references_table(const tables::RunJson& run) {
  tables::Table table("run_references", "References and hit ratio by kind of record",
                      {tables::text_column("record", "kind of record"),
                       tables::count_column("hits", "references that hit the first-level cache"),
                       tables::count_column("misses", "references that missed"),
                       tables::real_column("hit_ratio", "fraction", "hits by both")});
  for (const std::string_view kind : memory::record_kind_names) {
    const std::string prefix = "figures.machine." + std::string(kind);
    const std::int64_t hits = whole(run, prefix + "_hits");
    const std::int64_t misses = whole(run, prefix + "_misses");
    if (const std::int64_t all = plus(hits, misses); all > 0) {
      table.add_row({kind, hits, misses, static_cast<double>(hits) / static_cast<double>(all)});
    }
  }
  return table;
}

// A size of the run's own configuration; 0, and the chart leaves it out, where it has none.
std::int64_t size_of(const tables::RunJson& run, const std::string& key) {
  const tables::RunJson keys = run.part("config.keys");
  const auto setting = keys.json().find(key);
  return setting == keys.json().end() ? 0 : std::max<std::int64_t>(0, whole(keys.of(*setting), "value"));
}

tables::Table tree_table(const tables::RunJson& run) {
  tables::Table table(
      "run_tree", "The tree by level",
      {tables::count_column("level", "from 1, the root"), tables::count_column("branches", "branches"),
       tables::count_column("leaves", "leaves, empty ones included"),
       tables::count_column("empty_leaves", "leaves without objects"),
       tables::count_column("entries", "object references")});
  std::int64_t level = 0;
  for (const tables::RunJson& each : run.list("structure.levels")) {
    table.add_row({++level, whole(each, "branches"), whole(each, "leaves"), whole(each, "empty_leaves"),
                   whole(each, "entries")});
  }
  return table;
}

tables::Table level_memory_table(const tables::RunJson& run) {
  tables::Table table("run_level_memory", "Memory by level of the tree",
                      {tables::count_column("level", "from 1, the root"),
                       tables::integer_column("node_bytes", "byte", "node records"),
                       tables::integer_column("list_bytes", "byte", "object lists")});
  const std::int64_t node = size_of(run, "layout.node");
  const std::int64_t entry = size_of(run, "layout.entry");
  std::int64_t level = 0;
  for (const tables::RunJson& each : run.list("structure.levels")) {
    table.add_row({++level, times(node, plus(whole(each, "branches"), whole(each, "leaves"))),
                   times(entry, whole(each, "entries"))});
  }
  return table;
}

// Records by their sizes; what alignment adds is the rest.
tables::Table memory_table(const tables::RunJson& run) {
  tables::Table table(
      "run_memory", "Memory by kind of record",
      {tables::text_column("record", "kind of record"), tables::count_column("records", "how many"),
       tables::integer_column("bytes", "byte", "records by their size, without alignment")});
  const std::int64_t quadrics =
      plus(plus(whole(run, "figures.frame.spheres"), whole(run, "figures.frame.cylinders")),
           whole(run, "figures.frame.cones"));
  const std::tuple<const char*, const char*, std::int64_t> kinds[] = {
      {"nodes", "layout.node", whole(run, "figures.frame.structure_nodes")},
      {"list entries", "layout.entry", whole(run, "figures.frame.structure_entries")},
      {"triangles", "layout.primitive", whole(run, "figures.frame.triangles")},
      {"spheres, cylinders, cones", "layout.quadric", quadrics},
      {"materials", "layout.material", whole(run, "figures.frame.materials")}};
  for (const auto& [name, key, count] : kinds) {
    if (count > 0 && size_of(run, key) > 0) {
      table.add_row({name, count, times(count, size_of(run, key))});
    }
  }
  return table;
}

tables::Table visits_table(const tables::RunJson& run) {
  tables::Table table("run_visits", "Visits by level of the tree",
                      {tables::count_column("level", "from 1, the root"),
                       tables::count_column("visits", "visits of rays to nodes of this level")});
  std::int64_t level = 0;
  for (const tables::RunJson& each : run.list("machine.build.levels")) {
    table.add_row({++level, whole(each, "visits")});
  }
  return table;
}

tables::Table path_table(const tables::RunJson& run) {
  tables::Table table(
      "run_path", "The critical path",
      {tables::text_column("what", "what is done, see docs/internals/model.md, The critical path"),
       tables::integer_column("ps", "ps", "time of it on the path"),
       tables::real_column("share", "fraction", "of the frame time")});
  const tables::RunJson parts = run.part("machine.critical_path.time_ps");
  if (!parts.json().is_object()) {
    return table;
  }
  double all = 0.0;
  for (const auto& [name, value] : parts.json().items()) {
    all += parts.count(name);
  }
  for (const auto& [name, value] : parts.json().items()) {
    if (const std::int64_t ps = whole(parts, name); ps > 0) {
      table.add_row({name, ps, static_cast<double>(ps) / all});
    }
  }
  return table;
}

struct LevelReferences {
  std::int64_t references = 0;
  std::int64_t misses = 0;
};

void add_levels(const tables::RunJson& run, ReportData& report) {
  std::map<std::pair<std::int64_t, std::string>, LevelReferences> levels;
  for (const tables::RunJson& each : run.list("machine.counts.attribution")) {
    if (const std::int64_t level = whole(each, "level"); level > 0) {
      LevelReferences& sum = levels[{level, each.text("record")}];
      sum.references = plus(sum.references, whole(each, "references"));
      sum.misses = plus(sum.misses, whole(each, "misses"));
    }
  }
  tables::Table accesses(
      "run_level_accesses", "Accesses by level of the tree",
      {tables::count_column("level", "from 1, the root"), tables::text_column("record", "kind of record"),
       tables::count_column("references", "references of the first level of caches"),
       tables::count_column("misses", "of these, misses")});
  tables::Table ratios(
      "run_level_hit_ratio", "Hit ratio by level of the tree",
      {tables::count_column("level", "from 1, the root"), tables::text_column("record", "kind of record"),
       tables::real_column("hit_ratio", "fraction", "hits by references")});
  for (const auto& [place, sum] : levels) {
    accesses.add_row({place.first, place.second, sum.references, sum.misses});
    if (sum.references > 0) {
      ratios.add_row({place.first, place.second,
                      1.0 - static_cast<double>(sum.misses) / static_cast<double>(sum.references)});
    }
  }
  add(report, accesses);
  add(report, ratios, "Of the references to this level's records and lists.");
}

using Histogram = std::map<std::int64_t, std::int64_t>;  // highest of a bucket, count

void add_histogram(const tables::RunJson& waits, Histogram& histogram) {
  const Json& buckets = waits.find("histogram_ps");
  if (!buckets.is_array()) {
    return;
  }
  for (const Json& bucket : buckets) {
    if (bucket.is_array() && bucket.size() == 3 && bucket[1].is_number_integer() &&
        bucket[2].is_number_integer()) {
      std::int64_t& count = histogram[bucket[1].get<std::int64_t>()];
      count = plus(count, bucket[2].get<std::int64_t>());
    }
  }
}

tables::Table waits_table(const tables::RunJson& run) {
  tables::Table table("run_waits", "Waits",
                      {tables::text_column("what", "what is waited for"),
                       tables::integer_column("highest_ps", "ps", "upper end of a bucket"),
                       tables::count_column("count", "waits in it"),
                       tables::real_column("share", "fraction", "of the waits that are not longer")});
  std::map<std::string, Histogram> histograms;
  for (const tables::RunJson& cluster : run.list("machine.per_cluster")) {
    add_histogram({cluster.find("interconnect.waits"), run.file()}, histograms["interconnect"]);
    add_histogram({cluster.find("distributed.network.waits"), run.file()}, histograms["network"]);
    for (const tables::RunJson& bank : cluster.list("banks")) {
      add_histogram({bank.find("waits"), run.file()}, histograms["bank"]);
    }
  }
  for (const char* what : {"interconnect", "bank", "network"}) {
    double all = 0.0;
    for (const auto& [highest, count] : histograms[what]) {
      all += static_cast<double>(count);
    }
    double below = 0.0;
    for (const auto& [highest, count] : histograms[what]) {
      below += static_cast<double>(count);
      table.add_row({what, highest, count, all > 0.0 ? below / all : 0.0});
    }
  }
  return table;
}

using processors::cost::ActivityKind;

tables::Table nodes_table(const tables::RunJson& run) {
  tables::Table table(
      "run_nodes", "What each node does",
      {tables::count_column("node", "its number"),
       tables::real_column("compute", "fraction", "of the frame: computing, cache accesses, messages"),
       tables::real_column("memory", "fraction", "transfers and bank accesses without queues"),
       tables::real_column("waits", "fraction", "waiting for anything"),
       tables::real_column("idle", "fraction", "nothing left to do")});
  const double end = run.count("figures.machine.end");
  std::int64_t number = 0;
  for (const tables::RunJson& node : run.list("machine.per_node")) {
    const auto share = [&](std::initializer_list<ActivityKind> kinds) {
      const double sum = processors::cost::sum_of_kinds(kinds, [&](std::size_t i) {
        return node.count("time_ps." + std::string(processors::cost::activity_names[i]));
      });
      return end > 0.0 ? sum / end : 0.0;
    };
    table.add_row({number++, share({ActivityKind::computing}), share({ActivityKind::memory}),
                   share({ActivityKind::queueing, ActivityKind::delay}), share({ActivityKind::idle})});
  }
  return table;
}

// Of many nodes: groups of neighbours, with the mean, the least and the most of each part.
tables::Table envelope_of(const tables::Table& nodes, std::size_t groups) {
  tables::Table table(
      nodes.name(), nodes.title(),
      {tables::count_column("node", "first of the group"), tables::count_column("last", "last of the group"),
       tables::text_column("what", "part of the frame"),
       tables::real_column("mean", "fraction", "of the group's nodes"),
       tables::real_column("least", "fraction", "of any of them"),
       tables::real_column("most", "fraction", "of any of them")});
  const std::size_t count = nodes.rows().size();
  for (const tables::Column& column : nodes.columns().subspan(1)) {
    for (std::size_t group = 0; group < groups; ++group) {
      const std::size_t first = group * count / groups;
      const std::size_t end = (group + 1) * count / groups;
      double sum = 0.0;
      double least = std::get<double>(nodes.at(first, column.name));
      double most = least;
      for (std::size_t node = first; node < end; ++node) {
        const double share = std::get<double>(nodes.at(node, column.name));
        sum += share;
        least = std::min(least, share);
        most = std::max(most, share);
      }
      // Rounding must not put the mean beside what it is the mean of.
      const double mean = std::clamp(sum / static_cast<double>(end - first), least, most);
      table.add_row({first, end - 1, column.name, mean, least, most});
    }
  }
  return table;
}

// More bars than this are narrower than a reader can tell apart.
constexpr std::size_t most_bars = 64;

void add_nodes(const tables::Table& nodes, ReportData& report) {
  if (nodes.rows().size() <= most_bars) {
    add(report, nodes, "Uneven bars are imbalance.");
    return;
  }
  report.charts.push_back(
      make_chart("run_nodes_envelope", envelope_of(nodes, most_bars),
                 fmt::format("{} nodes in {} groups of neighbours: the line is the mean of a group, the area "
                             "reaches from the least to the most of its nodes.",
                             nodes.rows().size(), most_bars)));
}

void add_all(const tables::RunJson& run, ReportData& report) {
  add(report, cycles_table(run), "All nodes' time from 0 to the end of the frame, without remainder.");
  add(report, loss_table(run),
      "The parts add up to the number of nodes less the speed-up times the nodes of the base.");
  add(report, energy_table(run), "The parts add up to the energy of the frame.");
  add_nodes(nodes_table(run), report);
  add(report, references_table(run));
  add_levels(run, report);
  add(report, visits_table(run));
  add(report, waits_table(run), "How many of the waits are not longer than this.");
  add(report, tree_table(run));
  add(report, level_memory_table(run));
  add(report, memory_table(run));
  add(report, path_table(run),
      "The chain of work that sets the end of the frame; the parts add up to the frame.");
}

}  // namespace

std::int64_t whole(const tables::RunJson& part, std::string_view path) {
  const Json& value = part.find(path);
  return value.is_number_integer() && !(value.is_number_unsigned() && value.get<std::uint64_t>() > INT64_MAX)
             ? std::max<std::int64_t>(value.get<std::int64_t>(), 0)
             : 0;
}

void add_run_charts(const tables::RunJson& run, ReportData& report) {
  try {
    add_all(run, report);
  } catch (const std::overflow_error& error) {
    run.refuse(error.what());
  }
}

}  // namespace marti::studies::report
