#include "processors/machine/simt_config.h"

#include <bit>
#include <string>
#include <utility>

#include "processors/machine/machine_config.h"
#include "sim/key_error.h"

namespace marti::processors::machine {

namespace {

void check_range(std::string_view key, std::uint32_t value, std::uint32_t least, std::uint32_t most) {
  if (value < least || value > most) {
    throw sim::KeyError(std::string(key),
                        "must be from " + std::to_string(least) + " to " + std::to_string(most));
  }
}

// The key by which a machine asks for prefetching into its units.
std::string key_of_unit(const PrefetchConfig& prefetch) {
  return prefetch.stack > 0 ? "prefetch.stack" : "prefetch.treelet";
}

void check_stack(const MachineConfig& config) {
  check_range("rt.stack", config.rt.stack, 0, most_stack_entries);
  if (config.rt.stack == 0) {
    return;
  }
  if (config.rt.warps == 0) {
    throw sim::KeyError("rt.stack", "is for lanes of a ray-tracing unit; set rt.warps to at least 1");
  }
  if (config.placement == Placement::replicated) {
    throw sim::KeyError("rt.stack",
                        "a node whose own memory has the whole database keeps no stacks in it; set it to 0");
  }
  if (config.reference_bytes() < stack_entry_bytes) {
    throw sim::KeyError("rt.stack", "needs lines of at least " + std::to_string(stack_entry_bytes) +
                                        " bytes, those of an entry (cache.line, cache.sector)");
  }
}

void check_share(const MachineConfig& config) {
  if (config.rt.share == RtShare::none) {
    return;
  }
  if (config.rt.warps == 0) {
    throw sim::KeyError("rt.share", "is for lanes of a ray-tracing unit; set rt.warps to at least 1");
  }
  for (const auto& [key, value] :
       {std::pair{"rt.stack", config.rt.stack}, {"prefetch.stack", config.prefetch.stack}}) {
    if (value > 0) {
      throw sim::KeyError(key,
                          "must be 0 with rt.share = \"warp\": another lane may take what waits on a "
                          "lane's stack");
    }
  }
}

}  // namespace

void check_simt(const MachineConfig& config) {
  if (config.kind == NodeKind::core) {
    if (config.layout.leaf == memory::LeafLayout::inline_records) {
      throw sim::KeyError("layout.leaf", "\"inline\" is for node.kind = \"simt\"; use \"list\"");
    }
    if (config.prefetch.into_unit()) {
      throw sim::KeyError(key_of_unit(config.prefetch), "is for node.kind = \"simt\"; use prefetch.children");
    }
    if (config.rt.sort != RaySort::none) {
      throw sim::KeyError("rt.sort", "is for node.kind = \"simt\"; set it to \"none\"");
    }
    if (config.rt.share != RtShare::none) {
      throw sim::KeyError("rt.share", "is for node.kind = \"simt\"; set it to \"none\"");
    }
    if (config.rt.stack > 0) {
      throw sim::KeyError("rt.stack", "is for node.kind = \"simt\"; set it to 0");
    }
    return;
  }
  const SimtConfig& simt = config.simt;
  const RtUnitConfig& rt = config.rt;
  check_range("simt.lanes", simt.lanes, 1, most_lanes);
  check_range("simt.warps", simt.warps, 1, most_warps);
  check_range("simt.issue", simt.issue, 1, most_warps);
  check_range("cache.ports", simt.ports, 1, most_cache_ports);
  check_range("cache.mshrs", simt.mshrs, 1, most_mshrs);
  check_range("rt.warps", rt.warps, 0, most_warps);
  check_range("rt.box_units", rt.box_units, 0, most_test_units);
  check_range("rt.triangle_units", rt.triangle_units, 0, most_test_units);
  for (const auto& [key, cycles] : {std::pair{"rt.box_cycles", rt.box_cycles},
                                    {"rt.leaf_cycles", rt.leaf_cycles},
                                    {"rt.triangle_cycles", rt.triangle_cycles},
                                    {"rt.quadric_cycles", rt.quadric_cycles},
                                    {"rt.sort_cycles", rt.sort_cycles}}) {
    if (cycles < 0) {
      throw sim::KeyError(key, "must not be negative");
    }
  }
  check_stack(config);
  check_share(config);
  check_range("rt.sort_rays", rt.sort_rays, 1, most_sorted_rays);
  if (rt.sort != RaySort::none && rt.warps == 0) {
    throw sim::KeyError("rt.sort", "is for rays that enter a ray-tracing unit; set rt.warps to at least 1");
  }
  check_range("prefetch.stack", config.prefetch.stack, 0, most_prefetched_entries);
  check_range("prefetch.queue", config.prefetch.queue, 1, most_queued_prefetches);
  if (config.prefetch.into_unit() && rt.warps == 0) {
    throw sim::KeyError(key_of_unit(config.prefetch),
                        "is for warps in a ray-tracing unit; set rt.warps to at least 1");
  }
  if (config.prefetch.into_unit() && config.placement == Placement::replicated) {
    throw sim::KeyError(key_of_unit(config.prefetch),
                        "a node whose own memory has the whole database does not prefetch");
  }
  if (config.layout.node_order != memory::NodeOrder::treelets) {
    const std::string set = "; set layout.node_order = \"treelets\"";
    if (rt.scheduler == RtScheduler::treelet) {
      throw sim::KeyError("rt.scheduler", "\"treelet\" needs nodes that lie in treelets" + set);
    }
    if (config.prefetch.treelet) {
      throw sim::KeyError("prefetch.treelet", "needs nodes that lie in treelets" + set);
    }
  }
  if (config.cache.organisation == CacheOrganisation::none) {
    throw sim::KeyError("node.kind",
                        "\"simt\" needs a cache, whose lines its lanes share while they are under way; set "
                        "cache.organisation = \"unified\"");
  }
  const std::uint32_t line = config.cache.cache.line;
  if (simt.sector != 0 &&
      (!std::has_single_bit(simt.sector) || simt.sector > line || line / simt.sector > most_sectors)) {
    throw sim::KeyError("cache.sector", "must be a power of two that divides cache.line, " +
                                            std::to_string(line) + " bytes, into at most 8 sectors");
  }
  if (std::uint64_t{config.all_nodes()} * config.ports_of_node() > most_ports) {
    throw sim::KeyError("cache.mshrs", "nodes with more than 2^28 lines under way in all");
  }
}

}  // namespace marti::processors::machine
