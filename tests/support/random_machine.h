// Random work logs and random machines for property tests: small, but with every kind of step and every
// kind of component.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <random>
#include <set>
#include <vector>

#include "memory/dram_presets.h"
#include "processors/machine/machine_config.h"
#include "processors/program/work_log.h"
#include "processors/walk/build_start.h"

namespace marti::test {

using Random = std::mt19937_64;

/// A uniform integer from lo to hi.
inline std::int64_t pick(Random& random, std::int64_t lo, std::int64_t hi) {
  return lo + static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(hi - lo + 1));
}

/// A tree of `branches` branches with eight children each and leaves of up to `most_entries` entries.
inline accel::Topology random_topology(Random& random, std::uint32_t branches, std::uint32_t primitives,
                                       std::uint32_t most_entries) {
  accel::Topology topology;
  topology.nodes.emplace_back();
  for (std::uint32_t node = 0; node < topology.nodes.size(); ++node) {
    const bool branch = branches > 0 && (node == 0 || pick(random, 0, 1) == 1);
    if (branch) {
      --branches;
      const auto first = static_cast<std::uint32_t>(topology.nodes.size());
      const auto level = static_cast<std::uint8_t>(topology.nodes[node].level + 1);
      topology.nodes[node] = {first, 8, topology.nodes[node].level, false};
      topology.nodes.insert(topology.nodes.end(), 8, accel::TopologyNode{0, 0, level, true});
    } else {
      const auto count = static_cast<std::uint32_t>(pick(random, 0, most_entries));
      topology.nodes[node].first = static_cast<std::uint32_t>(topology.entries.size());
      topology.nodes[node].count = count;
      for (std::uint32_t i = 0; i < count; ++i) {
        topology.entries.push_back(static_cast<std::uint32_t>(pick(random, 0, primitives - 1)));
      }
    }
  }
  return topology;
}

/// Makes up to four leaves instances of one or two meshes, which are appended; nothing without leaves below
/// the root.
inline void add_random_instances(Random& random, accel::Topology& topology, std::uint32_t primitives) {
  std::vector<std::uint32_t> leaves;
  for (std::uint32_t node = 1; node < topology.nodes.size(); ++node) {
    if (topology.nodes[node].leaf) {
      leaves.push_back(node);
    }
  }
  std::shuffle(leaves.begin(), leaves.end(), random);
  leaves.resize(std::min<std::size_t>(leaves.size(), static_cast<std::size_t>(pick(random, 1, 4))));
  std::uint8_t level = 1;
  for (const std::uint32_t leaf : leaves) {
    level = std::max(level, topology.nodes[leaf].level);
  }
  const std::size_t meshes = leaves.empty() ? 0 : pick(random, 1, std::min<std::size_t>(2, leaves.size()));
  std::vector<std::uint32_t> roots;
  for (std::size_t mesh = 0; mesh < meshes; ++mesh) {
    const auto root = static_cast<std::uint32_t>(topology.nodes.size());
    roots.push_back(root);
    const auto children = static_cast<std::uint32_t>(pick(random, 1, 5));
    topology.nodes.push_back({root + 1, children, static_cast<std::uint8_t>(level + 1), false});
    for (std::uint32_t child = 0; child < children; ++child) {
      const auto count = static_cast<std::uint32_t>(pick(random, 1, 3));
      topology.nodes.push_back({static_cast<std::uint32_t>(topology.entries.size()), count,
                                static_cast<std::uint8_t>(level + 2), true});
      for (std::uint32_t i = 0; i < count; ++i) {
        topology.entries.push_back(static_cast<std::uint32_t>(pick(random, 0, primitives - 1)));
      }
    }
  }
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    accel::TopologyNode& node = topology.nodes[leaves[i]];
    node = {roots[i < meshes ? i : random() % meshes], 1, node.level, false, true};
  }
}

/// Now and then a hit or two of the leaf before that were asked about. They follow from the words so far, so
/// that random machines are those of logs without them.
inline void append_any_hits(const processors::program::WorkLog& log, sim::ChunkVector<std::uint32_t>& words) {
  using processors::program::make_word;
  using processors::program::Step;
  const auto textures = static_cast<std::uint32_t>(log.texture_begin.size() - 1);
  Random random(words.size() * 7919 + words.back());
  for (std::int64_t left = random() % 4 == 0 ? pick(random, 1, 2) : 0; left > 0; --left) {
    const auto texture = static_cast<std::uint32_t>(random() % textures);
    const std::uint64_t texels = log.texture_begin[texture + 1] - log.texture_begin[texture];
    words.push_back(
        make_word(Step::any_hit, static_cast<std::uint32_t>(random() % (log.materials - log.voxels))));
    words.push_back(make_word(Step::texel, texture));
    words.push_back(static_cast<std::uint32_t>(random() % texels));
  }
}

