// A cache before the banks, to the tick.
#include "memory/shared_cache.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "memory/bank.h"
#include "sim/error.h"

namespace marti::memory {
namespace {

// Lines of 32 bytes, a hit in 20 ticks; a bank reads in 40 and is busy for 60.
BankConfig cached(std::uint64_t lines) {
  BankConfig banks;
  banks.count = 2;
  banks.interleave = 32;
  banks.clock = sim::Clock::from_period(10);
  banks.access_cycles = 4;
  banks.busy_cycles = 6;
  banks.cache =
      SharedCacheConfig{{.size = 32 * lines, .line = 32, .ways = full_ways}, sim::Clock::from_period(10), 2};
  return banks;
}

TEST(SharedCache, AHitTakesItsCyclesAndNoBank) {
  Banks banks(cached(4));
  EXPECT_EQ(banks.read(0, 1, 100).ready, 140) << "a miss is its bank's access";
  const BankAccess hit = banks.read(31, 1, 500);
  EXPECT_EQ(hit.start, 500);
  EXPECT_EQ(hit.ready, 520);
  EXPECT_EQ(banks.read(0, 1, 500).ready, 520) << "hits do not wait for each other";
  EXPECT_EQ(banks.statistics()[0].accesses, 1);
  EXPECT_EQ(banks.cache_statistics()->lookups.hits, 2);
  EXPECT_EQ(banks.cache_statistics()->lookups.misses, 1);
}

TEST(SharedCache, ALineOnItsWayIsNotReadyBeforeItIsThere) {
  Banks banks(cached(4));
  (void)banks.read(0, 1, 100);  // there at 140
  EXPECT_EQ(banks.read(0, 1, 110).ready, 140);
  EXPECT_EQ(banks.read(0, 1, 120).ready, 140);
  EXPECT_EQ(banks.read(0, 1, 121).ready, 141);
  EXPECT_EQ(banks.cache_statistics()->waits.sum, 10);
  EXPECT_EQ(banks.statistics()[0].accesses, 1);
}

TEST(SharedCache, WritesGoToTheirBankAndLeaveTheLines) {
  Banks banks(cached(1));
  (void)banks.read(0, 1, 0);
  EXPECT_EQ(banks.write(0, 1, 100).ready, 140);
  EXPECT_EQ(banks.write(64, 1, 200).ready, 240) << "a write brings nothing in";
  EXPECT_EQ(banks.read(0, 1, 300).ready, 320) << "and takes nothing out";
  EXPECT_EQ(banks.statistics()[0].accesses, 3);
}

TEST(SharedCache, RandomReadsAgreeWithTheCacheAloneAndEveryArrivalOfALine) {
  std::mt19937_64 random(4);
  for (int round = 0; round < 30; ++round) {
    const BankConfig config = cached(1 + random() % 200);
    Banks banks(config);
    Cache alone(config.cache->cache);
    std::map<Address, sim::Ticks> there;
    sim::Ticks now = 0;
    for (int i = 0; i < 3000; ++i) {
      now += static_cast<sim::Ticks>(random() % 25);
      const Address line = random() % 300;
      const bool hit = alone.read(line * 32, 1) == 0;
      const BankAccess access = banks.read(line * 32 + random() % 32, 1, now);
      if (hit) {
        ASSERT_EQ(access.ready, std::max(now + 20, there.at(line)));
      } else {
        ASSERT_GE(access.ready, now + 40);
        there[line] = access.ready;
      }
    }
    EXPECT_EQ(banks.statistics()[0].accesses + banks.statistics()[1].accesses, alone.counters().misses);
  }
}

TEST(SharedCache, AnImpossibleOneIsRefused) {
  BankConfig config = cached(4);
  config.cache->cache.size = 33;
  EXPECT_THROW(Banks{config}, sim::UserError);
}

}  // namespace
}  // namespace marti::memory
