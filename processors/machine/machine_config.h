// A whole simulated machine, as values. Defaults are those of the configuration reference, except that each
// operation takes one cycle.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "memory/bank.h"
#include "memory/cache_config.h"
#include "memory/interconnect.h"
#include "memory/layout.h"
#include "memory/network.h"
#include "processors/machine/build_config.h"
#include "processors/machine/context_config.h"
#include "processors/machine/count_config.h"
#include "processors/machine/energy_config.h"
#include "processors/machine/flow_config.h"
#include "processors/machine/host_config.h"
#include "processors/machine/operation_cycles.h"
#include "processors/machine/packets.h"
#include "processors/machine/second_level_config.h"
#include "processors/machine/simt_config.h"
#include "sim/time.h"

namespace marti::processors::machine {

/// Where the database is. shared: one copy in the cluster's memory behind its interconnect. replicated: a
/// full copy in every node's own memory; only pixels cross the interconnect. distributed: one copy, frame
/// buffer included, spread over the memories of the cluster's nodes and reached over their network.
enum class Placement : std::uint8_t { shared, replicated, distributed };
inline constexpr std::array<std::string_view, 3> placement_names = {"shared", "replicated", "distributed"};

/// How a distributed database is spread over the nodes. Access times are those of LocalMemoryConfig.
struct DistributionConfig {
  std::uint32_t interleave = 32;   ///< bytes in a row at one node; a power of two, at least a line
  std::uint32_t header_bytes = 8;  ///< of each message; a request consists of a header only
};

/// none: every reference goes to memory. unified: one cache for all records. split: one for nodes, one for
/// object lists, one for primitives, one for materials and texels, each with its own size.
enum class CacheOrganisation : std::uint8_t { none, unified, split };
inline constexpr std::array<std::string_view, 3> cache_organisation_names = {"none", "unified", "split"};

/// The caches of a split organisation, in this order.
inline constexpr std::size_t split_caches = 4;
inline constexpr std::array<std::string_view, split_caches> split_cache_names = {"node", "list", "primitive",
                                                                                 "shading"};
inline constexpr std::array<std::string_view, split_caches> split_size_keys = {
    "cache.node_size", "cache.list_size", "cache.primitive_size", "cache.shading_size"};

struct NodeCacheConfig {
  CacheOrganisation organisation = CacheOrganisation::unified;
  memory::CacheConfig cache;  ///< size is that of the unified cache
  std::array<std::uint64_t, split_caches> split_sizes = {4096, 2048, 8192, 2048};  ///< bytes
  std::int64_t hit_cycles = 1;
};

struct FirstLevelCache {
  memory::CacheConfig cache;
  std::string_view size_key;  ///< "cache.size" or one of split_size_keys
};

/// The caches of one node: none, the unified one, or the split ones in the order of split_cache_names.
[[nodiscard]] std::vector<FirstLevelCache> first_level_caches(const NodeCacheConfig& config);

/// The memory of a replicated database or of private trees: no contention, a line takes `access_cycles` plus
/// its beats. A distributed database's memory takes as long, but serves one access after the other.
struct LocalMemoryConfig {
  sim::Clock clock = sim::Clock::from_hertz(33e6);
  std::uint32_t width = 8;  ///< bytes a beat
  std::int64_t access_cycles = 4;
  std::int64_t cycles_per_beat = 1;
};

/// What becomes of a finished pixel in the image scheme. written: its node converts it and writes it to the
/// frame buffer. collected: the host takes it and no time passes, as it takes contributions where rays move.
enum class Pixels : std::uint8_t { written, collected };
inline constexpr std::array<std::string_view, 2> pixels_names = {"written", "collected"};

struct MachineConfig {
  std::uint32_t clusters = 1;
  std::uint32_t nodes = 16;  ///< in each cluster
  NodeKind kind = NodeKind::core;
  SimtConfig simt;  ///< nodes of kind simt
  RtUnitConfig rt;  ///< nodes of kind simt
  sim::Clock clock = sim::Clock::from_hertz(33e6);
  OperationCycles operations;
  std::uint32_t word_bytes = 4;  ///< what one load or store moves
  Pixels pixels = Pixels::written;
  std::uint32_t write_buffer = 4;  ///< posted pixel writes a node may have outstanding, at least 1
  std::uint32_t contexts = 1;      ///< packets a node works on by turns, 1 to most_contexts
  std::int64_t switch_cycles = 1;  ///< of the node's clock, to take up another context
  PrefetchConfig prefetch;
  memory::LayoutConfig layout;
  NodeCacheConfig cache;
  SecondLevelConfig l2;
  Placement placement = Placement::shared;
  DistributionConfig distribution;
  LocalMemoryConfig local;
  memory::InterconnectConfig interconnect;
  memory::BankConfig banks;
  PacketConfig packets;
  HostConfig host;
  BuildConfig build;
  Scheme scheme = Scheme::image;
  memory::NetworkConfig network;  ///< pipeline, space and a distributed database
  MessageConfig messages;         ///< pipeline and space
  PipelineConfig pipeline;
  SpaceConfig space;
  CountConfig count;
  EnergyConfig energy;

  [[nodiscard]] std::uint32_t all_nodes() const { return clusters * nodes; }
  [[nodiscard]] bool has_rt_unit() const { return kind == NodeKind::simt && rt.warps > 0; }
  /// Bytes that one reference reads at most: a cache line or its sector, or an interleave of the banks
  /// without a cache.
  [[nodiscard]] std::uint32_t reference_bytes() const {
    if (cache.organisation == CacheOrganisation::none) {
      return banks.interleave;
    }
    return kind == NodeKind::simt && simt.sector != 0 ? simt.sector : cache.cache.line;
  }
  /// Reads that a node may have outstanding: one for each context and one for each prefetch, or one for each
  /// line that a SIMT node may have under way.
  [[nodiscard]] std::uint32_t ports_of_node() const {
    return kind == NodeKind::simt ? simt.mshrs : contexts + (prefetch.on() ? prefetch.outstanding : 0);
  }
};

/// The machine that a speed-up is measured against: `config` with one cluster of one node, which does the
/// same work. A pipeline has a node for each stage at least, so its one node traces packets: all that there
/// are, with the pipeline's memory, and it writes no pixels, as the pipeline does not.
[[nodiscard]] MachineConfig one_node_of(const MachineConfig& config);

/// The most nodes a machine may have; event keys and node tables are sized by it.
inline constexpr std::uint32_t most_nodes = 1U << 24U;

/// The part of check() for contexts and prefetching.
void check_contexts(const MachineConfig& config);

/// The part of check() for all schemes other than image; checks nothing for the image scheme.
void check_flow(const MachineConfig& config);

/// The second-level cache of `config`, with the line size that it gets on this machine.
[[nodiscard]] memory::CacheConfig second_level_cache(const MachineConfig& config);

/// Throws UserError when the machine cannot have the second level that it asks for.
void check_second_level(const MachineConfig& config);

/// Throws UserError when the machine cannot count what it is asked to.
void check_counting(const MachineConfig& config);

/// Whether the end of a write may be known only after the write was issued. Such a memory system does not
/// serve its transactions in the order in which they are made.
[[nodiscard]] bool writes_done_later(const MachineConfig& config);

/// Throws UserError with the reason when the machine cannot be built.
void check(const MachineConfig& config);

}  // namespace marti::processors::machine
