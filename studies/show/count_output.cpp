#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "sim/mapped.h"
#include "sim/statistics.h"
#include "studies/show/json_parts.h"
#include "studies/show/result_parts.h"
#include "studies/show/text_columns.h"
#include "studies/tables/text_units.h"

namespace marti::studies::show {

namespace {

using Json = nlohmann::ordered_json;
using processors::walk::AttributionCounts;
using processors::walk::AttributionRow;

std::string_view name_of(memory::RecordKind kind) {
  return memory::record_kind_names[static_cast<std::size_t>(kind)];
}

std::string_view work_of(const AttributionRow& row) { return row.splitting ? "split" : "trace"; }

std::string percent_of(sim::Sum part, sim::Sum whole) {
  return tables::percent(whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole));
}

// Sums of the rows by what `key` makes of them.
template <class Key>
auto sums_by(const std::vector<AttributionRow>& rows, const Key& key) {
  std::map<decltype(key(rows.front())), AttributionCounts> sums;
  for (const AttributionRow& row : rows) {
    sim::merge(sums[key(row)], row.counts);
  }
  return sums;
}

void attribution_lines(std::string& text, const run::RunResult& r) {
  const std::vector<AttributionRow>& rows = *r.timed.counts.attribution;
  AttributionCounts all;
  std::vector<AttributionRow> traced;
  for (const AttributionRow& row : rows) {
    sim::merge(all, row.counts);
    if (!row.splitting) {
      traced.push_back(row);
    }
  }
  const TextColumns table = {24, {15, 15, 12, 12, 12}};
  text += "\nwhere misses and waits come from\n" +
          table.row("", {"references", "misses", "miss ratio", "of misses", "of waits"});
  const auto line = [&](const std::string& name, const AttributionCounts& counts) {
    text += table.row("  " + name,
                      {std::to_string(counts.references), std::to_string(counts.misses),
                       percent_of(counts.misses, counts.references), percent_of(counts.misses, all.misses),
                       percent_of(counts.waited(), all.waited())});
  };
  for (const auto& [level, counts] : sums_by(rows, [](const AttributionRow& row) { return row.level; })) {
    line(level == 0 ? "materials, texels" : "level " + std::to_string(level), counts);
  }
  for (const auto& [ray, counts] : sums_by(traced, [](const AttributionRow& row) { return row.ray; })) {
    line(std::string(processors::program::ray_kind_names[static_cast<std::size_t>(ray)]) + " rays", counts);
  }
  for (const auto& [bounce, counts] : sums_by(traced, [](const AttributionRow& row) { return row.bounce; })) {
    line("bounce " + std::to_string(bounce), counts);
  }
  if (traced.size() != rows.size()) {
    line("splitting branches", r.counters<AttributionCounts>("split_"));
  }
}

void class_lines(std::string& text, const run::RunResult& r) {
  const TextColumns table = {14, std::vector<int>(memory::miss_classes, 15)};
  text += "\n" + table.row("misses", {memory::miss_class_names.begin(), memory::miss_class_names.end()});
  const auto line = [&](const std::string& name) {
    const std::vector<std::string> cells =
        sim::mapped(memory::miss_class_names, [&](const std::string_view kind) {
          return std::to_string(r.count(name + "_misses_" + std::string(kind)));
        });
    const bool none = std::ranges::all_of(cells, [](const std::string& cell) { return cell == "0"; });
    text += none && name != "all" ? std::string() : table.row("  " + name, cells);
  };
  for (const std::string_view kind : memory::record_kind_names) {
    line(std::string(kind));
  }
  line("all");
}

}  // namespace

nlohmann::ordered_json counts_json(const run::RunResult& r) {
  if (!r.machine.count.any()) {
    return nullptr;
  }
  const processors::walk::CacheCountResult& counts = r.timed.counts;
  Json object = Json::object();
  if (counts.sharing) {
    object["lines_by_nodes"] = sim::mapped(counts.sharing->fetched, [](const auto& entry) {
      return Json{entry.first, entry.second};
    });
  }
  if (counts.attribution) {
    Json rows = Json::array();
    for (const AttributionRow& row : *counts.attribution) {
      Json& cell = rows.emplace_back(
          Json{{"record", name_of(row.record)},
               {"level", row.level},
               {"ray", processors::program::ray_kind_names[static_cast<std::size_t>(row.ray)]},
               {"bounce", row.bounce},
               {"work", work_of(row)}});
      add_counters(cell, row.counts);
    }
    object["attribution"] = rows;
  }
  return object;
}

std::string counts_lines(const run::RunResult& r) {
  std::string text;
  if (r.timed.counts.miss_classes) {
    class_lines(text, r);
  }
  if (r.timed.counts.sharing) {
    const std::int64_t fetches = r.count("sharing_fetches");
    const std::int64_t lines = r.count("sharing_distinct_lines");
    text += fmt::format(
        "\nsharing       {} fetches of {} lines, {} of lines fetched before; {} lines by one node only, {} "
        "by "
        "all {}\n",
        fetches, lines, percent_of(fetches - lines, fetches), r.count("sharing_lines_of_one"),
        r.count("sharing_lines_of_all"), r.machine.nodes);
  }
  if (r.timed.counts.attribution) {
    attribution_lines(text, r);
  }
  return text;
}

tables::Table attribution_table(const std::vector<AttributionRow>& rows) {
  std::vector<tables::Column> columns = {
      tables::text_column("record", "kind of record"),
      tables::count_column("level", "level of the tree node it was read for; 0 for materials and texels"),
      tables::text_column("ray", "kind of ray"),
      tables::count_column("bounce", "surface points between the eye and the ray's origin"),
      tables::text_column("work", "trace: the ray's steps; split: splitting a branch for it")};
  for (const auto& counter : AttributionCounts::counters()) {
    columns.push_back(tables::integer_column(json_name(counter), counter.unit, counter.description));
  }
  tables::Table table("attribution", "References, misses and waits by what they were for", columns);
  for (const AttributionRow& row : rows) {
    std::vector<tables::Cell> cells = {name_of(row.record), row.level,
                                       processors::program::ray_kind_names[static_cast<std::size_t>(row.ray)],
                                       row.bounce, work_of(row)};
    sim::for_each_counter(row.counts,
                          [&](const auto& /*counter*/, sim::Sum value) { cells.emplace_back(value); });
    table.add_row(std::move(cells));
  }
  return table;
}

}  // namespace marti::studies::show
