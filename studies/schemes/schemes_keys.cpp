#include "studies/schemes/schemes_keys.h"

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "accel/structure.h"
#include "processors/replay/host_bytes.h"
#include "sim/config_errors.h"
#include "sim/shown.h"
#include "sim/units.h"
#include "studies/keys/key_parts.h"
#include "studies/keys/machine_keys.h"
#include "studies/keys/other_commands.h"
#include "studies/run/run_result.h"

namespace marti::studies::schemes {

namespace {

constexpr std::uint32_t most_study_nodes = 65536;

// A file that the configuration names, relative to the configuration's own directory.
std::filesystem::path beside(const sim::Config& config, const std::string& name) {
  return std::filesystem::path(config.name()).parent_path() / name;
}

NamedMachine read_with(const std::filesystem::path& file, const keys::FrameConfig& frame,
                       std::vector<std::string> assignments) {
  if (frame.structure == accel::Bvh::kind_name) {
    const auto node = static_cast<std::size_t>(frame.structure_options.bvh.node);
    assignments.emplace_back("structure.kind=bvh");
    assignments.push_back("structure.bvh_children=" + std::string(accel::bvh_node_names[node]));
  }
  sim::Config config = sim::Config::from_file(run::run_schema(), file, assignments);
  (void)keys::read_frame(config);
  std::string name = file.stem().string();
  std::ranges::replace_if(
      name, [](char c) { return (c < 'a' || c > 'z') && (c < '0' || c > '9'); }, '_');
  NamedMachine machine{std::move(name), keys::read_machine(config)};
  config.refuse_unused();
  return machine;
}

// "bvh:" is followed by the kind of its nodes.
NamedStructure named_structure(const sim::Config& config, const std::string& name) {
  for (const char* const kind : {"octree", "bsp", "grid"}) {
    if (name == kind) {
      return {name, name};
    }
  }
  for (std::size_t node = 0; node < accel::bvh_node_names.size(); ++node) {
    if (name == "bvh:" + std::string(accel::bvh_node_names[node])) {
      return {name, "bvh", static_cast<accel::BvhNodeKind>(node)};
    }
  }
  config.fail("schemes.structures",
              "there is no structure \"" + sim::shown(name) +
                  "\"; there are octree, bsp, grid, bvh:2, bvh:4, bvh:6, bvh:8, bvh:8_quantised");
}

// Calls `work`, which reads a file that the key names; errors in that file are reported under the key.
template <class Work>
decltype(auto) named_by(const sim::Config& config, std::string_view key, const Work& work) {
  return sim::with_places(config,
                          [&]() -> decltype(auto) { return sim::KeyError::reported_under(key, work); });
}

}  // namespace

NamedMachine read_machine_file(const std::filesystem::path& file, const keys::FrameConfig& frame) {
  return read_with(file, frame, {});
}

NamedMachine read_machine_file(const std::filesystem::path& file, const keys::FrameConfig& frame,
                               std::uint32_t nodes, const processors::machine::PipelineConfig& shares) {
  std::vector<std::string> assignments = {"machine.nodes=" + std::to_string(nodes)};
  if (read_machine_file(file, frame).config.scheme == processors::machine::Scheme::pipeline) {
    const std::uint64_t all = std::uint64_t{shares.search} + shares.nearest + shares.shade;
    const auto part = [&](std::uint64_t share, std::uint64_t most) {
      return std::clamp<std::uint64_t>((share * nodes + all / 2) / all, 1, most);
    };
    const std::uint64_t nearest = part(shares.nearest, nodes - 2);
    const std::uint64_t shade = part(shares.shade, nodes - 1 - nearest);
    assignments.push_back("pipeline.search=" + std::to_string(nodes - nearest - shade));
    assignments.push_back("pipeline.nearest=" + std::to_string(nearest));
    assignments.push_back("pipeline.shade=" + std::to_string(shade));
  }
  return read_with(file, frame, std::move(assignments));
}

void declare_schemes_keys(sim::Schema& schema) {
  schema.section(
      "schemes",
      "only for `marti study schemes`, which takes the machines from files of their own, named from "
      "the directory of the study's");
  schema.texts(
      "schemes.machines", {"naive-pixel.toml", "marti.toml", "pipeline.toml", "space.toml"},
      "machines whose speed-up is compared; what these files say about scene, image and structure is "
      "left aside");
  schema.integers("schemes.nodes", {1, 2, 4, 8, 16, 32, 64, 128, 256}, {1, most_study_nodes}, "",
                  "nodes in each cluster; a machine that needs more is left out there");
  schema.text("schemes.cell_machine", "marti.toml", "the machine whose misses are counted over cell sizes");
  schema.integers("schemes.cell_levels", {4, 5, 6, 7, 8, 9, 10, 11, 12}, {1, 21}, "",
                  "structure.max_level of the trees whose cells are compared");
  schema.integer("schemes.cell_objects", 1, {1, 1'000'000}, "",
                 "structure.max_objects of these trees: small, so that the level decides");
  schema.texts("schemes.structures", {},
               "structures compared on that machine: octree, bsp, grid, bvh:2, bvh:4, bvh:6, bvh:8, "
               "bvh:8_quantised");
  schema.text("schemes.stage_machine", "pipeline.toml",
              "the pipeline whose nodes are shared out among its stages in several ways; empty: none");
  schema.integer("schemes.stage_nodes", 16, {processors::machine::pipeline_stages, 1024}, "",
                 "nodes of that pipeline");
}

sim::Schema schemes_schema() {
  sim::Schema schema;
  keys::declare_frame_keys(schema);
  declare_schemes_keys(schema);
  keys::declare_sections_of_other_commands(schema);
  return schema;
}

SchemesConfig read_schemes(sim::Config& config) {
  SchemesConfig schemes;
  schemes.frame = keys::read_one_frame(config, keys::FrameUse::schemes);
  schemes.nodes = keys::ascending<std::uint32_t>(config, "schemes.nodes");
  schemes.cell_levels = keys::ascending<std::uint32_t>(config, "schemes.cell_levels");
  schemes.cell_objects = keys::count(config, "schemes.cell_objects");
  schemes.stage_nodes = keys::count(config, "schemes.stage_nodes");
  if (schemes.nodes.empty()) {
    config.fail("schemes.nodes", "must name a number of nodes");
  }
  if (!schemes.cell_levels.empty() && schemes.frame.structure != "octree") {
    config.fail("structure.kind", "the study compares the cells of octrees; set schemes.cell_levels = []");
  }
  std::set<std::string> names;  // by which tables and charts tell machines apart
  for (const std::string& name : config.texts("schemes.machines")) {
    const std::filesystem::path& file = schemes.machines.emplace_back(beside(config, name));
    const NamedMachine machine =
        named_by(config, "schemes.machines", [&] { return read_machine_file(file, schemes.frame); });
    if (!names.insert(machine.name).second) {
      config.fail("schemes.machines",
                  "two machines would be called " + machine.name +
                      ": the letters and digits of the files' names must differ, not only "
                      "their folders");
    }
    const std::uint32_t most = std::max(schemes.nodes.back(), fewest_nodes(machine.config));
    const std::string excess = schemes.frame.memory.excess(processors::replay::host_bytes(
        named_by(config, "schemes.nodes",
                 [&] { return read_machine_file(file, schemes.frame, most, machine.config.pipeline); })
            .config,
        schemes.frame.render.width, schemes.frame.render.height));
    if (!excess.empty()) {
      config.fail("schemes.nodes", "simulating that many nodes of " + sim::shown(name) + " takes" + excess);
    }
  }
  if (schemes.machines.empty()) {
    config.fail("schemes.machines", "must name a machine");
  }
  schemes.cell_machine = beside(config, config.text("schemes.cell_machine"));
  (void)named_by(config, "schemes.cell_machine",
                 [&] { return read_machine_file(schemes.cell_machine, schemes.frame); });
  for (const std::string& name : config.texts("schemes.structures")) {
    const NamedStructure& structure = schemes.structures.emplace_back(named_structure(config, name));
    keys::FrameConfig frame = schemes.frame;
    frame.structure = structure.kind;
    frame.structure_options.bvh.node = structure.node;
    (void)named_by(config, "schemes.cell_machine",
                   [&] { return read_machine_file(schemes.cell_machine, frame); });
  }
  const std::string& stages = config.text("schemes.stage_machine");
  if (!stages.empty()) {
    schemes.stage_machine = beside(config, stages);
    const NamedMachine machine = named_by(config, "schemes.stage_machine", [&] {
      return read_machine_file(schemes.stage_machine, schemes.frame);
    });
    if (machine.config.scheme != processors::machine::Scheme::pipeline) {
      config.fail("schemes.stage_machine", "names a machine that is no pipeline");
    }
  }
  config.refuse_unused();
  return schemes;
}

}  // namespace marti::studies::schemes
