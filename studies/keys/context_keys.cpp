#include <string>

#include "studies/keys/key_parts.h"
#include "studies/keys/machine_sections.h"

namespace marti::studies::keys {

namespace {

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
