#include <algorithm>
#include <array>
#include <bit>
#include <string>
#include <string_view>
#include <utility>

#include "studies/helps/resources.h"

namespace marti::studies::helps {

namespace {

using processors::machine::CacheOrganisation;
using processors::machine::SecondLevel;

// More ways than this cost more than they bring (Hill and Smith 1989).
constexpr std::int64_t most_ways = 64;
// Guesses of Resource::factor: twice the size of a cache leaves about six tenths of its misses where it is
// small.
constexpr double twice_the_size = 1.7;
constexpr double more_of_the_ways = 1.1;
constexpr double another_line = 1.2;
constexpr double another_choice = 1.25;

// The first of these values with which a machine can be built.
std::optional<Change> first_possible(const Changer& changer, std::string_view key,
                                     const std::vector<std::int64_t>& values) {
  for (const std::int64_t value : values) {
    if (std::optional<Change> change = changer.with({{key, value}})) {
      return change;
    }
  }
  return std::nullopt;
}

Resource larger(const Changer& changer, Part part, std::string_view key, const memory::CacheConfig& cache,
                std::uint64_t database_bytes) {
  const memory::CacheShape shape = memory::shape_of(cache);
  const std::int64_t unit = std::int64_t{cache.line} * (cache.ways == memory::full_ways ? 1 : shape.ways);
  const auto now = static_cast<std::int64_t>(cache.size);
  const auto all = static_cast<std::int64_t>(std::bit_ceil(std::max(database_bytes, cache.size)));
  return {std::string(key), part, first_possible(changer, key, {next_power(now), 2 * now}),
          all > 2 * now ? first_possible(changer, key, {all, all / unit * unit + unit}) : std::nullopt,
          twice_the_size};
}

Resource more_ways(const Changer& changer, Part part, std::string_view key,
                   const memory::CacheConfig& cache) {
  Resource more = {std::string(key), part, std::nullopt, std::nullopt, more_of_the_ways};
  std::vector<std::int64_t> tried;
  for (std::int64_t ways = next_power(cache.ways); ways <= most_ways; ways *= 2) {
    tried.push_back(ways);
  }
  more.step = first_possible(changer, key, tried);
  std::ranges::reverse(tried);
  more.best = first_possible(changer, key, tried);
  if (more.step && more.best && more.step->keys.front().to == more.best->keys.front().to) {
    more.best.reset();
  }
  return more;
}

void add_first_level(const Changer& changer, const processors::machine::NodeCacheConfig& cache,
                     std::uint64_t database_bytes, std::vector<Resource>& resources) {
  for (const auto& first : processors::machine::first_level_caches(cache)) {
    resources.push_back(larger(changer, Part::caches, first.size_key, first.cache, database_bytes));
  }
  if (cache.cache.ways != memory::full_ways) {
    resources.push_back(more_ways(changer, Part::caches, "cache.ways", cache.cache));
  }
  resources.push_back(fewer(changer, Part::caches, "cache.hit_cycles"));
  const std::int64_t line = cache.cache.line;
  resources.push_back(
      {"cache.line", Part::caches, changer.with({{"cache.line", 2 * line}}), std::nullopt, another_line});
  if (line > 1) {
    resources.push_back({"cache.line (shorter)", Part::caches, changer.with({{"cache.line", line / 2}}),
                         std::nullopt, another_line});
  }
}

}  // namespace

void add_caches(const Changer& changer, const processors::machine::MachineConfig& machine,
                std::uint64_t database_bytes, std::vector<Resource>& resources) {
  if (machine.cache.organisation != CacheOrganisation::none) {
    add_first_level(changer, machine.cache, database_bytes, resources);
  }
  if (machine.l2.sharing != SecondLevel::none) {
    const memory::CacheConfig cache = processors::machine::second_level_cache(machine);
    resources.push_back(larger(changer, Part::second_level, "l2.size", cache, database_bytes));
    if (cache.ways != memory::full_ways) {
      resources.push_back(more_ways(changer, Part::second_level, "l2.ways", cache));
    }
    if (machine.l2.clock) {  // else the clock of another part, which is a resource itself
      resources.push_back(faster_clock(changer, Part::second_level, "l2.clock"));
    }
    resources.push_back(fewer(changer, Part::second_level, "l2.hit_cycles"));
  }
}

namespace {

using memory::DramPage;
using memory::DramPolicy;
using memory::DramTiming;

}  // namespace

void add_dram(const Changer& changer, const memory::DramConfig& dram, std::vector<Resource>& resources) {
  const auto add = [&](std::string_view key, const std::optional<Change>& step, double factor) {
    resources.push_back({std::string(key), Part::banks, step, std::nullopt, factor});
  };
  const auto shorter = [&](std::string_view key, std::int64_t now, std::int64_t least) {
    const std::int64_t next = std::max(tenth_less(now), least);
    add(key, changer.with({{key, next, now}}),
        static_cast<double>(now) / static_cast<double>(std::max<std::int64_t>(next, 1)));
  };
  shorter("dram.tck", dram.period, 1);
  add("dram.channels",
      changer.with({{"dram.channels", next_power(dram.channels), std::int64_t{dram.channels}}}), 2.0);
  const DramTiming& times = dram.timing;
  shorter("dram.tcl", times.cl, 0);
  shorter("dram.trcd", times.rcd, 0);
  shorter("dram.trp", times.rp, 0);
  const auto choose = [&](std::string_view key, std::string_view other) {
    add(key, changer.with({{key, std::string(other)}}), another_choice);
  };
  choose("dram.page", memory::dram_page_names[dram.page == DramPage::open ? 1 : 0]);
  if (dram.policy == DramPolicy::fcfs) {
    choose("dram.policy", memory::dram_policy_names[1]);
  } else if (!changer.given("dram.queue") && !changer.given("dram.reorder_cap")) {
    choose("dram.policy", memory::dram_policy_names[0]);  // has no use for these keys
  }
}

namespace {

using processors::machine::MachineConfig;
using processors::machine::PipelineConfig;
using processors::machine::Scheme;

void add_stages(const Changer& changer, const MachineConfig& machine, std::vector<Resource>& resources) {
  constexpr std::array<std::pair<std::string_view, std::uint32_t PipelineConfig::*>,
                       processors::machine::pipeline_stages>
      stages = {{{"pipeline.search", &PipelineConfig::search},
                 {"pipeline.nearest", &PipelineConfig::nearest},
                 {"pipeline.shade", &PipelineConfig::shade}}};
  for (const auto& [grown, member] : stages) {
    const std::int64_t before = machine.pipeline.*member;
    const std::int64_t added = next_power(before) - before;
    std::vector<NewValue> values = {{"machine.nodes", machine.nodes + added}};
    for (const auto& [key, count] : stages) {
      const std::int64_t now = machine.pipeline.*count;
      values.push_back({key, key == grown ? now + added : now, now});
    }
    resources.push_back({std::string(grown), Part::nodes, changer.with(values), std::nullopt,
                         static_cast<double>(before + added) / static_cast<double>(before)});
  }
}

void add_queues(const Changer& changer, const MachineConfig& machine, std::vector<Resource>& resources) {
  const bool pipeline = machine.scheme == Scheme::pipeline;
  const std::string section = pipeline ? "pipeline." : "space.";
  resources.push_back(more(changer, Part::queues, section + "queue"));
  // With 0 there are as many in flight as the queues allow.
  if ((pipeline ? machine.pipeline.in_flight : machine.space.in_flight) > 0) {
    resources.push_back(
        more(changer, Part::queues, section + "in_flight",
             pipeline ? std::optional(next_power(processors::machine::most_in_flight(machine.pipeline)) / 2)
                      : std::nullopt));
  }
}

}  // namespace

void add_flow(const Changer& changer, const MachineConfig& machine, std::vector<Resource>& resources) {
  const bool image = machine.scheme == Scheme::image;
  if (!image || machine.placement == processors::machine::Placement::distributed) {
    resources.push_back(faster_clock(changer, Part::network, "network.clock"));
    resources.push_back(fewer(changer, Part::network, "network.hop_cycles"));
    if (machine.network.kind != memory::NetworkKind::ideal) {
      const std::int64_t message = image ? machine.distribution.header_bytes + machine.reference_bytes()
                                         : std::int64_t{machine.messages.ray_bytes};
      resources.push_back(more(changer, Part::network, "network.width", next_power(message - 1)));
    }
  }
  if (image) {
    return;
  }
  resources.push_back(fewer(changer, Part::messages, "messages.ray", 1));
  resources.push_back(fewer(changer, Part::messages, "messages.contribution", 1));
  resources.push_back(fewer(changer, Part::messages, "messages.send_cycles"));
  resources.push_back(fewer(changer, Part::messages, "messages.receive_cycles"));
  add_queues(changer, machine, resources);
  if (machine.scheme == Scheme::pipeline) {
    add_stages(changer, machine, resources);
  } else {
    resources.push_back({"space.level", Part::regions,
                         changer.with({{"space.level", std::int64_t{machine.space.level} + 1}}), std::nullopt,
                         another_choice, false});
  }
}

}  // namespace marti::studies::helps