/// A log whose words are random but valid. `instances`: a bounding volume hierarchy may have some.
inline processors::program::WorkLog random_log(Random& random, std::uint32_t width, std::uint32_t height,
                                               std::uint32_t most_words_a_pixel = 40,
                                               bool instances = false) {
  using processors::program::make_word;
  using processors::program::Step;
  processors::program::WorkLog log;
  log.width = width;
  log.height = height;
  log.traversal = static_cast<accel::Traversal>(pick(random, 0, accel::traversals - 1));
  log.mailboxes = pick(random, 0, 1) == 1;
  log.primitives = 50;
  const bool curved = pick(random, 0, 1) == 1;
  for (std::int64_t left = curved ? pick(random, 1, 40) : 0; left > 0; --left) {
    log.quadrics.push_back(pick(random, 0, 1) == 0 ? accel::PrimitiveKind::sphere
                                                   : accel::PrimitiveKind::cone);
  }
  log.materials = 5;
  log.voxels = 2;
  log.texture_begin = {0, 100, 356};
  log.topology = random_topology(random, 12, log.primitives, 6);
  if (instances && accel::walks_bvh(log.traversal) && random() % 4 != 0) {
    add_random_instances(random, log.topology, log.primitives);
  }
  std::vector<std::uint32_t> leaves;
  std::vector<std::uint32_t> branches;  // and instances
  for (std::uint32_t node = 0; node < log.topology.nodes.size(); ++node) {
    (log.topology.nodes[node].leaf ? leaves : branches).push_back(node);
  }
  log.rows.resize(height);
  for (processors::program::LogRow& row : log.rows) {
    for (std::uint32_t x = 0; x < width; ++x) {
      row.begin.push_back(static_cast<std::uint32_t>(row.words.size()));
      // Now and then a given ray that any hit will do for.
      const bool any = pick(random, 0, 7) == 0;
      row.words.push_back(any ? make_word(Step::ray, processors::program::ray_operand(
                                                         processors::program::RayKind::shadow, 0))
                              : processors::program::camera_ray);
      for (std::int64_t left = pick(random, 0, most_words_a_pixel); left > 0; --left) {
        const std::uint32_t leaf = leaves[random() % leaves.size()];
        switch (pick(random, 0, 10)) {
          case 0:
          case 1:
          case 2:
          case 3: {
            const std::uint32_t branch = branches[random() % branches.size()];
            row.words.push_back(
                make_word(log.topology.nodes[branch].instance ? Step::transform : Step::branch, branch));
            break;
          }
          case 4:
          case 5:
            row.words.push_back(make_word(Step::leaf, leaf));
            append_any_hits(log, row.words);
            break;
          case 6:
            if (log.mailboxes && log.topology.nodes[leaf].count > 0) {
              // A bit for each entry looked up, at least one of them not set.
              const auto read = static_cast<std::uint32_t>(pick(random, 1, log.topology.nodes[leaf].count));
              row.words.push_back(make_word(Step::mailed_leaf, leaf));
              row.words.push_back(read);
              row.words.push_back(static_cast<std::uint32_t>(pick(random, 0, (1 << read) - 2)));
            }
            if (log.topology.nodes[leaf].count > 1) {
              row.words.push_back(make_word(Step::partial_leaf, leaf));
              row.words.push_back(
                  static_cast<std::uint32_t>(pick(random, 1, log.topology.nodes[leaf].count - 1)));
              append_any_hits(log, row.words);
            }
            break;
          case 7:
            row.words.push_back(
                make_word(Step::ray, processors::program::ray_operand(
                                         static_cast<processors::program::RayKind>(pick(random, 0, 4)), 1)));
            break;
          case 8:
            row.words.push_back(make_word(Step::shade, static_cast<std::uint32_t>(pick(random, 0, 2))));
            row.words.push_back(make_word(Step::light, 0));
            break;
          case 9: {
            const auto voxel = static_cast<std::uint32_t>(pick(random, 3, 4));
            if (random() % 2 == 0) {
              row.words.insert(row.words.end(),
                               {make_word(Step::pass, voxel), make_word(Step::branch, branches[0])});
            } else if (log.topology.nodes[leaf].count > 0) {
              row.words.insert(row.words.end(), {make_word(Step::cut, leaf), make_word(Step::shade, voxel)});
            }
            break;
          }
          default: {
            const auto texture = static_cast<std::uint32_t>(pick(random, 0, 1));
            row.words.push_back(make_word(Step::texel, texture));
            row.words.push_back(static_cast<std::uint32_t>(pick(random, 0, texture == 0 ? 99 : 255)));
          }
        }
      }
    }
    row.begin.push_back(static_cast<std::uint32_t>(row.words.size()));
  }
  return log;
}

