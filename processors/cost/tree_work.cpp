#include "processors/cost/tree_work.h"

#include <algorithm>
#include <cstddef>

#include "processors/cost/cost_model.h"
#include "processors/cost/step_time.h"

namespace marti::processors::cost {

namespace {

using sim::add_ticks;

std::int64_t times(std::uint64_t count, std::int64_t each) {
  return sim::multiply_ticks(each, static_cast<std::int64_t>(count));
}

std::uint64_t ceil_divided(std::uint64_t count, std::uint64_t by) { return count / by + (count % by != 0); }

// Words of a reference.
std::int64_t reference_words(const machine::MachineConfig& config) {
  return static_cast<std::int64_t>(ceil_divided(bvh_reference_bytes, config.word_bytes));
}

// To sort a reference.
std::int64_t sorting_cycles(const machine::MachineConfig& config) {
  return price(bvh_mixes().sorted, config.operations,
               fetch_record(config.operations, reference_words(config)));
}

// On each level a reference has to be sorted before one of the next level can be, or a record be fitted after
// one of the level below.
std::int64_t following_cycles(const TreeWork& work, const machine::MachineConfig& config) {
  const std::int64_t words = record_words(config).node;
  const std::int64_t record =
      add_ticks(fetch_record(config.operations, words), store_record(config.operations, words));
  return std::max(times(work.build.levels, sorting_cycles(config)), times(work.levels, record));
}

std::int64_t all_cycles(const TreeWork& work, const machine::MachineConfig& config) {
  const machine::OperationCycles& cycles = config.operations;
  const RecordWords words = record_words(config);
  const std::int64_t reference = reference_words(config);
  const BvhMixes& mixes = bvh_mixes();
  const auto fetch = [&](std::int64_t of) { return fetch_record(cycles, of); };
  const auto store = [&](std::int64_t of) { return store_record(cycles, of); };
  std::int64_t sum = 0;
  const auto add = [&sum](std::uint64_t count, std::int64_t each) {
    sum = add_ticks(sum, times(count, each));
  };
  add(work.triangles, price(mixes.bounded, cycles, fetch(words.primitive)));
  add(work.quadrics, price(mixes.bounded, cycles, fetch(words.quadric)));
  add(work.instances, price(mixes.placed, cycles, add_ticks(fetch(words.transform), store(words.transform))));
  for (const accel::BvhSplits& splits : work.build.by_size) {
    add(splits.references, sorting_cycles(config));
    add(splits.planes, price(mixes.plane, cycles, 0));
    add(splits.moved, add_ticks(fetch(reference), store(reference)));
  }
  add(work.merged, price(mixes.merged, cycles, 0));
  add(work.branches, add_ticks(store(words.node), work.refits ? fetch(words.node) : 0));
  const bool listed = config.layout.leaf == memory::LeafLayout::list;
  if (listed) {
    add(work.triangles + work.quadrics, work.refits ? fetch(words.entry) : store(words.entry));
  } else if (!work.refits) {
    add(work.triangles, store(words.primitive));
    add(work.quadrics, store(words.quadric));
  }
  return sum;
}

// Of all caches that are used by the nodes which make one copy of the tree. Of each cache no more than the
// references of 2^32 primitives need.
std::uint64_t cache_bytes(const machine::MachineConfig& config, std::uint64_t nodes) {
  constexpr std::uint64_t most = std::uint64_t{bvh_reference_bytes} << 32U;
  std::uint64_t of_node = 0;
  for (const machine::FirstLevelCache& first : machine::first_level_caches(config.cache)) {
    of_node += std::min(first.cache.size, most);
  }
  const std::uint64_t second = std::min(config.l2.cache.size, most);
  switch (config.l2.sharing) {
    case machine::SecondLevel::private_caches:
      return nodes * (of_node + second);
    case machine::SecondLevel::shared:
      return nodes * of_node + second;
    case machine::SecondLevel::none:
      break;
  }
  return nodes * of_node;
}

void add_bytes(const TreeWork& work, const machine::MachineConfig& config, std::uint64_t nodes,
               LeastTime& least) {
  const memory::LayoutConfig& layout = config.layout;
  const std::uint64_t primitives =
      work.triangles * layout.primitive_bytes + work.quadrics * layout.quadric_bytes;
  const std::uint64_t entries = (work.triangles + work.quadrics) * layout.entry_bytes;
  const bool listed = layout.leaf == memory::LeafLayout::list;
  least.read = primitives + work.instances * layout.transform_bytes;
  least.written = work.branches * layout.node_bytes + work.instances * layout.transform_bytes;
  if (work.refits) {
    least.read += work.branches * layout.node_bytes + (listed ? entries : 0);
  } else {
    least.written += listed ? entries : primitives;
  }
  // Of the nodes of one size together, as much of each as the caches hold need not be read or written.
  const std::uint64_t caches = cache_bytes(config, nodes);
  for (std::size_t size = 0; size < work.build.by_size.size(); ++size) {
    const accel::BvhSplits& splits = work.build.by_size[size];
    const std::uint64_t largest = std::uint64_t{bvh_reference_bytes} << size;
    const std::uint64_t held = splits.nodes * std::min(caches, largest);
    const auto beyond = [&](std::uint64_t references) {
      const std::uint64_t bytes = references * bvh_reference_bytes;
      return bytes > held ? bytes - held : 0;
    };
    least.read += beyond(splits.references);
    least.written += beyond(splits.moved);
  }
}

// Of accesses to `memories` that serve one at a time, each of at most `unit` bytes.
sim::Ticks access_time(std::uint64_t bytes, std::uint64_t unit, std::uint64_t memories, sim::Ticks each) {
  return times(ceil_divided(ceil_divided(bytes, unit), memories), each);
}

sim::Ticks beat_time(std::uint64_t bytes, std::uint32_t width, const sim::Clock& clock,
                     std::int64_t cycles_per_beat) {
  return clock.cycles(times(ceil_divided(bytes, width), cycles_per_beat));
}

// What a node's own memory takes, of `memories` that are used at the same time.
sim::Ticks local_time(std::uint64_t bytes, std::uint64_t memories, const machine::MachineConfig& config) {
  const std::uint64_t unit = std::max(config.reference_bytes(), config.distribution.interleave);
  const machine::LocalMemoryConfig& local = config.local;
  return add_ticks(access_time(bytes, unit, memories, local.clock.cycles(local.access_cycles)),
                   beat_time(bytes / memories, local.width, local.clock, local.cycles_per_beat));
}

sim::Ticks link_time(std::uint64_t read, std::uint64_t written, const machine::MachineConfig& config) {
  const memory::InterconnectConfig& links = config.interconnect;
  switch (links.kind) {
    case memory::InterconnectKind::bus:
      return beat_time(read + written, links.width, links.clock, links.cycles_per_beat);
    case memory::InterconnectKind::crossbar:  // what is written has a path of its own
      return beat_time(read / config.banks.banks(), links.width, links.clock, links.cycles_per_beat);
    case memory::InterconnectKind::ideal:
      break;
  }
  return 0;
}

sim::Ticks bank_time(std::uint64_t bytes, const machine::MachineConfig& config) {
  const memory::BankConfig& banks = config.banks;
  if (config.interconnect.kind == memory::InterconnectKind::ideal) {
    return 0;
  }
  if (banks.dram) {
    return access_time(bytes, banks.dram->burst_bytes, banks.banks(), banks.dram->burst_time());
  }
  const std::uint64_t unit = std::max(config.reference_bytes(), banks.interleave);
  return access_time(bytes, unit, banks.banks(),
                     banks.clock.cycles(std::min(banks.busy_cycles, banks.access_cycles)));
}

}  // namespace

const BvhMixes& bvh_mixes() {
  // Columns: add, multiply, divide, square root, compare, integer.
  static constexpr BvhMixes table{
      .bounded = {6000, 6000, 0, 0, 18000, 0},
      .placed = {18000, 18000, 0, 0, 18000, 0},
      .sorted = {9000, 3000, 0, 0, 24000, 6000},
      .plane = {11084, 8000, 84, 0, 15084, 2000},
      .merged = {0, 0, 0, 0, 6000, 0},
  };
  return table;
}

sim::Ticks least_transfer(std::uint64_t read, std::uint64_t written, const machine::MachineConfig& config) {
  const std::uint64_t bytes = read + written;
  switch (config.placement) {
    case machine::Placement::replicated:
      return local_time(bytes, 1, config);
    case machine::Placement::distributed:
      return local_time(bytes, config.nodes, config);
    case machine::Placement::shared:
      break;
  }
  return config.scheme == machine::Scheme::space
             ? 0
             : std::max(link_time(read, written, config), bank_time(bytes, config));
}

LeastTime least_time(const TreeWork& work, const machine::MachineConfig& config) {
  const bool alone = config.placement == machine::Placement::replicated;
  const std::uint64_t nodes = alone ? 1 : config.nodes;
  const std::uint64_t at_once =
      config.kind == machine::NodeKind::simt ? std::uint64_t{config.simt.lanes} * config.simt.issue : 1;
  LeastTime least;
  const std::uint64_t shared =
      ceil_divided(static_cast<std::uint64_t>(all_cycles(work, config)), nodes * at_once);
  least.compute =
      config.clock.cycles(std::max(static_cast<std::int64_t>(shared), following_cycles(work, config)));
  add_bytes(work, config, nodes, least);
  least.memory = least_transfer(least.read, least.written, config);
  return least;
}

}  // namespace marti::processors::cost
