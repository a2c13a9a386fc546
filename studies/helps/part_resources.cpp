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

// Ways between those of a cache and the next that divide its lines are tried up to this many.
constexpr std::uint32_t most_ways_tried = 64;

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
  const bool one_set = cache.ways == memory::full_ways;
  const auto units = static_cast<std::int64_t>(one_set ? shape.ways : shape.sets);
  const std::int64_t unit = std::int64_t{cache.line} * (one_set ? 1 : shape.ways);
  const auto now = static_cast<std::int64_t>(cache.size);
  const auto all = static_cast<std::int64_t>(std::bit_ceil(std::max(database_bytes, cache.size)));
  return {std::string(key), part, first_possible(changer, key, {unit * tenth_more(units), 2 * now}),
          first_possible(changer, key, {all, all / unit * unit + unit})};
}

Resource more_ways(const Changer& changer, Part part, std::string_view key,
                   const memory::CacheConfig& cache) {
  std::vector<std::int64_t> tried;
  for (std::uint32_t ways = cache.ways + 1; ways <= cache.ways + most_ways_tried; ++ways) {
    tried.push_back(ways);
  }
  return {std::string(key), part, first_possible(changer, key, tried),
          changer.with({{key, std::int64_t{memory::full_ways}}})};
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
  resources.push_back({"cache.line", Part::caches, changer.with({{"cache.line", 2 * line}}), std::nullopt});
  if (line > 1) {
    resources.push_back(
        {"cache.line (shorter)", Part::caches, changer.with({{"cache.line", line / 2}}), std::nullopt});
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
    resources.push_back(fewer(changer, Part::second_level, "l2.hit_cycles"));
  }
}

namespace {

using memory::DramPage;
using memory::DramPolicy;
using memory::DramTiming;

// Divided by 1.1, and at least one less.
std::int64_t less(std::int64_t now) { return std::max<std::int64_t>(std::min(now - 1, now * 10 / 11), 0); }

}  // namespace

void add_dram(const Changer& changer, const memory::DramConfig& dram, std::vector<Resource>& resources) {
  const auto add = [&](std::string_view key, const std::optional<Change>& step,
                       const std::optional<Change>& best = std::nullopt) {
    resources.push_back({std::string(key), Part::banks, step, best});
  };
  const auto set = [&](std::string_view key, std::int64_t to, std::int64_t from) {
    return changer.with({{key, to, from}});
  };
  add("dram.tck", set("dram.tck", std::max<std::int64_t>(less(dram.period), 1), dram.period),
      set("dram.tck", 1, dram.period));
  add("dram.channels", set("dram.channels", std::int64_t{dram.channels} * 2, dram.channels));
  const DramTiming& times = dram.timing;
  add("dram.tcl", set("dram.tcl", less(times.cl), times.cl));
  add("dram.trcd", set("dram.trcd", less(times.rcd), times.rcd));
  add("dram.trp", set("dram.trp", less(times.rp), times.rp));
  const auto choose = [&](std::string_view key, std::string_view other) {
    add(key, changer.with({{key, std::string(other)}}));
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
    const std::int64_t added = tenth_more(before) - before;
    std::vector<NewValue> values = {{"machine.nodes", machine.nodes + added}};
    for (const auto& [key, count] : stages) {
      const std::int64_t now = machine.pipeline.*count;
      values.push_back({key, key == grown ? now + added : now, now});
    }
    resources.push_back({std::string(grown), Part::nodes, changer.with(values), std::nullopt});
  }
}

void add_queues(const Changer& changer, const MachineConfig& machine, std::vector<Resource>& resources) {
  const bool pipeline = machine.scheme == Scheme::pipeline;
  const std::string section = pipeline ? "pipeline." : "space.";
  resources.push_back(more(changer, Part::queues, section + "queue"));
  // With 0 there are as many in flight as the queues allow.
  if ((pipeline ? machine.pipeline.in_flight : machine.space.in_flight) > 0) {
    Resource rays = more(changer, Part::queues, section + "in_flight");
    if (pipeline) {
      rays.best = changer.with(
          {{"pipeline.in_flight", std::int64_t{processors::machine::most_in_flight(machine.pipeline)}}});
    }
    resources.push_back(std::move(rays));
  }
}

}  // namespace

void add_flow(const Changer& changer, const MachineConfig& machine, std::vector<Resource>& resources) {
  const bool image = machine.scheme == Scheme::image;
  if (!image || machine.placement == processors::machine::Placement::distributed) {
    resources.push_back(faster_clock(changer, Part::network, "network.clock"));
    resources.push_back(fewer(changer, Part::network, "network.hop_cycles"));
    if (machine.network.kind != memory::NetworkKind::ideal) {
      resources.push_back(wider(changer, Part::network, "network.width"));
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
                         false});
  }
}

}  // namespace marti::studies::helps
