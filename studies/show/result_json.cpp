#include "studies/show/result_json.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "processors/walk/record_places.h"
#include "sim/mapped.h"
#include "studies/keys/setting_value.h"
#include "studies/run/frame_figures.h"
#include "studies/run/plan/plan_output.h"
#include "studies/show/json_parts.h"
#include "studies/show/result_parts.h"
#include "studies/tables/json_table.h"
#include "studies/version.h"

namespace marti::studies::show {

namespace {

using Json = nlohmann::ordered_json;

constexpr int schema_version = 4;

Json hash(std::uint64_t value) { return fmt::format("{:016x}", value); }

template <class Names, class Values>
Json named(const Names& names, const Values& values) {
  Json object = Json::object();
  for (std::size_t i = 0; i < names.size(); ++i) {
    object[std::string(names[i])] = values[i];
  }
  return object;
}

Json scene_json(const run::RunResult& r) {
  const scenes::SceneFacts& s = r.functional.scene;
  Json bounds = nullptr;
  if (!s.bounds.empty()) {
    bounds = {{"lo", {s.bounds.lo.x, s.bounds.lo.y, s.bounds.lo.z}},
              {"hi", {s.bounds.hi.x, s.bounds.hi.y, s.bounds.hi.z}}};
  }
  return {{"source", r.frame_config.scene}, {"bounds", bounds}, {"notes", r.functional.notes}};
}

Json structure_json(const run::RunResult& r) {
  const Json levels = sim::mapped(r.functional.levels, [&](const accel::LevelStatistics& level) {
    return Json{{"branches", level.branches},
                {"leaves", level.leaves},
                {"empty_leaves", level.empty_leaves},
                {"entries", level.entries},
                {"overfull_leaves", level.overfull_leaves}};
  });
  return {{"kind", r.frame_config.structure},
          {"traversal", accel::traversal_names[static_cast<std::size_t>(r.functional.frame.log->traversal)]},
          {"mailboxes", r.functional.frame.log->mailboxes},
          {"notes", r.functional.structure_notes},
          {"node_records", processors::walk::node_records(*r.functional.frame.log)},
          {"transform_records", processors::walk::transform_records(*r.functional.frame.log)},
          {"node_bytes", r.machine.layout.node_bytes},
          {"levels", levels}};
}

// Figures without a value are left out.
Json figures_json(const run::RunResult& r) {
  Json frame = {{"scene", r.functional.scene.name},
                {"image_hash", hash(r.functional.image_hash)},
                {"hit_hash", hash(r.functional.frame.hit_hash)}};
  figures::for_each_count(run::frame_figures(), run::frame_counts(r.functional),
                          [&frame](const std::string& name, figures::Count value) {
                            frame[name] = tables::json_of(tables::Cell(value));
                          });
  Json machine = Json::object();
  const auto enter = [&machine](const std::string& name, auto value) {
    machine[name] = tables::json_of(tables::Cell(value));
  };
  figures::for_each_count(figures::counted_figures(), r.counts, enter);
  figures::for_each_derived({&r.counts, &r.one_node_counts}, enter);
  return {{"frame", frame}, {"machine", machine}};
}

Json log_json(const processors::program::LogTotals& t) {
  return {{"bytes", t.bytes},       {"branches", t.branches}, {"transforms", t.transforms},
          {"leaves", t.leaves},     {"tests", t.tests},       {"lookups", t.lookups},
          {"shades", t.shades},     {"lights", t.lights},     {"texels", t.texels},
          {"any_hits", t.any_hits}, {"cuts", t.cuts},         {"passes", t.passes}};
}

Json use_json(const run::DatabaseUse& use) {
  return {{"nodes", use.nodes},
          {"entries", use.entries},
          {"primitives", use.primitives},
          {"voxels", use.voxels},
          {"level_nodes", use.level_nodes}};
}

Json voxel_json(const run::RunResult& r) {
  if (!r.functional.voxel_cut) {
    return nullptr;
  }
  const run::VoxelReport& report = *r.functional.voxel_cut;
  Json exact = nullptr;
  if (report.exact) {
    const run::ImageError& error = report.exact->error;
    exact = {{"rmse", error.rmse},
             {"largest", error.largest},
             {"changed_pixels", error.changed},
             {"visible_pixels", error.visible},
             {"work_log", log_json(report.exact->totals)},
             {"rays", report.exact->totals.rays},
             {"use", use_json(report.exact->use)}};
  }
  const processors::program::Frame& frame = r.functional.frame;
  return {{"threshold_pixels", r.frame_config.render.voxel_cut},
          {"voxels", frame.voxels},
          {"first_level", frame.first_voxel_level},
          {"rays", named(processors::program::ray_kind_names, frame.rays.voxels)},
          {"use", use_json(report.use)},
          {"exact", exact}};
}

Json wait_json(const memory::WaitStatistics& w) {
  Json object = counters_json(w);
  const Json buckets = sim::mapped(w.histogram.buckets(), [&](const auto& bucket) {
    return Json{bucket.lowest, bucket.highest, bucket.count};
  });
  object["histogram_ps"] = buckets;
  return object;
}

Json cluster_json(const processors::replay::ClusterResult& cluster) {
  Json interconnect = counters_json(cluster.interconnect);
  interconnect["waits"] = wait_json(cluster.interconnect.waits);
  Json json = {{"interconnect", interconnect},
               {"banks", list_json(cluster.banks, [](const memory::BankStatistics& bank) {
                  Json object = counters_json(bank);
                  object["waits"] = wait_json(bank.waits);
                  return object;
                })}};
  if (!cluster.dram.empty() && cluster.dram.size() <= most_listed) {
    json["dram"] = counters_list(cluster.dram);
  }
  if (cluster.distributed) {
    Json network = counters_json(cluster.distributed->network);
    network["waits"] = wait_json(cluster.distributed->network.waits);
    json["distributed"] = counters_json(cluster.distributed->accesses);
    json["distributed"]["network"] = network;
  }
  return json;
}

Json node_json(const processors::cost::NodeStatistics& node) {
  Json object = counters_json(node);
  object["hits"] = node.references.all_hits();
  object["misses"] = node.references.all_misses();
  object["steps"] = counters_json(node.steps);
  object["time_ps"] = named(processors::cost::activity_names, node.time);
  return object;
}

// What the colours of each map stand for.
Json heat_maps_json(const run::HeatMap& map) {
  Json object = Json::object();
  for (std::size_t i = 0; i < run::heats; ++i) {
    const run::Legend legend = run::legend_of(map.figures(static_cast<run::Heat>(i)));
    object[std::string(run::heat_names[i])] = {
        {"brightest", legend.brightest}, {"largest", legend.largest}, {"mean", legend.mean}};
  }
  return object;
}

Json files_json(const std::map<std::string, std::string>& files) {
  Json object = Json::object();
  for (const auto& [name, hash] : files) {
    object[name] = {{"sha256", hash}};
  }
  return object;
}

}  // namespace

std::string json_of(const run::RunResult& r, const std::map<std::string, std::string>& files) {
  const processors::replay::MachineResult& timed = r.timed;
  Json machine = {{"scheme", processors::machine::scheme_names[static_cast<std::size_t>(r.machine.scheme)]},
                  {"clusters", r.machine.clusters},
                  {"nodes", r.machine.nodes},
                  {"node_clock_period_ps", r.machine.clock.period()},
                  {"one_node_time_ps", r.one_node.end},
                  {"notes", notes_json(r)},
                  {"bounds", bounds_json(r)},
                  {"what_helps", helps_json(r)},
                  {"per_cluster", list_json(timed.clusters, cluster_json)},
                  {"per_node", list_json(timed.nodes, node_json)}};
  // Parts that only some runs have.
  const std::pair<const char*, Json (*)(const run::RunResult&)> parts[] = {
      {"build", build_json},
      {"flow", flow_json},
      {"l2", second_level_json},
      {"counts", counts_json},
      {"working_set", working_set_json},
      {"critical_path", critical_path_json},
      {"intervals", intervals_json},
      {"contexts", context_json},
      {"simt", simt_json}};
  for (const auto& [name, json_of_part] : parts) {
    if (Json part = json_of_part(r); !part.is_null()) {
      machine[name] = std::move(part);
    }
  }
  Json result = {{"marti", {{"version", version}, {"schema", schema_version}}},
                 {"config", keys::config_json(r.config_name, r.values)},
                 {"figures", figures_json(r)},
                 {"scene", scene_json(r)},
                 {"structure", structure_json(r)},
                 {"voxel_cut", voxel_json(r)},
                 {"plan", run::plan_json(r.plan)},
                 {"machine", machine}};
  if (r.heat_map) {
    result["heat_maps"] = heat_maps_json(*r.heat_map);
  }
  result["files"] = files_json(files);
  return tables::json_text(result);
}

}  // namespace marti::studies::show
