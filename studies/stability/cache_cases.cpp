// Cases of caches: from one line to more than the database, lines from one byte to all of it.
#include <algorithm>
#include <array>
#include <cstddef>
#include <list>
#include <set>

#include <fmt/format.h>

#include "memory/cache.h"
#include "sim/error.h"
#include "studies/stability/hostile.h"
#include "studies/stability/machines.h"

namespace marti::studies::stability {

namespace {

using memory::Cache;
using memory::CacheConfig;
using memory::Replacement;

constexpr std::uint64_t database = 1U << 16U;  // bytes

/// Addresses as a tree's walk makes them: most near the root, some anywhere.
std::vector<std::uint64_t> trace(std::uint32_t length, std::uint64_t seed) {
  Random random(seed);
  std::vector<std::uint64_t> addresses;
  for (std::uint32_t k = 0; k < length; ++k) {
    const unsigned level = random.below(17);
    addresses.push_back(random.below(std::min<std::uint32_t>(database, 1U << level)));
  }
  return addresses;
}

std::int64_t misses_of(const CacheConfig& config, const std::vector<std::uint64_t>& addresses) {
  Cache cache(config);
  for (const std::uint64_t address : addresses) {
    (void)cache.read(address, 1);
  }
  if (cache.counters().references() != static_cast<std::int64_t>(addresses.size())) {
    throw sim::InternalError("hits and misses are not the references");
  }
  return cache.counters().misses;
}

CaseOutcome one_line(const CaseSize& size) {
  Tally tally;
  for (const Replacement replacement :
       {Replacement::lru, Replacement::fifo, Replacement::random, Replacement::plru}) {
    for (std::uint32_t line = 1; line <= database; line *= 2) {
      const std::vector<std::uint64_t> addresses = trace(size.rays, 81);
      std::int64_t expected = 1;
      for (std::size_t k = 1; k < addresses.size(); ++k) {
        expected += addresses[k] / line != addresses[k - 1] / line ? 1 : 0;
      }
      tally.add(misses_of({line, line, 1, replacement}, addresses) == expected);
    }
  }
  return none_wrong(tally, "caches differ");
}

CaseOutcome whole_database(const CaseSize& size) {
  Tally tally;
  const std::vector<std::uint64_t> addresses = trace(size.rays, 82);
  for (const Replacement replacement :
       {Replacement::lru, Replacement::fifo, Replacement::random, Replacement::plru}) {
    for (const std::uint32_t ways : {1U, 4U, memory::full_ways}) {
      for (std::uint32_t line = 1; line <= database; line *= 4) {
        if (ways > 1 && line == database) {
          continue;  // there is only one line then
        }
        std::set<std::uint64_t> distinct;
        for (const std::uint64_t address : addresses) {
          distinct.insert(address / line);
        }
        tally.add(misses_of({database, line, ways, replacement}, addresses) ==
                  static_cast<std::int64_t>(distinct.size()));
      }
    }
  }
  return none_wrong(tally, "caches differ");
}

/// The stack distances of the whole trace (Mattson et al. 1970), by a list that is searched.
CaseOutcome stack_distances(const CaseSize& size) {
  const std::vector<std::uint64_t> addresses = trace(std::min(size.rays, 20'000U), 83);
  constexpr std::uint32_t line = 64;
  std::list<std::uint64_t> stack;
  std::vector<std::int64_t> at_distance(database / line + 1, 0);
  std::int64_t first_touches = 0;
  for (const std::uint64_t address : addresses) {
    std::size_t distance = 1;
    auto at = stack.begin();
    for (; at != stack.end() && *at != address / line; ++at) {
      ++distance;
    }
    if (at == stack.end()) {
      ++first_touches;
    } else {
      ++at_distance[distance];
      stack.erase(at);
    }
    stack.push_front(address / line);
  }
  Tally tally;
  std::int64_t before = static_cast<std::int64_t>(addresses.size()) + 1;
  std::int64_t hits = 0;
  for (std::uint32_t lines = 1; lines <= database / line; ++lines) {
    hits += at_distance[lines];
    if ((lines & (lines - 1)) != 0 && lines % 37 != 0) {
      continue;
    }
    const std::int64_t misses =
        misses_of({std::uint64_t{lines} * line, line, memory::full_ways, Replacement::lru}, addresses);
    tally.add(misses == static_cast<std::int64_t>(addresses.size()) - hits && misses <= before &&
              misses >= first_touches);
    before = misses;
  }
  return none_wrong(tally, "capacities differ");
}

CaseOutcome machines_of_all_caches() {
  Tally tally;
  std::int64_t references = -1;
  std::int64_t fewest = -1;
  const auto time = [&](const CacheConfig& cache) {
    processors::machine::MachineConfig machine;
    machine.nodes = 3;
    machine.packets = {2, 2, processors::machine::PacketOrder::scanline};
    machine.host.assignment = processors::machine::Assignment::interleaved;
    machine.cache.cache = cache;
    const processors::replay::MachineResult result = processors::replay::replay(small_log(), machine);
    return result.references();
  };
  const std::uint64_t all = std::uint64_t{1} << 22;
  for (const CacheConfig& cache :
       {CacheConfig{all, 32, memory::full_ways}, CacheConfig{32, 32, 1},
        CacheConfig{128, 32, memory::full_ways}, CacheConfig{4096, 32, 1},
        CacheConfig{4096, 32, memory::full_ways}, CacheConfig{4096, 32, 4, Replacement::plru},
        CacheConfig{4096, 32, 4, Replacement::random}, CacheConfig{3 * 32, 32, 3, Replacement::fifo},
        CacheConfig{all, 32, 1}}) {
    const processors::cost::ReferenceCounts counts = time(cache);
    if (references < 0) {
      references = counts.references();
      fewest = counts.all_misses();
    }
    tally.add(counts.references() == references && counts.all_misses() >= fewest &&
              (cache.size < all || counts.all_misses() == fewest));
  }
  CaseOutcome outcome = none_wrong(tally, "caches differ");
  outcome.figure += fmt::format("; {} references, {} misses at least",
                                tables::grouped(static_cast<std::uint64_t>(references)),
                                tables::grouped(static_cast<std::uint64_t>(fewest)));
  return outcome;
}

/// The same database in lines of 1 byte to 1 MiB: nothing but the number of references may change.
CaseOutcome machines_of_all_lines() {
  Tally tally;
  std::int64_t least = 0;
  for (std::uint32_t line = 1; line <= 1U << 20U; line *= 4) {
    processors::machine::MachineConfig machine;
    machine.nodes = 3;
    machine.cache.cache = {std::uint64_t{4} * line, line, 2};
    const processors::replay::MachineResult result = processors::replay::replay(small_log(), machine);
    tally.add(result.references().all_misses() > 0 &&
              result.steps().pixels == std::int64_t{small_log().width} * small_log().height);
    least = result.references().references();
  }
  CaseOutcome outcome = none_wrong(tally, "lines differ");
  outcome.figure +=
      fmt::format("; {} references of the longest", tables::grouped(static_cast<std::uint64_t>(least)));
  return outcome;
}

}  // namespace

void add_cache_cases(std::vector<StabilityCase>& cases) {
  const CaseAdder add(cases, CaseGroup::machine);
  add("cache-one-line", "a cache of one line, of 1 byte to the whole database",
      "misses: 1 and one for each change of line", one_line);
  add("cache-of-everything", "a cache as large as the database, lines of 1 byte to all of it",
      "misses are the distinct lines", whole_database);
  add("cache-stack", "LRU of 1 to 1,024 lines: a larger cache misses more",
      "Mattson's stack distances, exactly", stack_distances);
  add("caches-in-machines", "nodes with caches from one line to more than the database",
      "references are equal, misses never below the distinct lines", machines_of_all_caches);
  add("lines-in-machines", "lines of 1 byte to 1 MiB in a machine", "every pixel is written, every law holds",
      machines_of_all_lines);
}

}  // namespace marti::studies::stability
