#include <algorithm>
#include <bit>
#include <string_view>

#include "studies/helps/better.h"
#include "studies/helps/resource_lists.h"

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

}  // namespace marti::studies::helps
