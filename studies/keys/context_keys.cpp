#include <string>
#include <string_view>

#include "accel/walk_order.h"
#include "studies/keys/key_parts.h"
#include "studies/keys/machine_sections.h"

namespace marti::studies::keys {

namespace {

// What is prefetched into a ray-tracing unit.
void read_unit_prefetch(sim::Config& config, const processors::machine::MachineConfig& machine,
                        processors::machine::PrefetchConfig& prefetch) {
  if (machine.kind == processors::machine::NodeKind::core) {
    for (const std::string_view key : {"prefetch.stack", "prefetch.treelet", "prefetch.queue"}) {
      config.mark_unused_reason(key, "only node.kind = \"simt\" has a ray-tracing unit", "node.kind");
    }
    return;
  }
  prefetch.stack = count(config, "prefetch.stack");
  prefetch.treelet = config.boolean("prefetch.treelet");
  if (prefetch.treelet && machine.layout.node_order != memory::NodeOrder::treelets) {
    config.fail("prefetch.treelet", "needs nodes that lie in treelets; set layout.node_order = \"treelets\"");
  }
  if (prefetch.into_unit() && machine.rt.warps == 0) {
    config.fail(prefetch.stack > 0 ? "prefetch.stack" : "prefetch.treelet",
                "is for warps in a ray-tracing unit; set rt.warps to at least 1");
  }
  if (const std::string& structure = config.choice_name("structure.kind");
      prefetch.stack > 0 && structure != "bvh") {
    config.fail("prefetch.stack", "must be 0 with structure.kind = \"" + structure +
                                      "\": only the walk of a bvh keeps entries that wait");
  }
  if (prefetch.stack > 0 && config.choice_as<accel::WalkOrder>("rt.order") != accel::WalkOrder::depth_first) {
    config.fail("prefetch.stack", "must be 0 with rt.order = \"" + config.choice_name("rt.order") +
                                      "\": only rays that go depth first take entries from a stack");
  }
  if (prefetch.into_unit()) {
    prefetch.queue = count(config, "prefetch.queue");
  }
  config.mark_unused_reason(
      "prefetch.queue", "nothing is prefetched without prefetch.stack or prefetch.treelet", "prefetch.stack");
}

void read_prefetch(sim::Config& config, processors::machine::MachineConfig& machine) {
  if (machine.cache.organisation == processors::machine::CacheOrganisation::none) {
    config.mark_unused_reason("prefetch", "without a cache there is nowhere to put a line",
                              "cache.organisation");
  } else if (machine.placement == processors::machine::Placement::replicated) {
    config.mark_unused_reason("prefetch", "a node whose own memory has the whole database does not prefetch",
                              "database.placement");
  } else {
    processors::machine::PrefetchConfig& prefetch = machine.prefetch;
    prefetch.next_line = config.boolean("prefetch.next_line");
    prefetch.children = config.boolean("prefetch.children");
    const std::string& structure = config.choice_name("structure.kind");
    if (prefetch.children && structure != "octree" && structure != "bsp" && structure != "bvh") {
      config.fail("prefetch.children",
                  "must be false with structure.kind = \"" + structure +
                      "\": only an octree, a bsp tree or a bvh has branches with children");
    }
    if (prefetch.on()) {
      prefetch.outstanding = count(config, "prefetch.outstanding");
    }
    config.mark_unused_reason("prefetch.outstanding",
                              "nothing is prefetched without prefetch.next_line or prefetch.children",
                              "prefetch.next_line");
    read_unit_prefetch(config, machine, prefetch);
  }
}

}  // namespace

void declare_context_keys(sim::Schema& schema) {
  schema.integer("node.contexts", 1, {1, processors::machine::most_contexts}, "",
                 "packets a node works on by turns: on a miss it takes up the next one that can go on");
  cycles(schema, "node.switch_cycles", 1, "cycles to take up another context");
}

void declare_prefetch_keys(sim::Schema& schema) {
  schema.section("prefetch",
                 "lines that a node's cache fetches before they are used; not with a replicated database");
  schema.boolean(
      "prefetch.next_line", false,
      "a miss that is read from memory, not served by a private second level, also fetches the next line "
      "of the same kind of record, if it is not there");
  schema.boolean("prefetch.children", false,
                 "a visit to a branch also fetches the records of its children that are not there");
  schema.integer("prefetch.outstanding", 4, {1, processors::machine::most_contexts}, "",
                 "most prefetches a node has under way; further ones are dropped");
  schema.integer("prefetch.stack", 0, {0, processors::machine::most_prefetched_entries}, "",
                 "SIMT nodes, bvh: a lane that takes an entry from its stack also fetches the records of so "
                 "many entries below it");
  schema.boolean("prefetch.treelet", false,
                 "SIMT nodes, layout.node_order = \"treelets\": a lane that comes to another treelet also "
                 "fetches all of its nodes");
  schema.integer("prefetch.queue", 32, {1, processors::machine::most_queued_prefetches}, "",
                 "SIMT nodes: lines that wait to be fetched so; further ones are dropped");
}

void read_contexts(sim::Config& config, processors::machine::MachineConfig& machine) {
  machine.contexts = count(config, "node.contexts");
  if (machine.contexts > 1) {
    machine.switch_cycles = config.integer("node.switch_cycles");
  }
  config.mark_unused_reason("node.switch_cycles", "a node with one context has no other to take up",
                            "node.contexts");
  read_prefetch(config, machine);
  if (machine.kind == processors::machine::NodeKind::core &&
      std::uint64_t{machine.all_nodes()} * machine.ports_of_node() > processors::machine::most_ports) {
    config.fail("node.contexts", "nodes times contexts and prefetches under way must be at most 2^28");
  }
}

}  // namespace marti::studies::keys