/// A log of an image of up to `most` pixels on each side, now and then with instances.
inline processors::program::WorkLog small_log(Random& random, std::int64_t most = 12) {
  const auto width = static_cast<std::uint32_t>(pick(random, 1, most));
  return random_log(random, width, static_cast<std::uint32_t>(pick(random, 1, most)), 40, true);
}

/// Random work for splitting each branch; a branch lists at least the primitives of its leaves.
inline void add_random_work(Random& random, accel::Topology& topology) {
  topology.work.resize(topology.nodes.size());
  std::vector<std::set<std::uint32_t>> below(topology.nodes.size());
  for (std::size_t at = topology.nodes.size(); at-- > 0;) {
    const accel::TopologyNode& node = topology.nodes[at];
    if (node.leaf) {
      const auto first = topology.entries.begin() + node.first;
      below[at].insert(first, first + node.count);
      topology.work[at] = {node.count, 0};
      continue;
    }
    for (std::uint32_t child = 0; child < node.count; ++child) {
      below[at].insert(below[node.first + child].begin(), below[node.first + child].end());
    }
    topology.work[at].listed = static_cast<std::uint32_t>(below[at].size()) +
                               static_cast<std::uint32_t>(std::max<std::int64_t>(0, pick(random, -4, 2)));
    topology.work[at].overlaps = static_cast<std::uint32_t>(pick(random, 0, 30));
  }
}

/// Appends a ray's walk from a node down: random children, each after its parent; with mailboxes some leaves
/// of which not all entries are tested.
inline void append_walk(Random& random, const processors::program::WorkLog& log, std::uint32_t number,
                        sim::ChunkVector<std::uint32_t>& words) {
  using processors::program::make_word;
  using processors::program::Step;
  const accel::TopologyNode& node = log.topology.nodes[number];
  if (random() % 8 == 0) {
    if (random() % 2 == 0 && (!node.leaf || node.count > 0)) {
      words.insert(words.end(), {make_word(Step::cut, number), make_word(Step::shade, 2)});
      return;
    }
    words.push_back(make_word(Step::pass, 2));
  }
  if (!node.leaf) {
    words.push_back(make_word(Step::branch, number));
    for (std::int64_t left = pick(random, 0, 3); left > 0; --left) {
      append_walk(random, log, node.first + static_cast<std::uint32_t>(random() % node.count), words);
    }
    return;
  }
  if (log.mailboxes && node.count > 0 && random() % 4 == 0) {
    const auto read = static_cast<std::uint32_t>(pick(random, 1, node.count));
    words.insert(words.end(), {make_word(Step::mailed_leaf, number), read,
                               static_cast<std::uint32_t>(pick(random, 0, (1 << read) - 2))});
  } else if (node.count > 1 && random() % 4 == 0) {
    words.push_back(make_word(Step::partial_leaf, number));
    words.push_back(static_cast<std::uint32_t>(pick(random, 0, node.count - 1)));
  } else {
    words.push_back(make_word(Step::leaf, number));
  }
  append_any_hits(log, words);
}

