#include "studies/paper/paper.h"

#include <fmt/format.h>
#include <array>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/error.h"
#include "sim/finished_parts.h"
#include "studies/host/image_file.h"
#include "studies/paper/claims.h"
#include "studies/paper/figures.h"
#include "studies/paper/paper_keys.h"
#include "studies/paper/traced_run.h"
#include "studies/paper/tree_table.h"
#include "studies/run/scene_hash.h"
#include "studies/tables/provenance.h"
#include "studies/tables/text_table.h"
#include "studies/tables/text_units.h"
#include "studies/tables/wide_table.h"

namespace marti::studies::paper {

namespace {

/// Opens a scene and reports errors under the key that named it.
scenes::Scene open(const sim::Config& config, const PaperConfig& paper, const std::string& name,
                   std::string_view key) {
  try {
    return scenes::open_scene(name, paper.frame.open, host::decode_image);
  } catch (const sim::UserError& error) {
    config.fail(key, error.what());
  }
}

/// "scenes": every scene of the study.
tables::Table scene_table(const sim::Config& config, const PaperConfig& paper,
                          std::span<const SceneTrees> trees) {
  tables::Table table(
      "scenes", "The scenes",
      {tables::text_column("scene", "scene"),
       tables::text_column("hash", "hash of vertices, triangles, materials, lights and camera")});
  std::set<std::string> known;
  for (const SceneTrees& scene : trees) {
    known.insert(scene.scene);
    table.add_row({scene.scene, fmt::format("{:016x}", scene.hash)});
  }
  for (const PaperRun& run : paper.runs) {
    if (known.insert(run.scene).second) {
      const std::uint64_t hash = run::scene_hash(open(config, paper, run.scene, "paper.run_scenes"));
      table.add_row({run.scene, fmt::format("{:016x}", hash)});
    }
  }
  return table;
}

std::string head_of(const PaperConfig& paper) {
  const accel::OctreeOptions& octree = paper.frame.structure_options.octree;
  return fmt::format(
      "Space subdivision as the paper of 1992 studied it\n"
      "trees    at most {} in a leaf, {}\n"
      "images   {}\n",
      tables::counted(octree.max_objects, "primitive"), tables::counted(octree.max_level, "level"),
      keys::size_text(paper.frame.render));
}

/// The tables for people: those with a row for each level get a column for each level instead. Left out are
/// the claims, which have a text of their own.
std::string text_of_tables(std::span<const tables::Table> tables) {
  std::string text;
  for (const tables::Table& table : tables) {
    const std::string& name = table.name();
    if (name == "claims") {
      continue;
    }
    text += "\n";
    if (name == "rules") {
      text +=
          tables::text_of(tables::widen(table, std::array{std::string_view("scene")}, "level", "l", "ratio"));
    } else if (name == "figure2") {
      text += tables::text_of(tables::widen(
          table, std::array{std::string_view("run"), std::string_view("tree")}, "level", "l", "bytes"));
    } else if (name == "figure3") {
      text +=
          tables::text_of(tables::widen(table, std::array{std::string_view("run")}, "level", "l", "share"));
    } else {
      text += tables::text_of(table);
    }
  }
  return text;
}

}  // namespace

tables::StudyOutput run_paper(sim::Config& config, sim::WorkMeter* meter) {
  PaperConfig paper = read_paper(config);
  paper.frame.wait_with(meter);
  const memory::LayoutConfig layout;

  // One after the other, so that the host's seconds mean something.
  std::vector<SceneTrees> trees;
  sim::plan_parts(meter, "scenes", paper.scenes.size());
  sim::plan_parts(meter, "frames", paper.runs.size());
  for (const std::string& name : paper.scenes) {
    const scenes::Scene scene = open(config, paper, name, "paper.scenes");
    sim::begin_part(meter, "building the trees of " + name);
    SceneTrees& built = trees.emplace_back();
    sim::once(
        meter, "scenes", name, [&] { built = measure_trees(name, scene, paper.frame.structure_options); },
        built.scene, built.hash, built.polygons, built.primitives, built.octree.levels,
        built.octree.empty_leaves, built.octree.build_seconds, built.bsp.levels, built.bsp.empty_leaves,
        built.bsp.build_seconds);
  }
  tables::Table scenes = scene_table(config, paper, trees);

  // The work logs of all runs are kept, so each frame has the memory that those before it leave.
  std::vector<TracedRun> runs;
  PaperConfig beside = paper;
  for (const PaperRun& run : paper.runs) {
    runs.push_back(trace_run(beside, run));
    sim::finish_part(meter, "frames");
    beside.frame.memory.take(runs.back().totals.bytes, "the work logs of all runs take",
                             "name fewer runs in paper.run_scenes, or lower image.width");
    keys::give_memory(beside.frame.memory, beside.frame.structure_options);
  }
  std::vector<tables::Claim> claims = check_tree_claims(trees);
  const std::vector<tables::Claim> more = check_access_claims(runs);
  claims.insert(claims.end(), more.begin(), more.end());

  tables::StudyOutput output;
  std::vector<tables::Table>& tables = output.tables;
  tables = {tree_table(trees, layout), rule_table(trees), rule_level_table(trees, paper.rules)};
  tables.push_back(memory_table(runs, layout));
  tables.push_back(access_table(runs));
  tables.push_back(tables::claim_table(claims));
  output.report = head_of(paper) + text_of_tables(output.tables) + "\n" + tables::text_of(claims);
  output.tables.push_back(std::move(scenes));
  output.tables.push_back(tables::provenance_table(config.effective_values()));
  output.host_tables = {host_tree_table(trees), tables::host_table()};
  for (const tables::Table& table : output.host_tables) {
    output.host_report += (output.host_report.empty() ? "" : "\n") + tables::text_of(table);
  }
  return output;
}

}  // namespace marti::studies::paper
