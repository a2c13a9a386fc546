// The sections of a machine's configuration that have files of their own; machine_keys.cpp declares and reads
// them all in the order in which they depend on one another. Each is declared by one function and read by
// another, which marks the keys that have no effect and throws UserError naming file, line and key.
#pragma once

#include "processors/machine/machine_config.h"
#include "sim/config.h"
#include "sim/schema.h"

namespace marti::studies::keys {

/// Before the machine is read. Where an assignment (--set) asks for a scheme in which rays move, features of
/// the file that are for packets only get their defaults, as if the assignment had set them too: another
/// scheme is another kind of machine. Refuses two features that do not combine, at the place of the first
/// one's key.
void settle_combinations(sim::Config& config);

/// [build]: refuses a structure (`structure.kind`) that is not built by splitting nodes, and a placement of
/// the database that leaves no tree to share.
void declare_build_keys(sim::Schema& schema);
[[nodiscard]] processors::machine::BuildConfig read_build(sim::Config& config);
/// For studies that always build on demand: like read_build, but if `build.sharing` is not given, the tree is
/// shared, or private where each node has a database of its own. Refuses a `build.sharing` of "given" or
/// "none". Call it after read_machine.
[[nodiscard]] processors::machine::BuildConfig read_dynamic_build(sim::Config& config);

/// What hides a node's misses: the keys of contexts, which are in [node], and [prefetch]. Read into a machine
/// whose cache, placement and building have been read.
void declare_context_keys(sim::Schema& schema);
void declare_prefetch_keys(sim::Schema& schema);
void read_contexts(sim::Config& config, processors::machine::MachineConfig& machine);

/// node.kind, [simt] and [rt], and the keys of [cache] that only SIMT nodes have. Read into a machine whose
/// cache has been read.
void declare_node_kind(sim::Schema& schema);
void declare_simt_keys(sim::Schema& schema);
void declare_simt_cache_keys(sim::Schema& schema);
void read_simt(sim::Config& config, processors::machine::MachineConfig& machine);

/// memory.model, which belongs to the section before, and [dram]; the memory behind an interconnect that has
/// one.
void declare_memory_model(sim::Schema& schema);
void declare_dram_keys(sim::Schema& schema);
void read_memory(sim::Config& config, processors::machine::MachineConfig& machine);

/// [l2]. Read when caches, database and interconnect are known.
void declare_second_level_keys(sim::Schema& schema);
void read_second_level(sim::Config& config, processors::machine::MachineConfig& machine);

/// The schemes in which rays move from node to node: [messages] and [pipeline]. Scheme and nodes must have
/// been read.
void declare_flow_keys(sim::Schema& schema);
void read_flow(sim::Config& config, processors::machine::MachineConfig& machine);

/// [network], of a machine that has one.
void declare_network_keys(sim::Schema& schema);
[[nodiscard]] memory::NetworkConfig read_network(sim::Config& config);

/// [space]; with the space scheme the keys of shared memory and of the database's placement have no effect.
/// Scheme and nodes must have been read.
void declare_space_keys(sim::Schema& schema);
void read_space(sim::Config& config, processors::machine::MachineConfig& machine);

/// [count], into a machine that is otherwise complete.
void declare_count_keys(sim::Schema& schema);
void read_count(sim::Config& config, processors::machine::MachineConfig& machine);

/// [energy]: the preset's figures, with those that are given in their places. The rest of the machine must
/// have been read.
void declare_energy_keys(sim::Schema& schema);
void read_energy(sim::Config& config, processors::machine::MachineConfig& machine);

}  // namespace marti::studies::keys
