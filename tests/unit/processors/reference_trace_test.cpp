// A second cache simulator, fed with a node's references, finds the same hits and misses.

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <list>
#include <map>

#include "processors/replay/replay.h"
#include "tests/support/heard_references.h"
#include "tests/support/random_machine.h"

namespace marti::processors {

using namespace cost;
using namespace machine;
using namespace program;
using namespace replay;

namespace {

/// A plain cache: for each set a list, the next victim last.
class PlainCache {
 public:
  PlainCache(const memory::CacheConfig& config, std::uint64_t size)
      : line_(config.line),
        ways_(config.ways == 0 ? size / config.line : config.ways),
        sets_(size / config.line / ways_),
        fifo_(config.replacement == memory::Replacement::fifo) {}

  bool read(memory::Address address) {
    const memory::Address line = address / line_;
    std::list<memory::Address>& set = contents_[line % sets_];
    for (auto at = set.begin(); at != set.end(); ++at) {
      if (*at == line) {
        if (!fifo_) {
          set.splice(set.begin(), set, at);
        }
        return true;
      }
    }
    set.push_front(line);
    if (set.size() > ways_) {
      set.pop_back();
    }
    return false;
  }

 private:
  std::uint64_t line_;
  std::uint64_t ways_;
  std::uint64_t sets_;
  bool fifo_;
  std::map<std::uint64_t, std::list<memory::Address>> contents_;
};

struct Hits {
  std::array<std::int64_t, memory::record_kinds> hits{};
  std::array<std::int64_t, memory::record_kinds> misses{};
  std::int64_t writes = 0;
};

Hits simulate(const test::HeardReferences& trace, std::uint32_t node, const NodeCacheConfig& config) {
  std::vector<PlainCache> caches;
  for (std::size_t i = 0; i < split_caches; ++i) {
    caches.emplace_back(config.cache, config.organisation == CacheOrganisation::split ? config.split_sizes[i]
                                                                                      : config.cache.size);
  }
  Hits found;
  trace.for_each(node, [&](const test::HeardReference& reference) {
    // Dinero reads four bytes from a multiple of four on.
    const memory::Address address = reference.address & ~memory::Address{3};
    const auto kind = static_cast<std::size_t>(reference.kind);
    if (reference.write) {
      ++found.writes;
      return;
    }
    constexpr std::array<std::size_t, memory::record_kinds> parts = {0, 0, 1, 2, 3, 3, 3};
    const std::size_t part = config.organisation == CacheOrganisation::split ? parts[kind] : 0;
    const bool hit = config.organisation != CacheOrganisation::none && caches[part].read(address);
    ++(hit ? found.hits : found.misses)[kind];
  });
  return found;
}

RC_GTEST_PROP(ReferenceTraces, GiveAnotherCacheTheSameHitsAndMisses, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::small_log(random);
  MachineConfig machine = test::random_machine(random);
  machine.cache.cache.replacement = random() % 2 == 0 ? memory::Replacement::lru : memory::Replacement::fifo;
  test::HeardReferences trace;
  ReplayOptions options;
  options.observer = &trace;
  const MachineResult result = replay::replay(log, machine, options);
  RC_ASSERT(trace.nodes() == machine.all_nodes());
  for (std::uint32_t node = 0; node < trace.nodes(); ++node) {
    const Hits found = simulate(trace, node, machine.cache);
    const ReferenceCounts& counted = result.nodes[node].references;
    RC_ASSERT(found.hits == counted.hits);
    RC_ASSERT(found.misses == counted.misses);
    RC_ASSERT(found.writes == result.nodes[node].writes);
  }
}

TEST(ReferenceTraces, AreInProgramOrderWithPixelsAtTheirEnds) {
  test::Random random(5);
  const WorkLog log = test::random_log(random, 6, 4);
  MachineConfig machine = test::random_machine(random);
  machine.clusters = 1;
  machine.nodes = 1;
  machine.packets = {3, 2, PacketOrder::scanline};
  test::HeardReferences trace;
  ReplayOptions options;
  options.observer = &trace;
  (void)replay::replay(log, machine, options);
  std::vector<memory::Address> pixels;
  trace.for_each(0, [&](const test::HeardReference& reference) {
    if (reference.write) {
      pixels.push_back(reference.address);
    }
  });
  ASSERT_EQ(pixels.size(), 24U);
  const memory::Address step = pixels[1] - pixels[0];
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    // Packets of 3 x 2 pixels, two in a row of the image.
    const std::size_t packet = i / 6;
    const std::size_t x = packet % 2 * 3 + i % 3;
    const std::size_t y = packet / 2 * 2 + i % 6 / 3;
    EXPECT_EQ(pixels[i], pixels[0] + step * (y * 6 + x));
  }
}

}  // namespace
}  // namespace marti::processors
