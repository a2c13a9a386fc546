#include <string>

#include "accel/walk_order.h"
#include "sim/config_errors.h"
#include "studies/keys/key_parts.h"
#include "studies/keys/machine_sections.h"

namespace marti::studies::keys {

using processors::machine::most_lanes;
using processors::machine::most_mshrs;
using processors::machine::most_test_units;
using processors::machine::most_warps;
using processors::machine::NodeKind;

namespace {

void read_share(sim::Config& config, processors::machine::RtUnitConfig& rt) {
  rt.share = config.choice_as<processors::machine::RtShare>("rt.share");
  const std::string& structure = config.choice_name("structure.kind");
  if (rt.share != processors::machine::RtShare::none && structure != "bvh") {
    config.fail("rt.share", "must be \"none\" with structure.kind = \"" + structure +
                                "\": only the walk of a bvh keeps nodes that another lane could take");
  }
}

void read_stack(sim::Config& config, processors::machine::RtUnitConfig& rt) {
  rt.stack = count(config, "rt.stack");
  if (rt.stack == 0) {
    return;
  }
  if (const std::string& structure = config.choice_name("structure.kind"); structure != "bvh") {
    config.fail("rt.stack", "must be 0 with structure.kind = \"" + structure +
                                "\": only the walk of a bvh keeps entries that wait");
  }
  if (config.choice_as<accel::WalkOrder>("rt.order") != accel::WalkOrder::depth_first) {
    config.fail("rt.stack", "must be 0 with rt.order = \"" + config.choice_name("rt.order") +
                                "\": only rays that go depth first have a stack");
  }
}

}  // namespace

void declare_node_kind(sim::Schema& schema) {
  schema.choice(
      "node.kind", "core", names(processors::machine::node_kind_names),
      "core: a scalar processor that works in order; simt: warps of lanes beside a unit that traces "
      "rays, as GPUs have them (docs/rt-unit.md)");
}

void declare_simt_keys(sim::Schema& schema) {
  schema.section("simt", "a SIMT node: its warps and their shader code");
  schema.integer("simt.lanes", 32, {1, most_lanes}, "", "lanes of a warp, each of which takes a pixel");
  schema.integer("simt.warps", 16, {1, most_warps}, "",
                 "warps of a node; each asks the host for packets of its own");
  schema.integer("simt.issue", 1, {1, most_warps}, "", "warps whose shader code computes at once");
  schema.choice("simt.reconverge", "kind", names(processors::machine::reconverge_names),
                "which of a warp's lanes that hold a ray trace together; kind: those of the least bounce and "
                "kind of ray; any: all");
  schema.section("rt", "the ray-tracing unit of a SIMT node");
  schema.integer("rt.warps", 4, {0, most_warps}, "",
                 "warps in the unit at once; 0: there is no unit, and rays are traced by shader code");
  schema.choice(
      "rt.scheduler", "oldest", names(processors::machine::rt_scheduler_names),
      "which warp asks for a record next; oldest: the one that entered first; greedy: the one that "
      "asked last, then the oldest; round_robin: by turns; treelet (layout.node_order = \"treelets\"): one "
      "with a lane in the treelet of the last record, else in that of most lanes");
  schema.choice(
      "rt.order", "depth_first", names(accel::walk_order_names),
      "bvh: which of the nodes that a ray has entered it takes next; depth_first: the nearest child "
      "of its last one, then what it entered last; breadth_first: what it entered first; "
      "treelet_first (layout.node_order = \"treelets\"): depth first in the present treelet, then "
      "in others; the frame is traced so, and its image is the same");
  schema.choice("rt.coalesce", "warp", names(processors::machine::rt_coalesce_names),
                "which lanes that want the same record share one access: none, those of a warp, or of the "
                "whole unit");
  schema.choice("rt.share", "none", names(processors::machine::rt_share_names),
                "bvh: from whom a lane without work takes a node that a ray has entered; warp: the lane of "
                "its warp in the unit with most of them");
  cycles(schema, "rt.box_cycles", 8, "cycles to test the boxes of a branch");
  cycles(schema, "rt.transform_cycles", 8,
         "cycles to bring a ray into the coordinates of a kept instance's mesh");
  cycles(schema, "rt.leaf_cycles", 4, "cycles to take in a leaf's record");
  cycles(schema, "rt.triangle_cycles", 8, "cycles to test a triangle");
  cycles(schema, "rt.quadric_cycles", 16, "cycles to test a sphere, cylinder or cone");
  schema.integer("rt.box_units", 0, {0, most_test_units}, "",
                 "tests of branches, instances and leaves that may begin in a cycle; 0: any number");
  schema.integer("rt.triangle_units", 0, {0, most_test_units}, "",
                 "tests of primitives that may begin in a cycle; 0: any number");
  schema.integer(
      "rt.stack", 0, {0, processors::machine::most_stack_entries}, "",
      "bvh, depth first: entries of a lane's stack that are on chip, older ones are in memory; 0: any "
      "number is on chip");
  schema.choice(
      "rt.sort", "none", names(processors::machine::ray_sort_names),
      "by what rays of all warps are sorted before they enter the unit; kind: bounce, then kind of ray; "
      "direction: octant, then cell of 8 x 8; origin: cell of 32 x 32 x 32 of the scene, in Morton "
      "order");
  schema.integer("rt.sort_rays", 256, {1, processors::machine::most_sorted_rays}, "",
                 "rays that are sorted together; fewer only when no warp can add another one");
  cycles(schema, "rt.sort_cycles", 32, "cycles to sort them");
}

void declare_simt_cache_keys(sim::Schema& schema) {
  schema.integer("cache.ports", 1, {1, processors::machine::most_cache_ports}, "",
                 "SIMT nodes: lines looked up in a cycle");
  schema.integer("cache.mshrs", 64, {1, most_mshrs}, "", "SIMT nodes: lines under way at a time");
  schema.size("cache.sector", "0 B", {"0 B", "1 GiB"},
              "SIMT nodes: bytes fetched on a miss, a power of two that divides the line into at most 8; 0: "
              "the line");
}

void read_simt(sim::Config& config, processors::machine::MachineConfig& machine) {
  machine.kind = config.choice_as<NodeKind>("node.kind");
  if (machine.kind == NodeKind::core) {
    const std::string_view reason = "only node.kind = \"simt\" has warps of lanes";
    for (const std::string_view key : {"simt", "rt", "cache.ports", "cache.mshrs", "cache.sector"}) {
      config.mark_unused_reason(key, reason, "node.kind");
    }
    return;
  }
  processors::machine::SimtConfig& simt = machine.simt;
  simt.lanes = count(config, "simt.lanes");
  simt.warps = count(config, "simt.warps");
  simt.issue = count(config, "simt.issue");
  simt.reconverge = config.choice_as<processors::machine::Reconverge>("simt.reconverge");
  simt.ports = count(config, "cache.ports");
  simt.mshrs = count(config, "cache.mshrs");
  simt.sector = static_cast<std::uint32_t>(config.size("cache.sector"));
  if (config.choice_name("structure.kind") == "bvh") {
    (void)config.choice_name("rt.order");  // frame_keys.cpp: the frame has what it says
  } else {
    config.mark_unused_reason("rt.order", "only a bvh can be walked in other orders", "structure.kind");
  }
  processors::machine::RtUnitConfig& rt = machine.rt;
  rt.warps = count(config, "rt.warps");
  rt.coalesce = config.choice_as<processors::machine::RtCoalesce>("rt.coalesce");
  if (rt.warps > 0) {
    rt.scheduler = config.choice_as<processors::machine::RtScheduler>("rt.scheduler");
    read_share(config, rt);
    rt.box_cycles = config.integer("rt.box_cycles");
    rt.transform_cycles = config.integer("rt.transform_cycles");
    rt.leaf_cycles = config.integer("rt.leaf_cycles");
    rt.triangle_cycles = config.integer("rt.triangle_cycles");
    rt.quadric_cycles = config.integer("rt.quadric_cycles");
    rt.box_units = count(config, "rt.box_units");
    rt.triangle_units = count(config, "rt.triangle_units");
    read_stack(config, rt);
    rt.sort = config.choice_as<processors::machine::RaySort>("rt.sort");
    if (rt.sort != processors::machine::RaySort::none) {
      rt.sort_rays = count(config, "rt.sort_rays");
      rt.sort_cycles = config.integer("rt.sort_cycles");
    } else {
      for (const std::string_view key : {"rt.sort_rays", "rt.sort_cycles"}) {
        config.mark_unused_reason(key, "rays are not sorted with rt.sort = \"none\"", "rt.sort");
      }
    }
  }
  config.mark_unused_reason("rt", "there is no unit with rt.warps = 0", "rt.warps");
  sim::with_places(config, [&] { processors::machine::check_simt(machine); });
}

}  // namespace marti::studies::keys
