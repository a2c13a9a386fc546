#include "studies/show/count_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>

#include "sim/statistics.h"
#include "studies/show/json_parts.h"

namespace marti::studies {

namespace {

using Json = nlohmann::ordered_json;
using processors::AttributionCounts;
using processors::AttributionRow;
using processors::CacheCountResult;

std::string_view name_of(memory::RecordKind kind) {
  return memory::record_kind_names[static_cast<std::size_t>(kind)];
}

std::string_view work_of(const AttributionRow& row) { return row.splitting ? "split" : "trace"; }

CacheCountResult::ByClass all_classes(const CacheCountResult& counts) {
  CacheCountResult::ByClass sum{};
  for (const CacheCountResult::ByClass& kind : *counts.miss_classes) {
    for (std::size_t i = 0; i < sum.size(); ++i) {
      sum[i] += kind[i];
    }
  }
  return sum;
}

double percent(std::int64_t part, std::int64_t whole) {
  return 100.0 * sim::ratio(part, whole).value_or(0.0);
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

void attribution_lines(std::string& text, const std::vector<AttributionRow>& rows) {
  const auto out = std::back_inserter(text);
  AttributionCounts all;
  for (const AttributionRow& row : rows) {
    sim::merge(all, row.counts);
  }
  fmt::format_to(out, "\nwhere misses and waits come from\n  {:<22}{:>15}{:>15}{:>12}{:>12}{:>12}\n", "",
                 "references", "misses", "miss ratio", "of misses", "of waits");
  const auto line = [&](const std::string& name, const AttributionCounts& counts) {
    fmt::format_to(out, "  {:<22}{:>15}{:>15}{:>10.2f} %{:>10.2f} %{:>10.2f} %\n", name, counts.references,
                   counts.misses, percent(counts.misses, counts.references),
                   percent(counts.misses, all.misses), percent(counts.waited(), all.waited()));
  };
  for (const auto& [level, counts] : sums_by(rows, [](const AttributionRow& row) { return row.level; })) {
    line(level == 0 ? "materials, texels" : "level " + std::to_string(level), counts);
  }
  std::vector<AttributionRow> traced;
  AttributionCounts splitting;
  for (const AttributionRow& row : rows) {
    if (row.splitting) {
      sim::merge(splitting, row.counts);
    } else {
      traced.push_back(row);
    }
  }
  for (const auto& [ray, counts] : sums_by(traced, [](const AttributionRow& row) { return row.ray; })) {
    line(std::string(processors::ray_kind_names[static_cast<std::size_t>(ray)]) + " rays", counts);
  }
  for (const auto& [bounce, counts] : sums_by(traced, [](const AttributionRow& row) { return row.bounce; })) {
    line("bounce " + std::to_string(bounce), counts);
  }
  if (traced.size() != rows.size()) {
    line("splitting branches", splitting);
  }
}

}  // namespace

nlohmann::ordered_json counts_json(const CacheCountResult& counts) {
  Json object = Json::object();
  if (counts.sharing) {
    Json fetched = Json::array();
    for (const auto& [nodes, lines] : counts.sharing->fetched) {
      fetched.push_back({nodes, lines});
    }
    object["lines_by_nodes"] = fetched;
  }
  if (counts.attribution) {
    Json rows = Json::array();
    for (const AttributionRow& row : *counts.attribution) {
      Json& cell =
          rows.emplace_back(Json{{"record", name_of(row.record)},
                                 {"level", row.level},
                                 {"ray", processors::ray_kind_names[static_cast<std::size_t>(row.ray)]},
                                 {"bounce", row.bounce},
                                 {"work", work_of(row)}});
      add_counters(cell, row.counts);
    }
    object["attribution"] = rows;
  }
  return object;
}

std::string counts_lines(const processors::MachineConfig& machine, const CacheCountResult& counts) {
  std::string text;
  const auto out = std::back_inserter(text);
  if (counts.miss_classes) {
    fmt::format_to(out, "\nmisses        {:>15}{:>15}{:>15}{:>15}\n", memory::miss_class_names[0],
                   memory::miss_class_names[1], memory::miss_class_names[2], memory::miss_class_names[3]);
    const auto line = [&](std::string_view name, const CacheCountResult::ByClass& classes) {
      fmt::format_to(out, "  {:<12}{:>15}{:>15}{:>15}{:>15}\n", name, classes[0], classes[1], classes[2],
                     classes[3]);
    };
    for (std::size_t kind = 0; kind < memory::record_kinds; ++kind) {
      const CacheCountResult::ByClass& classes = (*counts.miss_classes)[kind];
      if (std::any_of(classes.begin(), classes.end(), [](std::int64_t count) { return count != 0; })) {
        line(memory::record_kind_names[kind], classes);
      }
    }
    line("all", all_classes(counts));
  }
  if (counts.sharing) {
    const memory::SharingResult& sharing = *counts.sharing;
    fmt::format_to(out,
                   "\nsharing       {} fetches of {} lines, {:.2f} % of lines fetched before; "
                   "{} lines by one node only, {} by all {}\n",
                   sharing.fetches, sharing.distinct, percent(sharing.duplicates(), sharing.fetches),
                   sharing.by(1), sharing.by(machine.nodes), machine.nodes);
  }
  if (counts.attribution) {
    attribution_lines(text, *counts.attribution);
  }
  return text;
}

Table attribution_table(const std::vector<AttributionRow>& rows) {
  std::vector<Column> columns = {
      {"record", ColumnType::text, "", "kind of record"},
      {"level", ColumnType::integer, "1",
       "level of the tree node it was read for; 0 for materials and texels"},
      {"ray", ColumnType::text, "", "kind of ray"},
      {"bounce", ColumnType::integer, "1", "surface points between the eye and the ray's origin"},
      {"work", ColumnType::text, "", "trace: the ray's steps; split: splitting a branch for it"}};
  for (const auto& counter : AttributionCounts::counters()) {
    columns.push_back({json_name(counter), ColumnType::integer, std::string(counter.unit),
                       std::string(counter.description)});
  }
  Table table("attribution", "References, misses and waits by what they were for", columns);
  for (const AttributionRow& row : rows) {
    std::vector<Cell> cells = {std::string(name_of(row.record)), std::int64_t{row.level},
                               std::string(processors::ray_kind_names[static_cast<std::size_t>(row.ray)]),
                               std::int64_t{row.bounce}, std::string(work_of(row))};
    sim::for_each_counter(row.counts,
                          [&](const auto& /*counter*/, std::int64_t value) { cells.emplace_back(value); });
    table.add_row(std::move(cells));
  }
  return table;
}

}  // namespace marti::studies
