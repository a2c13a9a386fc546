#include "processors/replay/host_bytes.h"

#include <algorithm>
#include <optional>

#include "memory/cache.h"
#include "memory/tags.h"
#include "processors/cost/accounting.h"
#include "processors/machine/packets.h"
#include "processors/node/build_result.h"
#include "processors/node/dynamic_cursor.h"
#include "processors/node/tree_copies.h"
#include "processors/node/work_ahead.h"
#include "processors/replay/replay.h"
#include "processors/simt/lane_walk.h"
#include "processors/simt/shared_rays.h"
#include "processors/simt/warp.h"
#include "processors/walk/cache_counting.h"
#include "processors/walk/log_cursor.h"
#include "processors/walk/record_places.h"
#include "sim/event_queue.h"

namespace marti::processors::replay {

namespace {

std::uint64_t tag_bytes(const memory::CacheConfig& cache) {
  const memory::CacheShape shape = memory::shape_of(cache);
  // Hashed sets keep a list entry and two to four table slots for each line.
  const std::uint64_t bytes_a_line = shape.ways > memory::most_searched_ways ? 28 : 6;
  const std::uint64_t bytes_a_set = memory::with_policy(cache.replacement, [&]<memory::Replacement Policy>() {
    return memory::VictimsOf<Policy>::bytes_a_set(shape.ways);
  });
  return shape.lines() * bytes_a_line + shape.sets * bytes_a_set;
}

}  // namespace

machine::MachineConfig without_idle_contexts(const machine::MachineConfig& config, std::uint32_t width,
                                             std::uint32_t height) {
  machine::MachineConfig used = config;
  // Where the tree is built, nodes ask when they have built their part, one before another.
  if (config.contexts > 1 && config.build.sharing == machine::Sharing::given) {
    const std::uint64_t packets = machine::packets_of_image(width, height, config.packets);
    const std::uint64_t each = (packets + config.all_nodes() - 1) / config.all_nodes();
    used.contexts = static_cast<std::uint32_t>(std::clamp<std::uint64_t>(each, 1, config.contexts));
  }
  return used;
}

std::uint64_t host_bytes(const machine::MachineConfig& machine, std::uint32_t width, std::uint32_t height) {
  const machine::MachineConfig config = without_idle_contexts(machine, width, height);
  // A node's counts, while it runs and in the result, and its cursor, event and place in the posting order.
  constexpr std::uint64_t bytes_a_node =
      2 * sizeof(cost::NodeStatistics) + sizeof(walk::Cursor) + sim::EventQueue::bytes_an_event + 8;
  const bool many = config.all_nodes() >= ReplayOptions().fewest_nodes_of_threads;
  const std::uint64_t ahead = many && node::why_not_ahead(config) == nullptr ? sizeof(node::Ahead) + 4 : 0;
  std::uint64_t tags = 0;
  for (const machine::FirstLevelCache& first : machine::first_level_caches(config.cache)) {
    tags += tag_bytes(first.cache);
  }
  if (config.l2.sharing == machine::SecondLevel::private_caches) {
    tags += tag_bytes(machine::second_level_cache(config)) + sizeof(memory::CacheCounters);
  }
  std::uint64_t homes = config.l2.sharing == machine::SecondLevel::shared
                            ? config.clusters * tag_bytes(machine::second_level_cache(config))
                            : 0;
  if (config.placement == machine::Placement::distributed) {
    constexpr std::uint64_t bytes_a_home = 900;
    constexpr std::uint64_t bytes_a_further_port = 100;
    homes += config.all_nodes() * (bytes_a_home + bytes_a_further_port * (config.ports_of_node() - 1)) +
             config.clusters * memory::network_bytes(config.network, config.nodes);
  }
  if (config.scheme != machine::Scheme::image) {
    constexpr std::uint64_t bytes_a_ray = 96;  // including its part of its sample's tree
    const std::uint32_t queue =
        config.scheme == machine::Scheme::space ? config.space.queue : config.pipeline.queue;
    homes += config.clusters * memory::network_bytes(config.network, config.nodes) +
             config.all_nodes() * bytes_a_ray * (1 + std::uint64_t{queue});
  }
  constexpr std::uint64_t bytes_a_context = sizeof(walk::Cursor) + 96 + sim::EventQueue::bytes_an_event;
  constexpr std::uint64_t bytes_a_port = 80;
  // Nodes that are configured with several contexts keep these tables even where only one of each gets a
  // packet.
  const std::uint64_t contexts = machine.ports_of_node() == 1 ? 0
                                                              : config.contexts * bytes_a_context +
                                                                    config.ports_of_node() * bytes_a_port;
  std::uint64_t warps = 0;
  if (config.kind == machine::NodeKind::simt) {
    constexpr std::uint64_t bytes_a_node_at_most = 8192;  // what is due in each cycle, accesses, the rest
    // Of sorted rays each group but the last of those sorted together is full.
    const std::uint64_t groups =
        config.rt.sort == machine::RaySort::none
            ? 0
            : std::uint64_t{config.simt.warps} * config.simt.lanes /
                      std::max(1U, std::min(config.simt.lanes, config.rt.sort_rays)) +
                  config.simt.warps;
    constexpr std::uint64_t bytes_a_helping_lane = sizeof(simt::SharedLane) + sizeof(simt::SharedRay) + 512;
    const std::uint64_t bytes_a_lane =
        sizeof(simt::Lane) + (config.rt.share == machine::RtShare::none ? 0 : bytes_a_helping_lane);
    warps = bytes_a_node_at_most +
            (config.simt.warps + groups) * (sizeof(simt::Warp) + 1024 + config.simt.lanes * bytes_a_lane);
  }
  // At most 2^24 nodes of five caches of 2^28 lines: this cannot overflow.
  const std::uint64_t events =
      sim::EventQueue::bytes_of_days(std::size_t{config.all_nodes()} * config.ports_of_node());
  return homes + events +
         config.all_nodes() *
             (bytes_a_node + ahead + contexts + warps + config.write_buffer * sizeof(sim::Ticks) + tags);
}

std::uint64_t host_bytes(const program::WorkLog& log, const machine::MachineConfig& config) {
  std::uint64_t bytes = host_bytes(config, log.width, log.height);
  if (config.packets.order != machine::PacketOrder::scanline) {
    bytes += sizeof(std::uint32_t) * machine::packets_of_image(log.width, log.height, config.packets);
  }
  const bool sectors =
      config.kind == machine::NodeKind::simt && config.reference_bytes() < config.cache.cache.line;
  if (!config.count.any() && config.build.sharing == machine::Sharing::given && !sectors) {
    return bytes;
  }
  std::optional<walk::TreePlan> plan = walk::tree_plan_of(log, config);
  const memory::Layout layout = walk::layout_of(log, config, plan);
  if (sectors) {  // a byte for each line of memory
    bytes += config.all_nodes() * machine::first_level_caches(config.cache).size() *
             (layout.end() / config.cache.cache.line + 2) * 3 / 2;
  }
  if (plan) {
    // Counts as of a node above, and one larger cursor for each context.
    const std::uint64_t cursors = config.contexts * (sizeof(node::DynamicCursor) - sizeof(walk::Cursor));
    bytes += node::TreeCopies::host_bytes(*plan, layout, config) +
             config.all_nodes() * (2 * sizeof(node::BuildCounts) + cursors);
  }
  return bytes +
         walk::CacheCounting::host_bytes(config, walk::memory_lines(config, layout, plan ? &*plan : nullptr));
}

}  // namespace marti::processors::replay
