#include "studies/error/rendering_settings.h"
#include "studies/tables/text_units.h"

#include <algorithm>

#include <fmt/format.h>

namespace marti::studies::error {

namespace {

using processors::machine::MachineConfig;

// Primitives times pixels' samples that brute force may be asked for, each about once a light.
constexpr double most_tests = 0x1p27;

class Planner {
 public:
  Planner(const keys::FrameConfig& frame, const RenderingErrorOptions& options, const scenes::Scene& scene)
      : frame_(frame), options_(options), scene_(scene) {
    plan_.base = keys::made_small(frame.render, options.side);
    plan_.base.seed = options.seed;
    plan_.base.mailboxes = false;
    plan_.base.record = false;
    plan_.structures.push_back({frame.structure, frame.structure_options});
  }

  RenderingPlan plan() {
    for (const std::uint32_t samples : options_.samples) {
      add(Knob::samples, fmt::format("{} a pixel", samples), samples).render.samples = samples;
    }
    for (const std::uint32_t depth : options_.depths) {
      add(Knob::depth, tables::counted(depth, "ray"), depth).render.max_depth = depth;
    }
    RenderingSetting& deepest =
        add(Knob::depth, fmt::format("{} rays", options_.reference_depth), options_.reference_depth);
    deepest.render.max_depth = options_.reference_depth;
    deepest.reference = true;
    add_weights();
    RenderingSetting& floats = add(Knob::precision, "float", 24.0);
    floats.render.floats = true;
    add(Knob::precision, "double", 53.0).reference = true;
    add_voxels();
    add_structures();
    add_machines();
    return std::move(plan_);
  }

 private:
  RenderingSetting& add(Knob knob, std::string name, double value) {
    RenderingSetting& setting = plan_.settings.emplace_back();
    setting.knob = knob;
    setting.name = std::move(name);
    setting.value = value;
    setting.render = plan_.base;
    return setting;
  }

  void add_weights() {
    if (plan_.base.integrator == processors::program::Integrator::path) {
      plan_.notes.emplace_back("no weights: to cut rays off would darken a path-traced image");
      return;
    }
    add_weight(0.0, true);
    for (const double weight : options_.weights) {
      add_weight(weight, false);
    }
  }

  void add_weight(double weight, bool reference) {
    RenderingSetting& setting =
        add(Knob::weight, weight == 0.0 ? "all" : fmt::format("{:g}", weight), weight);
    setting.render.min_weight = weight;
    setting.render.max_depth = options_.reference_depth;  // the weight ends the chains, as far as it can
    setting.reference = reference;
  }

  std::size_t add_structure(std::string kind, const accel::StructureOptions& options) {
    plan_.structures.push_back({std::move(kind), options});
    return plan_.structures.size() - 1;
  }

  void add_voxels() {
    if (!scene_.quadrics.empty()) {
      plan_.notes.emplace_back(
          "no voxel cut: it averages triangles only, and the scene has curved primitives");
      return;
    }
    const std::size_t octree =
        frame_.structure == "octree" ? 0 : add_structure("octree", frame_.structure_options);
    RenderingSetting& none = add(Knob::voxel_cut, "none", 0.0);
    none.structure = octree;
    none.reference = true;
    for (const double cut : options_.voxel_cuts) {
      RenderingSetting& setting = add(Knob::voxel_cut, fmt::format("{:g} pixels", cut), cut);
      setting.render.voxel_cut = cut;
      setting.structure = octree;
    }
  }

  void add_exact(std::string name, std::string kind, const accel::StructureOptions& options,
                 bool mailboxes = false) {
    const std::size_t structure = add_structure(std::move(kind), options);
    RenderingSetting& setting = add(Knob::exact, std::move(name), 0.0);
    setting.structure = structure;
    setting.render.mailboxes = mailboxes;
  }

  void add_structures() {
    const accel::StructureOptions& own = frame_.structure_options;
    add_exact("octree", "octree", own);
    add_exact("octree, mailboxes", "octree", own, true);
    for (const std::uint32_t level : {4U, 8U}) {
      accel::StructureOptions options = own;
      options.octree.max_level = level;
      add_exact(fmt::format("octree, {} levels", level), "octree", options);
    }
    for (const std::uint32_t objects : {1U, 64U}) {
      accel::StructureOptions options = own;
      options.octree.max_objects = objects;
      add_exact(fmt::format("octree, {} a leaf", objects), "octree", options);
    }
    for (const auto walk : {accel::BspWalk::recursive, accel::BspWalk::push_point}) {
      accel::StructureOptions options = own;
      options.bsp.walk = walk;
      add_exact(walk == accel::BspWalk::recursive ? "bsp, recursive" : "bsp, push-point", "bsp", options);
    }
    accel::StructureOptions grid = own;
    grid.grid_match = accel::GridMatch::density;
    add_exact("grid", "grid", grid);
    add_exact("grid, mailboxes", "grid", grid, true);
    for (std::size_t node = 0; node < accel::bvh_node_names.size(); ++node) {
      accel::StructureOptions options = own;
      options.bvh.node = static_cast<accel::BvhNodeKind>(node);
      options.bvh.max_objects = std::min(own.bvh.max_objects, accel::bvh_largest_leaf(options.bvh.node));
      add_exact(fmt::format("bvh, {} children", accel::bvh_node_names[node]), "bvh", options);
    }
    const double tests = static_cast<double>(scene_.triangles.size() + scene_.quadrics.size()) *
                         plan_.base.width * plan_.base.height * plan_.base.samples;
    if (tests <= most_tests) {
      add_exact("brute force", "none", own);
    } else {
      plan_.notes.push_back(
          fmt::format("no brute force: it would take some {:.1g} tests for the camera rays alone", tests));
    }
  }

  void add_machine(std::string name, const MachineConfig& machine) {
    RenderingSetting& setting = add(Knob::exact, std::move(name), 0.0);
    setting.render.record = true;
    setting.machine = machine;
  }

  void add_machines() {
    MachineConfig machine;
    machine.nodes = 16;
    for (const std::uint32_t packet : {1U, 8U, 64U}) {
      machine.packets.width = packet;
      machine.packets.height = packet;
      add_machine(fmt::format("16 nodes, packets {0} x {0}", packet), machine);
    }
    machine = {};
    machine.nodes = 1;
    add_machine("1 node", machine);
    machine.nodes = 256;
    add_machine("256 nodes", machine);
    machine.nodes = 16;
    machine.scheme = processors::machine::Scheme::pipeline;
    machine.pipeline = processors::machine::default_stages(machine.nodes);
    add_machine("pipeline of 16", machine);
    machine.scheme = processors::machine::Scheme::space;
    add_machine("space, 16 nodes", machine);
  }

  const keys::FrameConfig& frame_;
  const RenderingErrorOptions& options_;
  const scenes::Scene& scene_;
  RenderingPlan plan_;
};

}  // namespace

RenderingPlan plan_rendering(const keys::FrameConfig& frame, const RenderingErrorOptions& options,
                             const scenes::Scene& scene) {
  return Planner(frame, options, scene).plan();
}

}  // namespace marti::studies::error
