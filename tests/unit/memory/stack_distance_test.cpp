// One pass against caches of every size and of all ways, simulated one by one.
#include "memory/stack_distance.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <numeric>
#include <random>
#include <set>
#include <vector>

#include "memory/all_ways.h"
#include "memory/cache.h"
#include "sim/error.h"

namespace marti::memory {
namespace {

using Lines = std::vector<std::uint32_t>;

// Streams of the kinds that stack simulations get wrong: near and far reuse, cycles around the bounds of the
// inner lists, numbers far apart.
Lines random_stream(std::uint64_t seed, std::size_t length) {
  std::mt19937_64 random(seed);
  const std::uint32_t spread = std::uint32_t{1} << (random() % 18);
  const std::uint32_t lines = 1 + static_cast<std::uint32_t>(random() % 600);
  Lines stream;
  while (stream.size() < length) {
    const auto start = static_cast<std::uint32_t>(random() % lines);
    const std::uint64_t kind = random() % 4;
    for (std::uint64_t left = 1 + random() % 80; left > 0 && stream.size() < length; --left) {
      std::uint32_t line = start;
      if (kind == 0) {
        line = static_cast<std::uint32_t>(random() % lines);
      } else if (kind == 1) {
        line = (start + static_cast<std::uint32_t>(left)) % lines;  // a sweep
      } else if (kind == 2) {
        line = start + static_cast<std::uint32_t>(left % (14 + start % 6));  // a cycle of 14 to 19 lines
      }
      stream.push_back(line * spread);
    }
  }
  return stream;
}

StackHistogram pass(const Lines& stream) {
  StackDistances distances;
  for (const std::uint32_t line : stream) {
    distances.access(line);
  }
  return distances.histogram();
}

std::int64_t simulate(const Lines& stream, std::uint32_t sets, std::uint32_t ways) {
  Cache cache({.size = std::uint64_t{sets} * ways * 4, .line = 4, .ways = ways});
  for (const std::uint32_t line : stream) {
    (void)cache.read(Address{line} * 4, 1);
  }
  return cache.counters().misses;
}

RC_GTEST_PROP(StackDistance, MissesAreThoseOfEverySizeSimulated, (std::uint64_t seed)) {
  const Lines stream = random_stream(seed, 3000);
  const StackHistogram found = pass(stream);
  const std::set<std::uint32_t> distinct(stream.begin(), stream.end());
  RC_ASSERT(found.references == static_cast<std::int64_t>(stream.size()));
  RC_ASSERT(found.compulsory == static_cast<std::int64_t>(distinct.size()));
  RC_ASSERT(found.enough() <= distinct.size());
  RC_ASSERT(found.misses(0) == found.references);
  RC_ASSERT(found.misses(found.enough()) == found.compulsory);
  for (std::uint32_t size = 1; size <= distinct.size() + 1; size += size < 20 ? 1 : 37) {
    RC_ASSERT(found.misses(size) == simulate(stream, 1, size));
    const std::uint64_t smallest = found.lines_for(found.misses(size));
    RC_ASSERT(smallest <= size && found.misses(smallest) == found.misses(size));
    RC_ASSERT((smallest == 0 || found.misses(smallest - 1) > found.misses(size)));
  }
}

RC_GTEST_PROP(StackDistance, AfterForgettingNothingOfTheOldStreamIsLeft, (std::uint64_t seed)) {
  const Lines first = random_stream(seed, 2000);
  const Lines second = random_stream(seed + 1, 2000);
  StackDistances both;
  for (const Lines* stream : {&first, &second, &first}) {
    for (const std::uint32_t line : *stream) {
      both.access(line);
    }
    both.clear();
  }
  StackHistogram sum = pass(first);
  sum += pass(second);
  sum += pass(first);
  RC_ASSERT(both.histogram() == sum);
}

TEST(StackDistance, NoCacheMissesFewerThanTheFirstUses) {
  EXPECT_EQ(pass({1, 2, 1}).lines_for(2), 2U);
  EXPECT_THROW((void)pass({1, 2, 1}).lines_for(1), sim::InternalError);
}

TEST(StackDistance, ACycleHitsInWholeOrNotAtAll) {
  for (const std::uint32_t lines : {1U, 2U, 15U, 16U, 17U, 18U, 1000U, 5000U}) {
    Lines stream;
    for (std::uint32_t round = 0; round < 4; ++round) {
      for (std::uint32_t line = 0; line < lines; ++line) {
        stream.push_back(line);
      }
    }
    const StackHistogram found = pass(stream);
    EXPECT_EQ(found.compulsory, lines);
    EXPECT_EQ(found.enough(), lines);
    EXPECT_EQ(found.misses(lines), lines);
    EXPECT_EQ(found.misses(lines - 1), 4 * lines) << lines;
  }
}

TEST(StackDistance, OneLineAndAllDifferentLines) {
  const StackHistogram one = pass(Lines(1000, 7));
  EXPECT_EQ(one.misses(0), 1000);
  EXPECT_EQ(one.misses(1), 1);
  Lines stream(100000);
  std::iota(stream.begin(), stream.end(), 0xfffffffeU - 99999U);
  const StackHistogram all = pass(stream);
  EXPECT_EQ(all.compulsory, 100000);
  EXPECT_EQ(all.enough(), 0U);
  EXPECT_EQ(all.misses(1U << 20U), 100000);
  EXPECT_EQ(pass({}), StackHistogram{});
}

TEST(StackDistance, MovingForwardsAndBackwardsHasAllDistances) {
  // 0 1 .. n-1 then n-1 .. 0: the line before d others comes back after exactly d.
  constexpr std::uint32_t lines = 20000;
  StackDistances distances;
  for (std::uint32_t line = 0; line < lines; ++line) {
    distances.access(line);
  }
  for (std::uint32_t line = lines; line-- > 0;) {
    distances.access(line);
  }
  const StackHistogram found = distances.histogram();
  ASSERT_EQ(found.enough(), lines);
  for (const std::int64_t hits : found.hits) {
    ASSERT_EQ(hits, 1);
  }
}

RC_GTEST_PROP(AllWays, MissesAreThoseOfEveryCacheSimulated, (std::uint64_t seed)) {
  const Lines stream = random_stream(seed, 1500);
  std::mt19937_64 random(seed);
  std::set<std::uint32_t> counts = {1, 2, 16};
  counts.insert(1 + static_cast<std::uint32_t>(random() % 40));
  counts.insert(1 + static_cast<std::uint32_t>(random() % 40));
  const auto most = 1 + static_cast<std::uint32_t>(random() % 20);
  AllWays pass({counts.rbegin(), counts.rend()}, most);
  for (const std::uint32_t line : stream) {
    pass.access(line);
  }
  const std::vector<WaysHistogram> found = pass.histograms();
  RC_ASSERT(found.size() == counts.size());
  auto sets = counts.begin();
  for (const WaysHistogram& histogram : found) {
    RC_ASSERT(histogram.sets == *sets);
    RC_ASSERT(histogram.misses(0) == static_cast<std::int64_t>(stream.size()));
    for (std::uint32_t ways = 1; ways <= most; ways += 1 + ways / 4) {
      RC_ASSERT(histogram.misses(ways) == simulate(stream, *sets, ways));
      // Inclusion: more ways hold all lines that fewer ways hold.
      RC_ASSERT(histogram.misses(ways) <= histogram.misses(ways - 1));
    }
    ++sets;
  }
}

RC_GTEST_PROP(AllWays, OneSetIsTheStackOfAllLines, (std::uint64_t seed)) {
  const Lines stream = random_stream(seed, 1500);
  const StackHistogram stack = pass(stream);
  AllWays ways({1}, 40);
  for (int round = 0; round < 2; ++round) {
    for (const std::uint32_t line : stream) {
      ways.access(line);
    }
    ways.clear();
  }
  const WaysHistogram found = ways.histograms()[0];
  for (std::uint32_t lines = 0; lines <= 40; ++lines) {
    RC_ASSERT(found.misses(lines) == 2 * stack.misses(lines));
  }
}

TEST(AllWays, RefusesWhatIsNoCache) {
  EXPECT_THROW(AllWays({}, 4), sim::UserError);
  EXPECT_THROW(AllWays({0}, 4), sim::UserError);
  EXPECT_THROW(AllWays({4, 4}, 4), sim::UserError);
  EXPECT_THROW(AllWays({4}, 0), sim::UserError);
  EXPECT_THROW(AllWays({1U << 20U}, 1U << 9U), sim::UserError);
  const AllWays pass({1}, 4);
  EXPECT_THROW((void)pass.histograms()[0].misses(5), sim::InternalError);
}

}  // namespace
}  // namespace marti::memory
