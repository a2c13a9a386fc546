#include <cstdint>
#include <string>

#include "studies/keys/key_parts.h"
#include "studies/keys/machine_sections.h"

namespace marti::studies::keys {

using processors::machine::RegionPolicy;

void declare_space_keys(sim::Schema& schema) {
  schema.section("space", "parts of the scene that nodes hold (machine.scheme = \"space\")");
  schema.choice(
      "space.policy", "scatter", names(processors::machine::region_policy_names),
      "which node holds which region; blocks: runs of neighbouring regions; scatter: region i is node i's "
      "modulo the nodes; balanced: equal numbers of primitives; sampled: equal work in a pre-pass "
      "over few pixels");
  schema.integer(
      "space.level", 4, {1, most_levels}, "",
      "regions are the subtrees whose roots lie on this level (root: 1) and the leaves above; every "
      "node has the branches above");
  schema.integer("space.queue", 16, {1, 65536}, "", "rays that may wait before each node");
  schema.integer("space.in_flight", 0, {0, std::int64_t{1} << 31U}, "",
                 "the host sends a camera ray while fewer rays are in flight in the cluster; 0: half of what "
                 "its queues hold");
  schema.integer("space.sample_step", 8, {1, 65536}, "pixels",
                 "sampled: the pre-pass takes every so many columns of every so many rows");
}

void read_space(sim::Config& config, processors::machine::MachineConfig& machine) {
  if (machine.scheme != processors::machine::Scheme::space) {
    config.mark_unused_reason("space", "it has no effect without machine.scheme = \"space\"",
                              "machine.scheme");
    return;
  }
  const std::string& structure = config.choice_name("structure.kind");
  if (structure != "octree" && structure != "bsp" && structure != "bvh") {
    config.fail("machine.scheme", "\"space\" cuts a tree into regions: with structure.kind = \"" + structure +
                                      "\" there is none; use \"octree\", \"bsp\" or \"bvh\"");
  }
  processors::machine::SpaceConfig& space = machine.space;
  space.policy = config.choice_as<RegionPolicy>("space.policy");
  space.level = count(config, "space.level");
  space.queue = count(config, "space.queue");
  space.in_flight = count(config, "space.in_flight");
  if (space.policy == RegionPolicy::sampled) {
    space.sample_step = count(config, "space.sample_step");
  }
  config.mark_unused_reason("space.sample_step", "only space.policy = \"sampled\" makes a pre-pass",
                            "space.policy");
  const std::string own =
      "with machine.scheme = \"space\" each node holds its part in its own memory (local)";
  for (const std::string_view key : {"database", "interconnect", "memory", "dram"}) {
    config.mark_unused_reason(key, own, "machine.scheme");
  }
}

}  // namespace marti::studies::keys