/// A log whose rays walk down from the root, with the work of splitting: a machine can build its tree.
inline processors::program::WorkLog random_tree_log(Random& random, std::uint32_t width,
                                                    std::uint32_t height) {
  using processors::program::make_word;
  using processors::program::Step;
  processors::program::WorkLog log;
  do {  // a bounding volume hierarchy is not built by machines
    log.traversal = static_cast<accel::Traversal>(pick(random, 0, accel::traversals - 1));
  } while (accel::walks_bvh(log.traversal));
  log.mailboxes = pick(random, 0, 1) == 1;
  log.width = width;
  log.height = height;
  log.primitives = 50;
  for (std::int64_t left = pick(random, 0, 20); left > 0; --left) {
    log.quadrics.push_back(pick(random, 0, 1) == 0 ? accel::PrimitiveKind::sphere
                                                   : accel::PrimitiveKind::cone);
  }
  log.materials = 3;
  log.voxels = 1;
  log.texture_begin = {0, 30};
  log.topology = random_topology(random, static_cast<std::uint32_t>(pick(random, 0, 14)), log.primitives, 6);
  add_random_work(random, log.topology);
  log.rows.resize(height);
  for (processors::program::LogRow& row : log.rows) {
    for (std::uint32_t x = 0; x < width; ++x) {
      row.begin.push_back(static_cast<std::uint32_t>(row.words.size()));
      for (std::int64_t rays = pick(random, 0, 3); rays > 0; --rays) {
        row.words.push_back(
            make_word(Step::ray, processors::program::ray_operand(
                                     static_cast<processors::program::RayKind>(pick(random, 0, 4)), 0)));
        append_walk(random, log, 0, row.words);
        if (random() % 2 == 0) {
          row.words.push_back(make_word(Step::shade, static_cast<std::uint32_t>(pick(random, 0, 1))));
        }
      }
    }
    row.begin.push_back(static_cast<std::uint32_t>(row.words.size()));
  }
  return log;
}

/// Any way to build the tree; never a given tree.
inline processors::machine::BuildConfig random_build(Random& random) {
  processors::machine::BuildConfig build;
  build.sharing = static_cast<processors::machine::Sharing>(pick(random, 1, 3));
  build.initial = static_cast<processors::machine::InitialTree>(pick(random, 0, 2));
  build.level = static_cast<std::uint32_t>(pick(random, 1, 5));
  build.rule_k = static_cast<double>(pick(random, 0, 40)) / 4.0;
  return build;
}

/// Start states that fit the tree, with branches kept from before among them.
inline std::vector<processors::walk::BranchStart> random_starts(Random& random,
                                                                const accel::Topology& topology,
                                                                bool may_be_lazy) {
  using processors::walk::BranchStart;
  std::vector<BranchStart> starts(topology.nodes.size(), BranchStart::kept);
  std::vector<bool> below_lazy(topology.nodes.size());
  for (std::size_t number = 0; number < starts.size(); ++number) {
    const accel::TopologyNode& node = topology.nodes[number];
    if (!node.leaf) {
      starts[number] = below_lazy[number] ? BranchStart::lazy
                                          : static_cast<BranchStart>(pick(random, 0, may_be_lazy ? 2 : 1));
      for (std::uint32_t child = 0; child < node.count; ++child) {
        below_lazy[node.first + child] = starts[number] == BranchStart::lazy;
      }
    }
  }
  return starts;
}

/// Tree-PLRU needs a power of two of ways, and so here of lines.
inline void make_possible(memory::CacheConfig& cache) {
  if (cache.replacement == memory::Replacement::plru) {
    cache.ways = std::bit_floor(cache.ways);
    cache.size = std::bit_floor(cache.size);
  }
}

/// Any second level that the machine can have.
inline void add_random_second_level(Random& random, processors::machine::MachineConfig& machine) {
  using processors::machine::SecondLevel;
  machine.l2.sharing = static_cast<SecondLevel>(pick(random, 0, 2));
  machine.l2.hit_cycles = pick(random, 0, 3);
  // Half of them beside a clock of their own.
  if (random() % 2 == 0) {
    machine.l2.clock = sim::Clock::from_period(pick(random, 1, 40));
  }
  memory::CacheConfig& cache = machine.l2.cache;
  const bool none = machine.cache.organisation == processors::machine::CacheOrganisation::none;
  cache.line = none ? machine.banks.interleave : machine.cache.cache.line;
  cache.replacement = static_cast<memory::Replacement>(
      pick(random, 0, static_cast<int>(memory::replacement_names.size()) - 1));
  cache.ways = static_cast<std::uint32_t>(std::array{0, 1, 2, 4, 6, 8, 32}[random() % 7]);
  cache.size =
      std::uint64_t{cache.line} * std::max(1U, cache.ways) * static_cast<std::uint64_t>(pick(random, 1, 12));
  make_possible(cache);
  const bool shared_reads = machine.placement == processors::machine::Placement::shared &&
                            machine.interconnect.kind != memory::InterconnectKind::ideal;
  if ((machine.l2.sharing == SecondLevel::private_caches && none) ||
      (machine.l2.sharing == SecondLevel::shared && !shared_reads)) {
    machine.l2.sharing = SecondLevel::none;
  }
}

