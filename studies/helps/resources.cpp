#include "studies/helps/resources.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "accel/visitor.h"

namespace marti::studies::helps {

namespace {

std::int64_t whole(const Changer& changer, std::string_view key) {
  return std::get<std::int64_t>(changer.now(key));
}

double ratio(std::int64_t a, std::int64_t b) { return static_cast<double>(a) / static_cast<double>(b); }

}  // namespace

std::int64_t next_power(std::int64_t number) {
  return static_cast<std::int64_t>(std::bit_ceil(static_cast<std::uint64_t>(number) + 1));
}

std::int64_t tenth_less(std::int64_t number) {
  // Of large numbers the quotient comes first, so that the product does not overflow.
  return std::min(number - 1, number > 1'000'000 ? number / 11 * 10 : number * 10 / 11);
}

Resource faster_clock(const Changer& changer, Part part, std::string_view key) {
  const auto now = std::get<double>(changer.now(key));
  const sim::Ticks period = sim::Clock::from_hertz(now).period();
  const double fastest = std::get<double>(*changer.key(key).maximum);
  double faster = std::min(fastest, std::max(std::round(now * 11.0 / 10.0), std::floor(now) + 1.0));
  if (sim::Clock::from_hertz(faster).period() == period && period > 1) {
    faster = std::round(static_cast<double>(sim::ticks_per_second) / static_cast<double>(period - 1));
  }
  Resource clock = {std::string(key), part, std::nullopt, std::nullopt};
  if (period > 1) {
    clock.step = changer.with({{key, faster}});
    clock.factor = faster / now;
  }
  return clock;
}

Resource more(const Changer& changer, Part part, std::string_view key, std::optional<std::int64_t> useful) {
  const std::int64_t now = whole(changer, key);
  const auto most = std::get<std::int64_t>(*changer.key(key).maximum);
  constexpr std::int64_t far = 8;
  const std::int64_t end = useful ? next_power(*useful - 1) : now <= most / far ? now * far : most;
  const std::int64_t best = std::min(end, most);
  const std::int64_t next = std::min(next_power(now), std::max(best, now));
  return {std::string(key), part, changer.with({{key, next}}),
          best > next ? changer.with({{key, best}}) : std::nullopt, now > 0 ? ratio(next, now) : 2.0};
}

Resource fewer(const Changer& changer, Part part, std::string_view key, std::int64_t least) {
  const std::int64_t now = whole(changer, key);
  const std::int64_t next = std::clamp(tenth_less(now), std::min(least, now), now);
  return {std::string(key), part, changer.with({{key, next}}),
          next > least ? changer.with({{key, least}}) : std::nullopt, next > 0 ? ratio(now, next) : 2.0};
}

namespace {

using processors::machine::MachineConfig;
using processors::machine::NodeKind;
using processors::machine::Placement;
using processors::machine::Scheme;
using processors::machine::Sharing;
using processors::replay::MachineResult;

// Packets of half the size leave about half of the time in which nodes have none left.
constexpr double packets_factor = 2.0;

// A line in one beat: what is wider moves no line faster.
std::int64_t line_of(const MachineConfig& machine) { return next_power(machine.reference_bytes() - 1); }

void add_nodes(const Changer& changer, const MachineConfig& machine, const FrameFacts& facts,
               std::vector<Resource>& resources) {
  resources.push_back(faster_clock(changer, Part::nodes, "node.clock"));
  const bool image = machine.scheme == Scheme::image;
  // More nodes than packets have nothing to do. Nodes beside which rays move are of use without such a limit.
  const auto packets = static_cast<std::int64_t>(facts.packets / machine.clusters);
  const std::int64_t most = processors::machine::most_nodes / machine.clusters;
  Resource nodes = more(changer, Part::nodes, "machine.nodes", image ? std::min(packets, most) : most);
  if (!image) {
    nodes.best.reset();
  }
  resources.push_back(std::move(nodes));
  if (image) {
    resources.push_back(more(changer, Part::queues, "node.write_buffer"));
    // A longer buffer changes nothing then. A node with several contexts or warps may do something else while
    // one of them waits.
    resources.back().same_frame =
        machine.contexts == 1 && machine.kind == NodeKind::core && !facts.writes_waited;
  }
  if (image) {
    for (const std::string_view side : {"packets.width", "packets.height"}) {
      const std::int64_t half = std::get<std::int64_t>(changer.now(side)) / 2;
      resources.push_back(
          {std::string(side), Part::nodes, changer.with({{side, half}}), std::nullopt, packets_factor});
    }
  }
  if (machine.contexts > 1) {
    resources.push_back(more(changer, Part::nodes, "node.contexts"));
    resources.push_back(fewer(changer, Part::nodes, "node.switch_cycles"));
  }
  if (machine.prefetch.on()) {
    resources.push_back(more(changer, Part::caches, "prefetch.outstanding"));
  }
}

void add_simt(const Changer& changer, const MachineConfig& machine, const FrameFacts& facts,
              std::vector<Resource>& resources) {
  if (machine.kind == NodeKind::core) {
    return;
  }
  resources.push_back(more(changer, Part::nodes, "simt.warps"));
  resources.push_back(more(changer, Part::nodes, "simt.issue", machine.simt.warps));
  resources.push_back(more(changer, Part::nodes, "cache.ports"));
  resources.push_back(more(changer, Part::nodes, "cache.mshrs"));
  if (machine.rt.warps == 0) {
    return;
  }
  resources.push_back(more(changer, Part::nodes, "rt.warps", machine.simt.warps));
  // As many entries as a branch has children. Only a bvh has stacks; the change is refused with others.
  resources.push_back(more(changer, Part::caches, "prefetch.stack", accel::EnteredChildren::most));
  if (machine.rt.sort == processors::machine::RaySort::none) {
    // Where rays begin or go is not in every frame's log.
    resources.push_back(
        {"rt.sort", Part::nodes, changer.with({{"rt.sort", std::string("kind")}}), std::nullopt});
  }
  if (machine.rt.stack > 0) {
    Resource stack = more(changer, Part::nodes, "rt.stack");
    stack.best = changer.with({{"rt.stack", std::int64_t{0}}});
    resources.push_back(std::move(stack));
  }
  for (const auto& [key, units] :
       {std::pair{"rt.box_units", machine.rt.box_units}, {"rt.triangle_units", machine.rt.triangle_units}}) {
    if (units > 0) {
      resources.push_back(more(changer, Part::nodes, key));
    }
  }
  for (const std::string_view test :
       {"rt.box_cycles", "rt.leaf_cycles", "rt.triangle_cycles", "rt.quadric_cycles"}) {
    resources.push_back(fewer(changer, Part::nodes, test));
  }
  if (facts.instances) {
    resources.push_back(fewer(changer, Part::nodes, "rt.transform_cycles"));
  }
}

void add_local_memory(const Changer& changer, const MachineConfig& machine,
                      std::vector<Resource>& resources) {
  if (machine.scheme == Scheme::space || machine.placement != Placement::shared ||
      machine.build.sharing == Sharing::private_trees) {
    resources.push_back(faster_clock(changer, Part::local_memory, "local.clock"));
    resources.push_back(more(changer, Part::local_memory, "local.width", line_of(machine)));
    resources.push_back(fewer(changer, Part::local_memory, "local.access_cycles"));
  }
}

// More banks than this have nothing to serve: as many as there are interleave units of the database and the
// frame buffer.
std::int64_t useful_banks(const MachineConfig& machine, const FrameFacts& facts) {
  const std::uint64_t pixel = machine.layout.pixel_bytes + machine.layout.record_alignment - 1;
  const std::uint64_t bytes = facts.database_bytes + facts.pixels * pixel;
  return static_cast<std::int64_t>(bytes / machine.banks.interleave + 1);
}

void add_shared_memory(const Changer& changer, const MachineConfig& machine, const FrameFacts& facts,
                       std::vector<Resource>& resources) {
  if (machine.scheme == Scheme::space || machine.placement == Placement::distributed) {
    return;
  }
  if (machine.interconnect.kind != memory::InterconnectKind::ideal) {
    resources.push_back(more(changer, Part::interconnect, "interconnect.width", line_of(machine)));
  }
  resources.push_back(faster_clock(changer, Part::interconnect, "interconnect.clock"));
  if (machine.interconnect.kind == memory::InterconnectKind::bus) {
    resources.push_back(fewer(changer, Part::interconnect, "interconnect.address_cycles"));
  } else {
    resources.push_back(fewer(changer, Part::interconnect, "interconnect.latency_cycles"));
  }
  if (machine.interconnect.kind == memory::InterconnectKind::ideal) {
    return;
  }
  if (machine.banks.dram) {
    add_dram(changer, *machine.banks.dram, resources);
    return;
  }
  resources.push_back(more(changer, Part::banks, "memory.banks", useful_banks(machine, facts)));
  resources.push_back(faster_clock(changer, Part::banks, "memory.clock"));
  resources.push_back(fewer(changer, Part::banks, "memory.access_cycles"));
  resources.push_back(fewer(changer, Part::banks, "memory.busy_cycles"));
  // How long a bank is busy changes nothing where no access has waited for its bank.
  resources.back().same_frame = !facts.waited_for_banks;
}

void add_host(const Changer& changer, const MachineConfig& machine, std::vector<Resource>& resources) {
  if (machine.host.assignment == processors::machine::Assignment::dynamic) {
    resources.push_back(fewer(changer, Part::host, "host.latency_cycles"));
    resources.push_back(fewer(changer, Part::host, "host.occupancy_cycles"));
  }
}

// A tree that is given costs nothing to build.
void add_building(const Changer& changer, const MachineConfig& machine, std::vector<Resource>& resources) {
  const processors::machine::BuildConfig& build = machine.build;
  if (build.sharing == Sharing::given) {
    return;
  }
  const std::optional<Change> given = changer.with({{"build.sharing", std::string("given")}});
  if (build.sharing == Sharing::none) {
    const NewValue on_demand = {"build.initial_level", std::string("1")};
    resources.push_back({"build.sharing", Part::building,
                         changer.with({{"build.sharing", std::string("shared")}, on_demand}), given});
    resources.push_back({"build.sharing, private", Part::building,
                         changer.with({{"build.sharing", std::string("private")}, on_demand}), std::nullopt});
    return;
  }
  const auto at_level = [&](std::uint32_t level) {
    return changer.with({{"build.initial_level", std::to_string(level)}});
  };
  resources.push_back({"build.initial_level", Part::building, at_level(1), given});
  if (build.initial == processors::machine::InitialTree::level) {
    resources.push_back(
        {"build.initial_level, higher", Part::building, at_level(build.level + 1), std::nullopt});
    if (build.level > 2) {
      resources.push_back(
          {"build.initial_level, lower", Part::building, at_level(build.level - 1), std::nullopt});
    }
  }
}

}  // namespace

FrameFacts facts_of(const MachineResult& result) {
  FrameFacts facts;
  facts.packets = result.packets;
  facts.pixels = result.pixels;
  facts.database_bytes = result.database_bytes;
  facts.instances = result.steps().transforms > 0;
  facts.writes_waited =
      result.time()[static_cast<std::size_t>(processors::cost::Activity::queue_full_wait)] > 0;
  facts.waited_for_banks =
      std::ranges::any_of(result.clusters, [](const processors::replay::ClusterResult& cluster) {
        return std::ranges::any_of(cluster.banks,
                                   [](const memory::BankStatistics& bank) { return bank.waits.sum > 0; });
      });
  return facts;
}

std::vector<Resource> resources_of(const Changer& changer, const MachineConfig& machine,
                                   const FrameFacts& facts) {
  std::vector<Resource> resources;
  add_nodes(changer, machine, facts, resources);
  add_simt(changer, machine, facts, resources);
  add_caches(changer, machine, facts.database_bytes, resources);
  add_local_memory(changer, machine, resources);
  add_shared_memory(changer, machine, facts, resources);
  add_flow(changer, machine, resources);
  add_host(changer, machine, resources);
  add_building(changer, machine, resources);
  std::erase_if(resources, [](const Resource& resource) { return !resource.step && !resource.best; });
  return resources;
}

}  // namespace marti::studies::helps
