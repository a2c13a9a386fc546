// The configuration of a given machine: the values that its keys must have.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "memory/dram_presets.h"
#include "processors/machine/machine_config.h"
#include "sim/config.h"
#include "sim/units.h"
#include "studies/keys/frame_keys.h"
#include "studies/keys/machine_keys.h"
#include "studies/run/run_result.h"

namespace marti::test {

/// Collects "key=value" texts.
class Assignments {
 public:
  void set(std::string_view key, std::string_view value) {
    list_.push_back(std::string(key) + "=" + std::string(value));
  }
  void set(std::string_view key, std::int64_t value) { set(key, std::to_string(value)); }
  void set(std::string_view key, sim::Clock clock) {
    set(key, sim::print_frequency(static_cast<double>(sim::ticks_per_second) /
                                  static_cast<double>(clock.period())));
  }
  template <class Enum, std::size_t N>
  void choose(std::string_view key, const std::array<std::string_view, N>& names, Enum value) {
    set(key, names[static_cast<std::size_t>(value)]);
  }
  [[nodiscard]] std::vector<std::string> take() { return std::move(list_); }

 private:
  std::vector<std::string> list_;
};

inline void assign_node(const processors::machine::MachineConfig& m, Assignments& to) {
  to.choose("machine.scheme", processors::machine::scheme_names, m.scheme);
  to.set("machine.clusters", m.clusters);
  to.set("machine.nodes", m.nodes);
  to.set("node.clock", m.clock);
  to.set("node.word", m.word_bytes);
  to.choose("node.pixels", processors::machine::pixels_names, m.pixels);
  to.set("node.write_buffer", m.write_buffer);
  to.set("node.contexts", m.contexts);
  to.set("node.switch_cycles", m.switch_cycles);
  to.set("prefetch.next_line", m.prefetch.next_line ? "true" : "false");
  to.set("prefetch.children", m.prefetch.children ? "true" : "false");
  to.set("prefetch.outstanding", m.prefetch.outstanding);
  to.set("costs.add", m.operations.add);
  to.set("costs.multiply", m.operations.multiply);
  to.set("costs.divide", m.operations.divide);
  to.set("costs.square_root", m.operations.square_root);
  to.set("costs.compare", m.operations.compare);
  to.set("costs.integer", m.operations.integer);
  to.set("costs.load", m.operations.load);
  to.set("costs.store", m.operations.store);
  to.set("packets.width", m.packets.width);
  to.set("packets.height", m.packets.height);
  to.choose("packets.order", processors::machine::packet_order_names, m.packets.order);
  to.choose("host.assignment", processors::machine::assignment_names, m.host.assignment);
  to.set("host.clock", m.host.clock);
  to.set("host.latency_cycles", m.host.latency_cycles);
  to.set("host.occupancy_cycles", m.host.occupancy_cycles);
  to.choose("build.sharing", processors::machine::sharing_names, m.build.sharing);
  to.set("build.initial_level", m.build.initial == processors::machine::InitialTree::full ? "full"
                                : m.build.initial == processors::machine::InitialTree::rule
                                    ? "rule"
                                    : std::to_string(m.build.level));
  to.set("build.rule_k", sim::print_real(m.build.rule_k));
}

inline void assign_caches(const processors::machine::MachineConfig& m, Assignments& to) {
  to.set("layout.node", m.layout.node_bytes);
  to.set("layout.entry", m.layout.entry_bytes);
  to.set("layout.primitive", m.layout.primitive_bytes);
  to.set("layout.transform", m.layout.transform_bytes);
  to.set("layout.quadric", m.layout.quadric_bytes);
  to.set("layout.material", m.layout.material_bytes);
  to.set("layout.texel", m.layout.texel_bytes);
  to.set("layout.pixel", m.layout.pixel_bytes);
  to.set("layout.record_alignment", m.layout.record_alignment);
  to.set("layout.section_alignment", static_cast<std::int64_t>(m.layout.section_alignment));
  to.choose("layout.node_order", memory::node_order_names, m.layout.node_order);
  if (m.layout.node_order == memory::NodeOrder::treelets) {
    to.set("layout.treelet", m.layout.treelet_bytes);
  }
  to.choose("cache.organisation", processors::machine::cache_organisation_names, m.cache.organisation);
  to.set("cache.size", static_cast<std::int64_t>(m.cache.cache.size));
  to.set("cache.node_size", static_cast<std::int64_t>(m.cache.split_sizes[0]));
  to.set("cache.list_size", static_cast<std::int64_t>(m.cache.split_sizes[1]));
  to.set("cache.primitive_size", static_cast<std::int64_t>(m.cache.split_sizes[2]));
  to.set("cache.shading_size", static_cast<std::int64_t>(m.cache.split_sizes[3]));
  to.set("cache.line", m.cache.cache.line);
  to.set("cache.ways", m.cache.cache.ways);
  to.choose("cache.replacement", memory::replacement_names, m.cache.cache.replacement);
  to.set("cache.hit_cycles", m.cache.hit_cycles);
  to.choose("l2.sharing", processors::machine::second_level_names, m.l2.sharing);
  to.set("l2.size", static_cast<std::int64_t>(m.l2.cache.size));
  to.set("l2.ways", m.l2.cache.ways);
  to.choose("l2.replacement", memory::replacement_names, m.l2.cache.replacement);
  if (m.l2.clock) {
    to.set("l2.clock", *m.l2.clock);
  }
  to.set("l2.hit_cycles", m.l2.hit_cycles);
}

inline void assign_memory(const processors::machine::MachineConfig& m, Assignments& to) {
  to.choose("database.placement", processors::machine::placement_names, m.placement);
  to.set("database.interleave", m.distribution.interleave);
  to.set("database.header", m.distribution.header_bytes);
  to.set("local.clock", m.local.clock);
  to.set("local.width", m.local.width);
  to.set("local.access_cycles", m.local.access_cycles);
  to.set("local.cycles_per_beat", m.local.cycles_per_beat);
  to.choose("interconnect.kind", std::array<std::string_view, 3>{"ideal", "bus", "crossbar"},
            m.interconnect.kind);
  to.choose("interconnect.mode", std::array<std::string_view, 2>{"held", "split"}, m.interconnect.mode);
  to.choose("interconnect.arbitration", memory::arbitration_names, m.interconnect.arbitration);
  to.set("interconnect.clock", m.interconnect.clock);
  to.set("interconnect.width", m.interconnect.width);
  to.set("interconnect.cycles_per_beat", m.interconnect.cycles_per_beat);
  to.set("interconnect.address_cycles", m.interconnect.address_cycles);
  to.set("interconnect.latency_cycles", m.interconnect.latency_cycles);
  to.set("memory.banks", m.banks.count);
  to.set("memory.interleave", m.banks.interleave);
  to.set("memory.clock", m.banks.clock);
  to.set("memory.access_cycles", m.banks.access_cycles);
  to.set("memory.busy_cycles", m.banks.busy_cycles);
}

/// Of a memory made of one of the presets by test::add_random_dram.
inline void assign_dram(const memory::DramConfig& dram, Assignments& to) {
  to.choose("memory.model", std::array<std::string_view, 2>{"fixed", "dram"}, 1);
  to.choose("dram.preset", memory::dram_preset_names, dram.preset);
  to.choose("dram.policy", memory::dram_policy_names, dram.policy);
  to.choose("dram.page", memory::dram_page_names, dram.page);
  to.set("dram.queue", dram.queue);
  to.set("dram.reorder_cap", dram.reorder_cap);
  to.set("dram.tck", dram.period);
  to.set("dram.channels", dram.channels);
  to.set("dram.ranks", dram.ranks);
  to.set("dram.banks", dram.banks);
  to.set("dram.row", dram.row_bytes);
  to.set("dram.burst", dram.burst_bytes);
  to.set("dram.trefi", dram.timing.refi);
}

inline void assign_flow(const processors::machine::MachineConfig& m, Assignments& to) {
  to.choose("network.kind", memory::network_kind_names, m.network.kind);
  to.set("network.clock", m.network.clock);
  to.set("network.width", m.network.width);
  to.set("network.cycles_per_beat", m.network.cycles_per_beat);
  to.set("network.hop_cycles", m.network.hop_cycles);
  to.set("messages.ray", m.messages.ray_bytes);
  to.set("messages.contribution", m.messages.contribution_bytes);
  to.set("messages.send_cycles", m.messages.send_cycles);
  to.set("messages.receive_cycles", m.messages.receive_cycles);
  to.set("pipeline.search", m.pipeline.search);
  to.set("pipeline.nearest", m.pipeline.nearest);
  to.set("pipeline.shade", m.pipeline.shade);
  to.set("pipeline.queue", m.pipeline.queue);
  to.set("pipeline.in_flight", m.pipeline.in_flight);
  to.choose("space.policy", processors::machine::region_policy_names, m.space.policy);
  to.set("space.level", m.space.level);
  to.set("space.queue", m.space.queue);
  to.set("space.in_flight", m.space.in_flight);
  to.set("space.sample_step", m.space.sample_step);
}

/// Without banks no key says how much one reference reads where there is no cache: 32 bytes.
inline void use_default_interleave(processors::machine::MachineConfig& machine) {
  if (machine.scheme == processors::machine::Scheme::space ||
      machine.placement == processors::machine::Placement::distributed ||
      machine.interconnect.kind == memory::InterconnectKind::ideal) {
    machine.banks.interleave = 32;
    machine.distribution.interleave = std::max(machine.distribution.interleave, machine.reference_bytes());
  }
}

/// The assignments that make a configuration describe the machine. Keys without effect on it get values, too.
inline std::vector<std::string> assignments_of(const processors::machine::MachineConfig& machine) {
  Assignments assignments;
  assign_node(machine, assignments);
  assign_caches(machine, assignments);
  assign_memory(machine, assignments);
  assign_flow(machine, assignments);
  if (machine.banks.dram) {
    assign_dram(*machine.banks.dram, assignments);
  }
  return assignments.take();
}

/// The machine that a configuration describes.
inline processors::machine::MachineConfig read_machine_of(const std::string& text,
                                                          const std::vector<std::string>& assignments = {}) {
  sim::Schema schema;
  studies::keys::declare_frame_keys(schema);
  studies::keys::declare_machine_keys(schema);
  sim::Config config = sim::Config::from_text(schema, text, "machine.toml", assignments);
  processors::machine::MachineConfig machine = studies::keys::read_machine(config);
  config.refuse_unused();
  return machine;
}

inline sim::Config configuration_of(const std::vector<std::string>& assignments) {
  return sim::Config::from_text(studies::run::run_schema(), "", "random.toml", assignments);
}

}  // namespace marti::test
