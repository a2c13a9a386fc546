#include "studies/keys/machine_keys.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "accel/bvh_options.h"
#include "processors/cost/cost_model.h"
#include "processors/energy/energy.h"
#include "processors/program/work_log.h"
#include "scenes/given_rays.h"
#include "sim/config_errors.h"
#include "sim/error.h"
#include "sim/mapped.h"
#include "studies/keys/key_parts.h"
#include "studies/keys/machine_sections.h"

namespace marti::studies::keys {

namespace {

using sim::Schema;

constexpr std::array<std::pair<std::string_view, std::int64_t processors::machine::OperationCycles::*>, 8>
    operations = {{
        {"costs.add", &processors::machine::OperationCycles::add},
        {"costs.multiply", &processors::machine::OperationCycles::multiply},
        {"costs.divide", &processors::machine::OperationCycles::divide},
        {"costs.square_root", &processors::machine::OperationCycles::square_root},
        {"costs.compare", &processors::machine::OperationCycles::compare},
        {"costs.integer", &processors::machine::OperationCycles::integer},
        {"costs.load", &processors::machine::OperationCycles::load},
        {"costs.store", &processors::machine::OperationCycles::store},
    }};

constexpr std::array<std::pair<std::string_view, std::uint32_t memory::LayoutConfig::*>, 8> records = {{
    {"layout.node", &memory::LayoutConfig::node_bytes},
    {"layout.transform", &memory::LayoutConfig::transform_bytes},
    {"layout.entry", &memory::LayoutConfig::entry_bytes},
    {"layout.primitive", &memory::LayoutConfig::primitive_bytes},
    {"layout.quadric", &memory::LayoutConfig::quadric_bytes},
    {"layout.material", &memory::LayoutConfig::material_bytes},
    {"layout.texel", &memory::LayoutConfig::texel_bytes},
    {"layout.pixel", &memory::LayoutConfig::pixel_bytes},
}};

constexpr auto& split_keys = processors::machine::split_size_keys;

void declare_node(Schema& schema) {
  schema.section("machine", "how many processors work on a frame, and how they share it");
  schema.choice("machine.scheme", "image", names(processors::machine::scheme_names),
                "the parallel scheme; image: a node takes a packet of neighbouring pixels and traces it "
                "whole; pipeline: nodes search, test or shade, and rays go round between them; space: a node "
                "holds a part of space, and rays go to the node whose part they enter");
  schema.integer("machine.clusters", 1, {1, processors::machine::most_nodes}, "",
                 "clusters, each with a copy of the database in its own shared memory");
  schema.integer("machine.nodes", 16, {1, processors::machine::most_nodes}, "",
                 "processor nodes in each cluster");
  schema.section(
      "node", "one processor node; a core works in order and stalls on a miss, unless it has other contexts");
  declare_node_kind(schema);
  clock(schema, "node.clock", "clock of the node and its cache");
  schema.size("node.word", "4 B", {"1 B", "64 B"}, "what one load or store moves");
  schema.choice(
      "node.pixels", "written", names(processors::machine::pixels_names),
      "image scheme: written: a node converts each finished pixel and writes it to the frame buffer; "
      "collected: the host takes it in no time, as where rays move");
  schema.integer("node.write_buffer", 4, {1, 4096}, "",
                 "posted pixel writes a node may have outstanding before it stalls");
  declare_context_keys(schema);
  declare_simt_keys(schema);
  schema.section("costs", "cycles of one operation; steps are priced by counted operation mixes");
  const std::vector<std::string> presets = sim::mapped(
      processors::cost::cost_presets(), [&](const std::string_view preset) { return std::string(preset); });
  schema.choice("costs.preset", processors::cost::default_cost_preset, presets,
                "the processor whose operation timings are taken, with its year; unit: one cycle each",
                processors::cost::renamed_cost_presets());
  for (const auto& [name, member] : operations) {
    schema.integer(name, -1, {-1, 1'000'000}, "cycles", "cycles of one such operation; -1: the preset's");
  }
}

void declare_memory(Schema& schema) {
  schema.section("layout", "sizes of the database's records and where they lie");
  const std::array<std::pair<std::string_view, std::string_view>, records.size()> sizes_of_records = {{
      {"8 B", "bytes of one node record; not with structure.kind = \"bvh\", whose nodes have their own"},
      {"64 B", "bytes of one instance that is kept: its transform and where its mesh begins"},
      {"4 B", "bytes of one entry record"},
      {"48 B", "bytes of one primitive record that is a triangle"},
      {"40 B", "bytes of one sphere, cylinder or cone: two points, two radii, kind and material"},
      {"64 B", "bytes of one material record"},
      {"4 B", "bytes of one texel record"},
      {"4 B", "bytes of one pixel record"},
  }};
  for (std::size_t i = 0; i < records.size(); ++i) {
    schema.size(records[i].first, sizes_of_records[i].first, {"1 B", "64 KiB"}, sizes_of_records[i].second);
  }
  schema.size("layout.record_alignment", "4 B", {"1 B", "4 KiB"}, "alignment of records; a power of two");
  schema.size("layout.section_alignment", "4 KiB", {"1 B", "1 GiB"},
              "alignment of the sections (nodes, lists, primitives, ...); a power of two");
  schema.choice("layout.node_order", "breadth_first", names(memory::node_order_names),
                "order of the tree's nodes in memory; treelets: subtrees of up to layout.treelet bytes, one "
                "after the other");
  schema.size("layout.treelet", "4 KiB", {"1 B", "1 GiB"},
              "treelets: most bytes of one, but the children of a node are never divided");
  schema.choice("layout.leaf", "list", names(memory::leaf_layout_names),
                "list: a leaf has a list of references to its primitives; inline (a bvh, SIMT nodes): its "
                "primitives lie in a row, one record for each reference");
  schema.section("cache", "the private cache of a node; it holds what is read of the database");
  schema.choice("cache.organisation", "unified", names(processors::machine::cache_organisation_names),
                "no cache, one for all records, or one each for nodes with transforms, lists, primitives and "
                "shading data");
  schema.size("cache.size", "16 KiB", {"1 B", "4 GiB"}, "size of the unified cache");
  const std::array<std::string_view, processors::machine::split_caches> sizes = {"4 KiB", "2 KiB", "8 KiB",
                                                                                 "2 KiB"};
  for (std::size_t i = 0; i < split_keys.size(); ++i) {
    schema.size(split_keys[i], sizes[i], {"1 B", "4 GiB"},
                "size of the split organisation's " + std::string(processors::machine::split_cache_names[i]) +
                    " cache");
  }
  schema.size("cache.line", "32 B", {"1 B", "1 GiB"}, "bytes of a line; a power of two");
  schema.integer("cache.ways", 4, {0, std::numeric_limits<std::int32_t>::max()}, "",
                 "lines of a set; 0: fully associative");
  schema.choice("cache.replacement", "lru", names(memory::replacement_names),
                "which line of a full set is replaced");
  schema.integer("cache.seed", 1, {0, std::numeric_limits<std::int64_t>::max()}, "",
                 "seed of random replacement");
  cycles(schema, "cache.hit_cycles", 1, "cycles of a reference that hits");
  declare_simt_cache_keys(schema);
  declare_second_level_keys(schema);
  declare_prefetch_keys(schema);
  schema.section("database", "where the scene database is");
  schema.choice("database.placement", "shared", names(processors::machine::placement_names),
                "shared: one copy in each cluster's memory; replicated: a copy in every node's own memory; "
                "distributed: one copy in each cluster, spread with the frame buffer over its nodes' own "
                "memories and reached over their network");
  schema.size("database.interleave", "0 B", {"0 B", "1 GiB"},
              "distributed: bytes in a row at one node, a power of two, at least a line; 0: a cache line, or "
              "32 B without a cache");
  schema.size(
      "database.header", "8 B", {"1 B", "64 KiB"},
      "distributed: bytes of a request to another node; data and writes carry as many beside their own");
  schema.section("local",
                 "a node's own memory, for a replicated or distributed database, private trees or a part of "
                 "space; only a distributed database's serves others");
  clock(schema, "local.clock", "clock of the local memory");
  schema.size("local.width", "8 B", {"1 B", "64 KiB"}, "bytes of a beat");
  cycles(schema, "local.access_cycles", 4, "cycles until the first beat");
  cycles(schema, "local.cycles_per_beat", 1, "cycles of each beat");
}

void declare_interconnect(Schema& schema) {
  schema.section("interconnect", "between the nodes of a cluster and its shared memory");
  schema.choice(
      "interconnect.kind", "bus", {"ideal", "bus", "crossbar"},
      "ideal: fixed latency, no queue; bus: one transaction at a time; crossbar: a queue for each bank");
  schema.choice("interconnect.mode", "split", {"held", "split"},
                "whether a read holds the bus while its bank works or asks for it again");
  schema.choice("interconnect.arbitration", "fifo", names(memory::arbitration_names),
                "bus: the order of grants; fifo: first come, first served; round_robin: nodes by turns; "
                "fixed_priority: data before requests, then the lowest node");
  clock(schema, "interconnect.clock", "clock of the interconnect");
  schema.size("interconnect.width", "8 B", {"1 B", "64 KiB"}, "bytes of a beat");
  cycles(schema, "interconnect.cycles_per_beat", 1, "cycles of each beat of data");
  cycles(schema, "interconnect.address_cycles", 1, "cycles to send an address over the bus");
  cycles(schema, "interconnect.latency_cycles", 10,
         "ideal: cycles of a whole read or write; crossbar: cycles one way");
  schema.section("memory", "the banks of a cluster's shared memory");
  declare_memory_model(schema);
  schema.integer("memory.banks", 4, {1, 65536}, "", "number of banks");
  schema.size("memory.interleave", "0 B", {"0 B", "1 GiB"},
              "bytes in a row that share a bank, a power of two, and without a cache the most that one "
              "reference reads; 0: a cache line, or 32 B without a cache");
  clock(schema, "memory.clock", "clock of the banks");
  cycles(schema, "memory.access_cycles", 4, "cycles from the start of an access to its data");
  cycles(schema, "memory.busy_cycles", 6, "cycles from the start of an access to the next");
  declare_dram_keys(schema);
}

void declare_host(Schema& schema) {
  schema.section("packets", "the rectangles of pixels that are handed out");
  schema.integer("packets.width", 8, {1, 65536}, "pixels",
                 "columns of a packet; of image.rays, a packet is width times height successive rays");
  schema.integer("packets.height", 8, {1, 65536}, "pixels", "rows of a packet");
  schema.choice("packets.order", "scanline", names(processors::machine::packet_order_names),
                "order of handing out");
  schema.section("host", "the processor that hands packets out");
  schema.choice(
      "host.assignment", "dynamic", names(processors::machine::assignment_names),
      "dynamic: a free node asks for the next packet; interleaved: node i of n has packets i, i + n, "
      "...; blocks: each node has a run of packets");
  clock(schema, "host.clock", "clock of the host");
  cycles(schema, "host.latency_cycles", 100,
         "cycles from a node's request to its packet; nodes ask when they are free, not before; where rays "
         "move, cycles until the first ray");
  cycles(schema, "host.occupancy_cycles", 0,
         "cycles that one request, or one camera ray, keeps the host from the next");
}

// Given rays follow one another in a single row, so a packet of them is a run of as many.
processors::machine::PacketConfig read_packets(sim::Config& config) {
  using processors::program::Integrator;
  processors::machine::PacketConfig packets{count(config, "packets.width"), count(config, "packets.height")};
  if (value_if_declared(config, "image.integrator") ==
      processors::program::integrator_names[static_cast<std::size_t>(Integrator::rays)]) {
    constexpr std::uint64_t most = scenes::most_given_rays;
    const std::uint64_t rays = std::uint64_t{packets.width} * packets.height;
    packets = {static_cast<std::uint32_t>(std::min(rays, most)), 1};
    config.mark_unused_reason("packets.order", "rays of a file are handed out in its order",
                              "image.integrator");
  } else {
    packets.order = config.choice_as<processors::machine::PacketOrder>("packets.order");
  }
  return packets;
}

// A size that must be a power of two.
std::uint32_t power_of_two(const sim::Config& config, std::string_view key) {
  const std::int64_t bytes = config.size(key);
  if (!std::has_single_bit(static_cast<std::uint64_t>(bytes))) {
    config.fail(key, "must be a power of two, not " + std::to_string(bytes) + " bytes");
  }
  return static_cast<std::uint32_t>(bytes);
}

void read_costs(const sim::Config& config, processors::machine::MachineConfig& machine) {
  machine.operations = processors::cost::cost_preset(config.choice_name("costs.preset"));
  for (const auto& [name, member] : operations) {
    const std::int64_t given = config.integer(name);
    if (given >= 0) {
      machine.operations.*member = given;
    }
  }
}

void read_layout(sim::Config& config, memory::LayoutConfig& layout) {
  const bool bvh = config.choice_name("structure.kind") == "bvh";
  for (const auto& [name, member] : records) {
    if (!bvh || member != &memory::LayoutConfig::node_bytes) {
      layout.*member = static_cast<std::uint32_t>(config.size(name));
    }
  }
  if (bvh) {
    layout.node_bytes =
        accel::bvh_record_bytes(config.choice_as<accel::BvhNodeKind>("structure.bvh_children"));
    config.mark_unused_reason("layout.node", "structure.bvh_children says how large the nodes of a bvh are",
                              "structure.kind");
  }
  layout.record_alignment = power_of_two(config, "layout.record_alignment");
  layout.section_alignment = power_of_two(config, "layout.section_alignment");
  layout.node_order = config.choice_as<memory::NodeOrder>("layout.node_order");
  if (layout.node_order == memory::NodeOrder::treelets) {
    layout.treelet_bytes = static_cast<std::uint32_t>(config.size("layout.treelet"));
  }
  config.mark_unused_reason("layout.treelet", "only layout.node_order = \"treelets\" makes treelets",
                            "layout.node_order");
}

void read_leaf_layout(sim::Config& config, processors::machine::MachineConfig& machine) {
  machine.layout.leaf = config.choice_as<memory::LeafLayout>("layout.leaf");
  if (machine.layout.leaf == memory::LeafLayout::list) {
    return;
  }
  if (config.choice_name("structure.kind") != "bvh") {
    config.fail("layout.leaf",
                "\"inline\" is for structure.kind = \"bvh\", each of whose primitives is in one leaf or few; "
                "use \"list\"");
  }
}

// Reads the size of one cache. A cache shape that cannot be built is reported under the size key.
void read_cache_size(const sim::Config& config, std::string_view key, const memory::CacheConfig& rest,
                     std::uint64_t& size) {
  memory::CacheConfig cache = rest;
  cache.size = static_cast<std::uint64_t>(config.size(key));
  try {
    (void)memory::shape_of(cache);
  } catch (const sim::UserError& error) {
    config.fail(key, error.what());
  }
  size = cache.size;
}

void read_cache(sim::Config& config, processors::machine::NodeCacheConfig& cache) {
  using processors::machine::CacheOrganisation;
  cache.organisation = config.choice_as<CacheOrganisation>("cache.organisation");
  if (cache.organisation == CacheOrganisation::none) {
    config.mark_unused_reason("cache", "it has no effect with cache.organisation = \"none\"",
                              "cache.organisation");
    return;
  }
  cache.cache.line = power_of_two(config, "cache.line");
  cache.cache.ways = count(config, "cache.ways");
  cache.cache.replacement = config.choice_as<memory::Replacement>("cache.replacement");
  cache.hit_cycles = config.integer("cache.hit_cycles");
  if (cache.cache.replacement == memory::Replacement::random) {
    cache.cache.seed = static_cast<std::uint64_t>(config.integer("cache.seed"));
  }
  config.mark_unused_reason("cache.seed", "only cache.replacement = \"random\" draws numbers",
                            "cache.replacement");
  if (cache.organisation == CacheOrganisation::unified) {
    read_cache_size(config, "cache.size", cache.cache, cache.cache.size);
  } else {
    config.mark_unused_reason("cache.size", "a split cache has cache.node_size, cache.list_size, ...",
                              "cache.organisation");
    for (std::size_t i = 0; i < split_keys.size(); ++i) {
      read_cache_size(config, split_keys[i], cache.cache, cache.split_sizes[i]);
    }
  }
  for (const std::string_view key : split_keys) {
    config.mark_unused_reason(key, "it has no effect without cache.organisation = \"split\"",
                              "cache.organisation");
  }
}

void read_distribution(const sim::Config& config, processors::machine::MachineConfig& machine) {
  processors::machine::DistributionConfig& distribution = machine.distribution;
  const std::uint32_t unit = machine.reference_bytes();
  distribution.interleave = unit;
  if (config.size("database.interleave") != 0) {
    distribution.interleave = power_of_two(config, "database.interleave");
  }
  if (distribution.interleave < unit) {
    config.fail("database.interleave", "must be at least what one reference reads, " + std::to_string(unit) +
                                           " bytes, so that no reference needs two nodes");
  }
  distribution.header_bytes = static_cast<std::uint32_t>(config.size("database.header"));
}

void read_local(sim::Config& config, processors::machine::MachineConfig& machine) {
  const bool space = machine.scheme == processors::machine::Scheme::space;
  if (!space) {
    machine.placement = config.choice_as<processors::machine::Placement>("database.placement");
  }
  if (space || machine.placement != processors::machine::Placement::shared ||
      machine.build.sharing == processors::machine::Sharing::private_trees) {
    machine.local.clock = clock(config, "local.clock");
    machine.local.width = static_cast<std::uint32_t>(config.size("local.width"));
    machine.local.access_cycles = config.integer("local.access_cycles");
    machine.local.cycles_per_beat = config.integer("local.cycles_per_beat");
  }
  config.mark_unused_reason(
      "local",
      "it has no effect without database.placement = \"replicated\" or \"distributed\", build.sharing = "
      "\"private\" or machine.scheme = \"space\"",
      "database.placement");
  if (machine.placement == processors::machine::Placement::distributed) {
    read_distribution(config, machine);
  }
  config.mark_unused_reason("database", "it has no effect without database.placement = \"distributed\"",
                            "database.placement");
}

void read_interconnect(sim::Config& config, processors::machine::MachineConfig& machine) {
  memory::InterconnectConfig& interconnect = machine.interconnect;
  if (machine.placement == processors::machine::Placement::distributed) {
    const std::string_view reason =
        "a distributed database is in the nodes' own memories ([local]) and reached over [network]";
    config.mark_unused_reason("interconnect", reason, "database.placement");
    config.mark_unused_reason("memory", reason, "database.placement");
    config.mark_unused_reason("dram", reason, "database.placement");
    return;
  }
  interconnect.kind = config.choice_as<memory::InterconnectKind>("interconnect.kind");
  interconnect.clock = clock(config, "interconnect.clock");
  const bool ideal = interconnect.kind == memory::InterconnectKind::ideal;
  const bool bus = interconnect.kind == memory::InterconnectKind::bus;
  if (bus) {
    interconnect.mode = config.choice_as<memory::BusMode>("interconnect.mode");
    interconnect.arbitration = config.choice_as<memory::Arbitration>("interconnect.arbitration");
    interconnect.address_cycles = config.integer("interconnect.address_cycles");
  } else {
    interconnect.latency_cycles = config.integer("interconnect.latency_cycles");
  }
  if (!ideal) {
    interconnect.width = static_cast<std::uint32_t>(config.size("interconnect.width"));
    interconnect.cycles_per_beat = config.integer("interconnect.cycles_per_beat");
    read_memory(config, machine);
    // Banks of DRAM are mapped by dram.mapping, so there it only says what one reference reads.
    const bool cached = machine.cache.organisation != processors::machine::CacheOrganisation::none;
    if ((!machine.banks.dram || !cached) && config.size("memory.interleave") != 0) {
      machine.banks.interleave = power_of_two(config, "memory.interleave");
    }
  }
  const std::string kind = "with interconnect.kind = \"" + config.choice_name("interconnect.kind") + "\"";
  config.mark_unused_reason("interconnect", "it has no effect " + kind, "interconnect.kind");
  if (ideal) {
    config.mark_unused_reason("memory", "there are no banks " + kind, "interconnect.kind");
    config.mark_unused_reason("dram", "there are no banks " + kind, "interconnect.kind");
  }
}

// Messages are sent where rays move from node to node, and for a distributed database.
void read_network_if_used(sim::Config& config, processors::machine::MachineConfig& machine) {
  if (machine.scheme != processors::machine::Scheme::image ||
      machine.placement == processors::machine::Placement::distributed) {
    machine.network = read_network(config);
    return;
  }
  config.mark_unused_reason(
      "network",
      "no messages are sent with machine.scheme = \"image\" and a database that is not distributed",
      config.assigned("machine.scheme") ? "machine.scheme" : "database.placement");
}

}  // namespace

void declare_machine_keys(sim::Schema& schema) {
  declare_node(schema);
  declare_memory(schema);
  declare_interconnect(schema);
  declare_network_keys(schema);
  declare_host(schema);
  declare_build_keys(schema);
  declare_count_keys(schema);
  declare_flow_keys(schema);
  declare_space_keys(schema);
  declare_energy_keys(schema);
}

processors::machine::MachineConfig read_machine(sim::Config& config) {
  settle_combinations(config);
  processors::machine::MachineConfig machine;
  machine.scheme = config.choice_as<processors::machine::Scheme>("machine.scheme");
  machine.clusters = count(config, "machine.clusters");
  machine.nodes = count(config, "machine.nodes");
  if (std::uint64_t{machine.clusters} * machine.nodes > processors::machine::most_nodes) {
    config.fail("machine.nodes", "clusters times nodes must be at most 2^24; " +
                                     std::to_string(machine.clusters) + " times " +
                                     std::to_string(machine.nodes) + " is more");
  }
  machine.clock = clock(config, "node.clock");
  machine.word_bytes = static_cast<std::uint32_t>(config.size("node.word"));
  const bool image = machine.scheme == processors::machine::Scheme::image;
  if (image) {
    machine.pixels = config.choice_as<processors::machine::Pixels>("node.pixels");
  }
  read_costs(config, machine);
  read_layout(config, machine.layout);
  read_cache(config, machine.cache);
  read_simt(config, machine);
  read_leaf_layout(config, machine);
  machine.build = read_build(config);
  if (image && (machine.pixels == processors::machine::Pixels::written ||
                machine.build.sharing != processors::machine::Sharing::given)) {
    machine.write_buffer = count(config, "node.write_buffer");
  }
  config.mark_unused_reason("node.write_buffer", "nodes write nothing",
                            image ? "node.pixels" : "machine.scheme");
  read_local(config, machine);
  read_contexts(config, machine);
  machine.banks.interleave = machine.reference_bytes();  // also of the one node that `space` is compared with
  if (machine.scheme != processors::machine::Scheme::space) {
    read_interconnect(config, machine);
  }
  read_second_level(config, machine);
  read_flow(config, machine);
  read_network_if_used(config, machine);
  read_space(config, machine);
  read_count(config, machine);
  read_energy(config, machine);
  machine.packets = read_packets(config);
  if (image) {
    machine.host.assignment = config.choice_as<processors::machine::Assignment>("host.assignment");
  }
  if (machine.host.assignment == processors::machine::Assignment::dynamic) {
    machine.host.clock = clock(config, "host.clock");
    machine.host.latency_cycles = config.integer("host.latency_cycles");
    machine.host.occupancy_cycles = config.integer("host.occupancy_cycles");
  }
  config.mark_unused_reason("host", "nodes ask nobody without host.assignment = \"dynamic\"",
                            "host.assignment");
  check_machine(config, machine);
  return machine;
}

void check_machine(const sim::Config& config, const processors::machine::MachineConfig& machine) {
  sim::with_places(config, [&] {
    processors::machine::check(machine);
    processors::energy::check_energy(machine);
  });
}

}  // namespace marti::studies::keys
