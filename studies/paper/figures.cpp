#include "studies/paper/figures.h"

#include <numeric>

namespace marti::studies::paper {

namespace {

/// Zero where there is nothing to share.
double share(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

tables::Table memory_table(std::span<const TracedRun> runs, const memory::LayoutConfig& layout) {
  tables::Table table(
      "figure2", "Figure 2: memory by level",
      {tables::text_column("run", "scene and depth of rays"),
       tables::text_column("tree",
                           "whole: built before the frame; on demand: only what the frame's rays needed"),
       tables::count_column("level", "level, the root's being 1"), tables::count_column("branches", "B"),
       tables::count_column("leaves", "L"), tables::count_column("partial", "P: nodes left undivided"),
       tables::count_column("entries", "triangles in the lists of leaves and partial nodes"),
       tables::integer_column("bytes", "byte", "records and lists of the level"),
       tables::real_column("share", "fraction", "share of the whole tree's bytes")});
  for (const TracedRun& run : runs) {
    const std::uint64_t whole = bytes_of(run.levels, layout);
    const std::vector<LevelCount> lazy = count_lazy_levels(run.log->topology, run.visits.touched, 1);
    for (const bool on_demand : {false, true}) {
      const std::vector<LevelCount>& levels = on_demand ? lazy : run.levels;
      for (std::size_t i = 0; i < levels.size(); ++i) {
        const std::uint64_t bytes = bytes_of(levels[i], layout);
        table.add_row({name_of(run.run), on_demand ? "on demand" : "whole", i + 1, levels[i].branches,
                       levels[i].leaves, levels[i].partial,
                       levels[i].leaf_entries + levels[i].partial_entries, bytes, share(bytes, whole)});
      }
    }
  }
  return table;
}

tables::Table access_table(std::span<const TracedRun> runs) {
  tables::Table table("figure3", "Figure 3: accesses by level",
                      {tables::text_column("run", "scene and depth of rays"),
                       tables::count_column("level", "level, the root's being 1"),
                       tables::count_column("accesses", "visits of nodes of the level, by all rays"),
                       tables::real_column("share", "fraction", "share of all visits"),
                       tables::count_column("tests", "triangles tested in the level's leaves"),
                       tables::count_column("nodes", "nodes of the level in the whole tree"),
                       tables::count_column("untouched", "of these, nodes that no ray visited")});
  for (const TracedRun& run : runs) {
    const NodeVisits& visits = run.visits;
    const std::uint64_t all =
        std::accumulate(visits.per_level.begin(), visits.per_level.end(), std::uint64_t{0});
    for (std::size_t i = 0; i < visits.per_level.size(); ++i) {
      const std::uint64_t nodes = run.levels[i].nodes();
      table.add_row({name_of(run.run), i + 1, visits.per_level[i], share(visits.per_level[i], all),
                     visits.tests[i], nodes, nodes - visits.distinct[i]});
    }
  }
  return table;
}

}  // namespace marti::studies::paper
