#include "studies/operations/operations.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "accel/structure.h"
#include "scenes/open.h"
#include "sim/finished_parts.h"
#include "studies/host/image_file.h"
#include "studies/keys/frame_keys.h"
#include "studies/keys/machine_keys.h"
#include "studies/run/open_frame.h"
#include "studies/tables/provenance.h"

namespace marti::studies::operations {

namespace {

constexpr std::uint32_t longest_side = 64;
// The most tests that brute force may take.
constexpr double most_tests = 0x1p26;
constexpr std::uint32_t deepest = 8;
constexpr std::uint32_t unit_length_rays = 4000;

/// A structure to be counted.
struct CountedWalk {
  const char* name;
  const char* kind;
  accel::BspWalk walk = accel::BspWalk::recursive;
  accel::GridMatch match = accel::GridMatch::density;
  accel::BvhNodeKind node = accel::BvhNodeKind::eight;
};
constexpr CountedWalk bvh_walk(const char* name, accel::BvhNodeKind node) {
  return {name, "bvh", accel::BspWalk::recursive, accel::GridMatch::density, node};
}
constexpr std::array<CountedWalk, 12> plans{{
    {"octree", "octree"},
    {"bsp, recursive", "bsp"},
    {"bsp, push-point", "bsp", accel::BspWalk::push_point},
    {"grid, density", "grid"},
    {"grid, octree's nodes", "grid", accel::BspWalk::recursive, accel::GridMatch::octree_nodes},
    {"grid, octree's cells", "grid", accel::BspWalk::recursive, accel::GridMatch::octree_cells},
    bvh_walk("bvh, 2 children", accel::BvhNodeKind::two),
    bvh_walk("bvh, 4 children", accel::BvhNodeKind::four),
    bvh_walk("bvh, 6 children", accel::BvhNodeKind::six),
    bvh_walk("bvh, 8 children", accel::BvhNodeKind::eight),
    bvh_walk("bvh, 8 quantised", accel::BvhNodeKind::eight_quantised),
    {"none", "none"},
}};

}  // namespace

OperationsStudy count_operations(sim::Config& config, sim::WorkMeter* meter) {
  const keys::FrameConfig frame = keys::read_one_frame(config, keys::FrameUse::operations);
  static_cast<void>(keys::read_machine(config));
  config.refuse_unused();
  const scenes::Scene scene = run::open_frame(frame);
  const auto triangles = std::make_shared<const accel::TriangleSet>(scene);

  OperationsStudy study;
  study.scene = frame.scene;
  study.max_depth = frame.render.max_depth;
  study.max_objects = frame.structure_options.octree.max_objects;
  study.max_level = frame.structure_options.octree.max_level;
  sim::plan_parts(meter, "walks", 2 * plans.size() - 1);
  sim::plan_parts(meter, "lengths", 1);
  for (const CountedWalk& plan : plans) {
    sim::begin_part(meter, std::string("counting operations of ") + plan.name);
    accel::StructureOptions options = frame.structure_options;
    options.bsp.walk = plan.walk;
    options.grid_match = plan.match;
    options.bvh.node = plan.node;
    options.bvh.max_objects = std::min(options.bvh.max_objects, accel::bvh_largest_leaf(plan.node));
    const auto structure = accel::make_structure(plan.kind, triangles, options);
    double side = longest_side;
    if (structure->kind() == "none") {
      side = std::min(side, std::max(4.0, std::sqrt(most_tests / std::max(1U, triangles->size()))));
    }
    processors::program::RenderOptions render = keys::made_small(frame.render, side);
    for (const bool mailboxes : {false, true}) {
      render.mailboxes = mailboxes;
      if (mailboxes && structure->kind() == "none") {
        break;  // brute force has one list, which names nothing twice
      }
      WalkRow& row = study.walks.emplace_back();
      row.name = plan.name;
      row.mailboxes = mailboxes;
      row.side = std::max(render.width, render.height);
      row.nodes = structure->topology().nodes.size();
      row.entries = structure->topology().entries.size();
      sim::once(
          meter, "walks", row.name + (mailboxes ? " with mailboxes" : ""),
          [&] {
            row.measured = processors::cost::measure_operation_mixes(scene, *triangles, *structure, render);
          },
          row.measured);
    }
  }
  sim::once(
      meter, "lengths", "", [&] { study.lengths = measure_unit_lengths(deepest, unit_length_rays); },
      study.lengths);
  return study;
}

tables::StudyOutput run_operations(sim::Config& config, sim::WorkMeter* meter) {
  tables::StudyOutput output = output_of(count_operations(config, meter));
  output.tables.push_back(tables::provenance_table(config.effective_values()));
  return output;
}

}  // namespace marti::studies::operations