/// Any machine the configuration allows, with at most `most_nodes` nodes.
inline processors::machine::MachineConfig random_machine(Random& random, std::uint32_t most_nodes = 12) {
  processors::machine::MachineConfig machine;
  machine.clusters = static_cast<std::uint32_t>(pick(random, 1, 3));
  machine.nodes =
      static_cast<std::uint32_t>(pick(random, 1, std::max<std::int64_t>(1, most_nodes / machine.clusters)));
  machine.clock = sim::Clock::from_period(pick(random, 1, 40));
  machine.operations = {pick(random, 0, 4), pick(random, 0, 4), pick(random, 0, 9), pick(random, 0, 9),
                        pick(random, 0, 2), pick(random, 0, 2), pick(random, 0, 2), pick(random, 0, 2)};
  machine.write_buffer = static_cast<std::uint32_t>(pick(random, 1, 3));
  machine.layout.node_bytes = static_cast<std::uint32_t>(pick(random, 1, 40));
  machine.layout.transform_bytes = static_cast<std::uint32_t>(pick(random, 1, 70));
  machine.layout.primitive_bytes = static_cast<std::uint32_t>(pick(random, 1, 100));
  machine.layout.quadric_bytes = static_cast<std::uint32_t>(pick(random, 1, 100));
  machine.layout.node_order = static_cast<memory::NodeOrder>(pick(random, 0, 2));
  machine.layout.treelet_bytes = static_cast<std::uint32_t>(pick(random, 1, 400));
  machine.layout.record_alignment = 1U << pick(random, 0, 6);
  machine.cache.organisation = static_cast<processors::machine::CacheOrganisation>(pick(random, 0, 2));
  machine.cache.hit_cycles = pick(random, 0, 2);
  machine.cache.cache.line = 1U << pick(random, 2, 6);
  machine.cache.cache.replacement = static_cast<memory::Replacement>(
      pick(random, 0, static_cast<int>(memory::replacement_names.size()) - 1));
  machine.cache.cache.ways = static_cast<std::uint32_t>(std::array{0, 1, 2, 3, 4, 8, 24}[random() % 7]);
  const std::uint32_t ways = std::max(1U, machine.cache.cache.ways);
  machine.cache.cache.size =
      std::uint64_t{machine.cache.cache.line} * ways * static_cast<std::uint64_t>(pick(random, 1, 9));
  for (std::uint64_t& size : machine.cache.split_sizes) {
    size = std::uint64_t{machine.cache.cache.line} * ways * static_cast<std::uint64_t>(pick(random, 1, 5));
  }
  make_possible(machine.cache.cache);
  if (machine.cache.cache.replacement == memory::Replacement::plru) {
    for (std::uint64_t& size : machine.cache.split_sizes) {
      size = std::bit_floor(size);
    }
  }
  machine.placement = static_cast<processors::machine::Placement>(pick(random, 0, 3) == 0 ? 1 : 0);
  machine.local.access_cycles = pick(random, 0, 5);
  machine.local.clock = sim::Clock::from_period(pick(random, 1, 40));
  machine.interconnect.kind = static_cast<memory::InterconnectKind>(pick(random, 0, 2));
  machine.interconnect.mode = static_cast<memory::BusMode>(pick(random, 0, 1));
  machine.interconnect.clock = sim::Clock::from_period(pick(random, 1, 40));
  machine.interconnect.width = static_cast<std::uint32_t>(pick(random, 1, 16));
  machine.interconnect.cycles_per_beat = pick(random, 0, 2);
  machine.interconnect.address_cycles = pick(random, 0, 2);
  machine.interconnect.latency_cycles = pick(random, 0, 12);
  machine.banks.count = static_cast<std::uint32_t>(pick(random, 1, 5));
  machine.banks.interleave = 1U << pick(random, 2, 6);
  machine.banks.clock = sim::Clock::from_period(pick(random, 1, 40));
  machine.banks.access_cycles = pick(random, 0, 6);
  machine.banks.busy_cycles = pick(random, 0, 9);
  machine.packets.width = static_cast<std::uint32_t>(pick(random, 1, 5));
  machine.packets.height = static_cast<std::uint32_t>(pick(random, 1, 5));
  machine.packets.order = static_cast<processors::machine::PacketOrder>(pick(random, 0, 2));
  machine.host.assignment = static_cast<processors::machine::Assignment>(pick(random, 0, 2));
  machine.host.clock = sim::Clock::from_period(pick(random, 1, 40));
  machine.host.latency_cycles = pick(random, 0, 20);
  machine.host.occupancy_cycles = pick(random, 0, 5);
  machine.interconnect.arbitration = static_cast<memory::Arbitration>(pick(random, 0, 2));
  if (machine.placement == processors::machine::Placement::shared && pick(random, 0, 3) == 0) {
    machine.placement = processors::machine::Placement::distributed;
  }
  const std::uint32_t unit = machine.cache.organisation == processors::machine::CacheOrganisation::none
                                 ? machine.banks.interleave
                                 : machine.cache.cache.line;
  machine.distribution.interleave = unit << pick(random, 0, 4);
  machine.distribution.header_bytes = static_cast<std::uint32_t>(pick(random, 1, 16));
  machine.network.kind = static_cast<memory::NetworkKind>(pick(random, 0, 4));
  machine.network.clock = sim::Clock::from_period(pick(random, 1, 40));
  machine.network.width = static_cast<std::uint32_t>(pick(random, 1, 16));
  machine.network.cycles_per_beat = pick(random, 0, 2);
  machine.network.hop_cycles = pick(random, 0, 4);
  return machine;
}

