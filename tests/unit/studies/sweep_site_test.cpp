// What the workers of a sweep share: stripped logs, memory, and how far they say they are.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <future>
#include <limits>
#include <memory>
#include <random>
#include <thread>
#include <vector>

#include "studies/sweep/work/memory_gate.h"
#include "studies/sweep/work/progress.h"
#include "studies/sweep/work/stripped_log_cache.h"
#include "studies/tables/text_units.h"
#include "tests/support/random_machine.h"

namespace marti::studies {

using namespace sweep;
using namespace tables;

namespace {

using processors::machine::MachineConfig;
using processors::program::WorkLog;
using processors::walk::StrippedLog;

constexpr std::uint64_t plenty = std::numeric_limits<std::uint64_t>::max();
constexpr std::size_t enough = StrippedLogCache::fewest_machines;

std::shared_ptr<const WorkLog> some_log(std::uint64_t seed) {
  test::Random random(seed);
  return std::make_shared<const WorkLog>(test::random_log(random, 24, 24));
}

MachineConfig with_line(std::uint32_t line) {
  MachineConfig machine;
  machine.cache.cache.line = line;
  return machine;
}

constexpr std::array<std::uint32_t, 1> four_ways = {4};

template <class Work>
void on_threads(unsigned count, const Work& work) {
  std::vector<std::jthread> threads;
  for (unsigned thread = 0; thread < count; ++thread) {
    threads.emplace_back([&work, thread] { work(thread); });
  }
}

TEST(StrippedLogCache, OneIsMadeForAllThatAsk) {
  const std::shared_ptr<const WorkLog> log = some_log(1);
  StrippedLogCache cache(plenty);
  std::array<std::shared_ptr<const StrippedLog>, 8> found;
  on_threads(8, [&](unsigned thread) {
    MachineConfig machine = with_line(32);
    machine.nodes = 1 + thread;  // machines of other sizes share it
    found.at(thread) = cache.get(0, log, machine, 8, four_ways);
  });
  ASSERT_NE(found[0], nullptr);
  EXPECT_TRUE(found[0]->fits(*log));
  EXPECT_EQ(found[0]->key(), StrippedLog::key_of(with_line(32)));
  for (const auto& other : found) {
    EXPECT_EQ(other, found[0]);
  }
  EXPECT_NE(cache.get(0, log, with_line(64), 8, four_ways), found[0]);
  EXPECT_NE(cache.get(1, log, with_line(32), 8, four_ways), found[0]) << "another frame's";
}

TEST(StrippedLogCache, OnePassServesAllWays) {
  const std::shared_ptr<const WorkLog> log = some_log(5);
  StrippedLogCache cache(plenty);
  constexpr std::array<std::uint32_t, 4> all_ways = {0, 1, 2, 8};
  const std::uint32_t sets = memory::shape_of(with_line(32).cache.cache).sets;
  for (const std::uint32_t ways : all_ways) {
    MachineConfig machine = with_line(32);
    machine.cache.cache.ways = ways == 0 ? 2 : ways;
    machine.cache.cache.size = std::uint64_t{sets} * machine.cache.cache.ways * 32;
    machine.cache.cache.replacement = ways == 0 ? memory::Replacement::fifo : memory::Replacement::lru;
    const auto found = cache.get(0, log, machine, enough, all_ways);
    ASSERT_NE(found, nullptr);
    EXPECT_EQ(found->ways(), ways);
    EXPECT_EQ(found->references(), StrippedLog::make(*log, machine)->references());
    EXPECT_EQ(cache.get(0, log, machine, enough, all_ways), found) << "made once";
  }
}

TEST(StrippedLogCache, NoneWhereItDoesNotPayOrFit) {
  const std::shared_ptr<const WorkLog> log = some_log(2);
  StrippedLogCache cache(plenty);
  EXPECT_EQ(cache.get(0, log, with_line(32), enough - 1, four_ways), nullptr);
  constexpr std::array<std::uint32_t, 1> no_lru = {0};
  MachineConfig fifo = with_line(32);
  fifo.cache.cache.replacement = memory::Replacement::fifo;
  EXPECT_EQ(cache.get(3, log, fifo, StrippedLogCache::fewest_without_lru - 1, no_lru), nullptr);
  EXPECT_NE(cache.get(3, log, fifo, StrippedLogCache::fewest_without_lru, no_lru), nullptr);
  MachineConfig without = with_line(32);
  without.cache.organisation = processors::machine::CacheOrganisation::none;
  EXPECT_EQ(cache.get(0, log, without, 100, four_ways), nullptr);
  const auto made = cache.get(0, log, with_line(32), enough, four_ways);
  ASSERT_NE(made, nullptr);
  // Room for one of two: the one with more ways is made.
  constexpr std::array<std::uint32_t, 2> two_and_four = {2, 4};
  MachineConfig two = with_line(32);
  two.cache.cache.ways = 2;
  two.cache.cache.size /= 2;
  const std::uint64_t larger = StrippedLog::make(*log, two)->bytes_of_words();
  ASSERT_GT(larger, made->bytes_of_words());
  const std::uint64_t packets = std::uint64_t{3} * 3 * (sizeof(processors::walk::PacketTotals) + 2 * 8);
  StrippedLogCache narrow(StrippedLogCache::most_kept * (made->bytes_of_words() + packets));
  EXPECT_NE(narrow.get(0, log, with_line(32), enough, two_and_four), nullptr);
  EXPECT_EQ(narrow.get(0, log, two, enough, two_and_four), nullptr);
  // Room for one and a half: each may take its part of it only.
  StrippedLogCache small(made->bytes_of_words() * 3 / 2);
  EXPECT_EQ(small.get(0, log, with_line(32), enough, four_ways), nullptr);
  EXPECT_EQ(small.get(0, log, with_line(32), enough, four_ways), nullptr) << "the same the second time";
}

TEST(StrippedLogCache, KeepsThoseUsedLast) {
  const std::shared_ptr<const WorkLog> log = some_log(3);
  StrippedLogCache cache(plenty);
  static_assert(StrippedLogCache::most_kept == 2);
  std::weak_ptr<const StrippedLog> first = cache.get(0, log, with_line(16), enough, four_ways);
  const std::weak_ptr<const StrippedLog> second = cache.get(0, log, with_line(32), enough, four_ways);
  EXPECT_EQ(cache.get(0, log, with_line(16), enough, four_ways), first.lock());
  std::shared_ptr<const StrippedLog> third = cache.get(0, log, with_line(64), enough, four_ways);
  EXPECT_FALSE(first.expired()) << "used later than the second";
  EXPECT_TRUE(second.expired());
  cache.drop(1);
  EXPECT_FALSE(first.expired()) << "of another frame";
  cache.drop(0);
  EXPECT_TRUE(first.expired());
  EXPECT_NE(third, nullptr);
  EXPECT_EQ(third.use_count(), 1) << "the cache has let go, the user has not";
}

TEST(StrippedLogCache, ThreadsOfManyBatches) {
  const std::shared_ptr<const WorkLog> log = some_log(4);
  std::array<std::uint64_t, 4> references{};
  for (std::size_t i = 0; i < references.size(); ++i) {
    references.at(i) = StrippedLog::make(*log, with_line(16U << i))->references();
  }
  StrippedLogCache cache(plenty);
  on_threads(6, [&](unsigned thread) {
    test::Random random(thread);
    for (int round = 0; round < 20; ++round) {
      const std::size_t which = random() % references.size();
      const auto found = cache.get(0, log, with_line(16U << which), enough, four_ways);
      ASSERT_NE(found, nullptr);
      EXPECT_EQ(found->references(), references.at(which));
      if (random() % 8 == 0) {
        cache.drop(0);
      }
    }
  });
}

TEST(MemoryGate, StaysWithinItsLimitUnlessOneIsAlone) {
  constexpr std::uint64_t limit = 100;
  MemoryGate gate(limit);
  std::atomic<std::uint64_t> in_use = 0;
  std::atomic<std::uint64_t> passes = 0;
  on_threads(6, [&](unsigned thread) {
    std::mt19937_64 random(thread);
    for (int round = 0; round < 300; ++round) {
      const std::uint64_t bytes = random() % 12 == 0 ? limit + random() % 1000 : random() % 60;
      const MemoryGate::Pass pass(gate, bytes);
      const std::uint64_t together = in_use.fetch_add(bytes) + bytes;
      EXPECT_TRUE(together <= limit || together == bytes) << together << " with " << bytes;
      ++passes;
      std::this_thread::yield();
      in_use.fetch_sub(bytes);
    }
  });
  EXPECT_EQ(passes, 6U * 300U) << "all came through";
}

TEST(MemoryGate, WaitsForRoom) {
  MemoryGate gate(100);
  auto first = std::make_unique<MemoryGate::Pass>(gate, 60);
  auto second = std::make_unique<MemoryGate::Pass>(gate, 40);
  std::future<void> third = std::async(std::launch::async, [&] { const MemoryGate::Pass pass(gate, 50); });
  EXPECT_EQ(third.wait_for(std::chrono::milliseconds(30)), std::future_status::timeout);
  second.reset();
  EXPECT_EQ(third.wait_for(std::chrono::milliseconds(30)), std::future_status::timeout) << "60 + 50 > 100";
  first.reset();
  third.get();
  const MemoryGate::Pass all(gate, plenty);
}

TEST(Progress, SaysHowFarItIs) {
  EXPECT_EQ(progress_text(350, 1000, 1, 2, 125.0, 0), "350 of 1000 machines, 1 of 2 frames, 2 min 05 s left");
  EXPECT_EQ(progress_text(3, 4, 1, 1, 0.9, 0), "3 of 4 machines, 1 of 1 frames") << "never 0 s for long";
  EXPECT_EQ(progress_text(3, 4, 1, 1, -5.0, 0), "3 of 4 machines, 1 of 1 frames");
  EXPECT_EQ(progress_text(0, 0, 0, 0, std::nullopt, 0), "0 of 0 machines, 0 of 0 frames");
  EXPECT_EQ(progress_text(1, 4, 0, 1, std::nullopt, 8), "[##......] 1 of 4 machines, 0 of 1 frames");
  EXPECT_EQ(progress_text(0, 0, 1, 1, std::nullopt, 2), "[##] 0 of 0 machines, 1 of 1 frames");
  EXPECT_EQ(progress_text(999, 1000, 1, 1, std::nullopt, 4).substr(0, 6), "[###.]") << "full at the end only";
}

RC_GTEST_PROP(Progress, TheBarIsAsWideAsItIs, ()) {
  const auto machines = *rc::gen::inRange<std::size_t>(0, 1000000);
  const auto done = *rc::gen::inRange<std::size_t>(0, machines + 1);
  const auto width = *rc::gen::inRange<std::size_t>(1, 80);
  const std::string text = progress_text(done, machines, 0, 1, std::nullopt, width);
  RC_ASSERT(text.find(']') == width + 1);
  RC_ASSERT((text.find('.') > width) == (done == machines));
}

RC_GTEST_PROP(DurationText, NoPartBecomesSixty, ()) {
  const double seconds = *rc::gen::inRange(0, 30'000'000) * 0.01;
  const std::string text = duration_text(seconds);
  RC_ASSERT(text.find("60") == std::string::npos || text.starts_with("60 h"));
  // Read back, it is what it was, to a half of its last part.
  double a = 0.0;
  double b = 0.0;
  if (std::sscanf(text.c_str(), "%lf min %lf s", &a, &b) == 2) {
    RC_ASSERT(std::abs(60.0 * a + b - seconds) < 0.51);
  } else if (std::sscanf(text.c_str(), "%lf h %lf min", &a, &b) == 2) {
    RC_ASSERT(std::abs(3600.0 * a + 60.0 * b - seconds) < 30.1);
  } else {
    RC_ASSERT(std::sscanf(text.c_str(), "%lf s", &a) == 1);
    RC_ASSERT(std::abs(a - seconds) < 0.051);
  }
}

std::string shown(bool terminal, bool quiet) {
  std::FILE* out = std::tmpfile();
  Progress progress({terminal, quiet, out, 2, std::chrono::milliseconds(20)});
  progress.begin(3, 1, 1, 0);
  progress.traced(500);
  progress.timed(300);
  progress.timed(0);
  if (terminal && !quiet) {
    // Until the bar is drawn.
    while (std::fflush(out) == 0 && std::ftell(out) <= 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  progress.end();
  std::rewind(out);
  std::string text;
  for (int c = std::fgetc(out); c != EOF; c = std::fgetc(out)) {
    text += static_cast<char>(c);
  }
  std::fclose(out);
  return text;
}

TEST(Progress, TheLastLineAlwaysComesAndTheBarGoes) {
  EXPECT_EQ(shown(false, true), "");
  EXPECT_EQ(shown(false, false), "3 of 3 machines, 1 of 1 frames\n");
  const std::string bar = shown(true, false);
  EXPECT_NE(bar.find("3 of 3 machines, 1 of 1 frames"), std::string::npos);
  const std::size_t blank = bar.rfind("\r ");
  ASSERT_NE(blank, std::string::npos);
  EXPECT_EQ(bar.find_first_not_of(' ', blank + 1), bar.size() - 1);
  EXPECT_EQ(bar.back(), '\r');
}

}  // namespace
}  // namespace marti::studies