/// Now and then a memory of DRAM, of any kind that the machine can have. Call it last.
inline void add_random_dram(Random& random, processors::machine::MachineConfig& machine) {
  if (machine.placement != processors::machine::Placement::shared ||
      machine.scheme == processors::machine::Scheme::space ||
      machine.interconnect.kind == memory::InterconnectKind::ideal || pick(random, 0, 2) > 0) {
    return;
  }
  memory::DramConfig dram = memory::dram_preset(
      static_cast<std::size_t>(pick(random, 0, static_cast<int>(memory::dram_preset_names.size()) - 1)));
  dram.period = pick(random, 1, 40);
  dram.channels = 1U << pick(random, 0, 2);
  dram.ranks = 1U << pick(random, 0, 1);
  dram.banks = 1U << pick(random, 0, 2);
  dram.burst_bytes = 1U << pick(random, 3, 6);
  dram.row_bytes = 1U << pick(random, 6, 9);
  dram.page = static_cast<memory::DramPage>(pick(random, 0, 1));
  dram.queue = static_cast<std::uint32_t>(pick(random, 1, 16));
  dram.reorder_cap = static_cast<std::uint32_t>(pick(random, 0, 4));
  dram.timing.refi = pick(random, 0, 1) == 0 ? 0 : dram.timing.refi;
  const bool held = machine.interconnect.kind == memory::InterconnectKind::bus &&
                    machine.interconnect.mode == memory::BusMode::held;
  if (!held && machine.build.sharing != processors::machine::Sharing::shared) {
    dram.policy = static_cast<memory::DramPolicy>(pick(random, 0, 1));
  }
  machine.banks.dram = dram;
}

/// Any contexts and prefetching that the machine can have; `tree`: the log's walk is that of a tree.
inline void add_random_contexts(Random& random, bool tree, processors::machine::MachineConfig& machine) {
  add_random_second_level(random, machine);
  machine.contexts = static_cast<std::uint32_t>(pick(random, 1, 5));
  machine.switch_cycles = pick(random, 0, 6);
  if (machine.placement != processors::machine::Placement::replicated &&
      machine.cache.organisation != processors::machine::CacheOrganisation::none) {
    machine.prefetch.next_line = random() % 2 == 0;
    machine.prefetch.children = tree && random() % 2 == 0;
    machine.prefetch.outstanding = static_cast<std::uint32_t>(pick(random, 1, 4));
  }
}

/// A tree that is built while others read it takes one memory that serves in the order of asking.
inline void share_in_order(processors::machine::MachineConfig& machine) {
  machine.placement = processors::machine::Placement::shared;
  machine.interconnect.arbitration = memory::Arbitration::fifo;
}

/// Any way to build the tree on the machine, with records so close now and then that those of all kinds share
/// lines with nodes that are still to be built.
inline void add_random_build(Random& random, processors::machine::MachineConfig& machine) {
  machine.build = random_build(random);
  if (machine.build.sharing == processors::machine::Sharing::shared) {
    share_in_order(machine);
  }
  add_random_second_level(random, machine);
  if (random() % 3 == 0) {
    machine.layout.section_alignment = 1U << pick(random, 0, 4);
  }
}

}  // namespace marti::test
