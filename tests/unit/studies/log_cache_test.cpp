// The cache of logs: with any limit, taking a log gives the log of its frame, and memory stays within
// bounds.
#include "studies/sweep/work/log_cache.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "sim/error.h"
#include "tests/support/random_machine.h"

namespace marti::studies {

using namespace sweep;

namespace {

using marti::test::Random;

std::vector<FrameLog> some_frames(std::size_t count) {
  Random random(count);
  std::vector<FrameLog> frames;
  for (std::size_t i = 0; i < count; ++i) {
    processors::program::WorkLog log =
        marti::test::random_log(random, 10, static_cast<std::uint32_t>(10 + i));
    frames.push_back({std::make_shared<const processors::program::WorkLog>(std::move(log)), {}});
    frames.back().row.scene = std::to_string(i);
  }
  return frames;
}

// The cache is to be the only owner.
FrameLog copy_of(const FrameLog& frame) {
  return {std::make_shared<const processors::program::WorkLog>(*frame.log), frame.row};
}
LogCache::Trace tracing(const FrameLog& frame) {
  return [&frame] { return copy_of(frame); };
}
FrameLog never() { throw sim::InternalError("traced again"); }

std::uint64_t largest(const std::vector<FrameLog>& frames) {
  std::uint64_t bytes = 0;
  for (const FrameLog& frame : frames) {
    bytes = std::max(bytes, memory_of(*frame.log));
  }
  return bytes;
}

bool equal(const FrameLog& a, const FrameLog& b) {
  return a.row == b.row &&
         std::equal(a.log->rows.begin(), a.log->rows.end(), b.log->rows.begin(), b.log->rows.end(),
                    [](const auto& x, const auto& y) { return x.words == y.words && x.begin == y.begin; });
}

void run_on_threads(unsigned threads, const std::function<void(unsigned)>& work) {
  std::vector<std::thread> running;
  for (unsigned thread = 0; thread < threads; ++thread) {
    running.emplace_back(work, thread);
  }
  for (std::thread& thread : running) {
    thread.join();
  }
}

RC_GTEST_PROP(LogCache, GivesTheLogOfEachFrame, (std::uint64_t seed)) {
  Random random(seed);
  const std::vector<FrameLog> frames = some_frames(6);
  const std::uint64_t most = largest(frames) + random() % (4 * largest(frames));
  LogCache cache(most);
  for (int step = 0; step < 40; ++step) {
    const std::size_t i = random() % frames.size();
    if (random() % 4 == 0) {
      cache.put(i, copy_of(frames[i]));
    } else {
      RC_ASSERT(equal(*cache.take(i, tracing(frames[i])), frames[i]));
      RC_ASSERT(equal(*cache.take(i, never), frames[i]));
    }
    RC_ASSERT(cache.in_memory() <= most);
  }
}

TEST(LogCache, ManyThreadsShareALittleMemory) {
  const std::vector<FrameLog> frames = some_frames(8);
  std::uint64_t all = 0;
  for (const FrameLog& frame : frames) {
    all += memory_of(*copy_of(frame).log);
  }
  for (const std::uint64_t limit : {std::uint64_t{0}, 2 * largest(frames), 5 * largest(frames)}) {
    LogCache cache(limit);
    std::atomic<std::uint64_t> wrong{0};
    std::atomic<std::uint64_t> traced{0};
    run_on_threads(4, [&](unsigned thread) {
      Random random(thread);
      for (int step = 0; step < 60; ++step) {
        const std::size_t i = random() % frames.size();
        const std::shared_ptr<const FrameLog> log = cache.take(i, [&] {
          ++traced;
          return copy_of(frames[i]);
        });
        wrong += equal(*log, frames[i]) ? 0U : 1U;
        wrong += cache.in_memory() <= std::max(limit, largest(frames)) ? 0U : 1U;
      }
    });
    EXPECT_EQ(wrong, 0U);
    EXPECT_EQ(traced > frames.size(), all > limit) << "some had to go";
    EXPECT_LE(cache.in_memory(), std::max(limit, largest(frames)));
  }
}

TEST(LogCache, WithRoomForAllEachIsTracedOnce) {
  const std::vector<FrameLog> frames = some_frames(3);
  LogCache cache(3 * largest(frames));
  std::atomic<int> traced{0};
  run_on_threads(4, [&](unsigned) {
    for (std::size_t i = 0; i < frames.size(); ++i) {
      EXPECT_TRUE(equal(*cache.take(i,
                                    [&] {
                                      ++traced;
                                      return copy_of(frames[i]);
                                    }),
                        frames[i]));
    }
  });
  EXPECT_EQ(traced, 3);
}

TEST(LogCache, WaitsForRoom) {
  const std::vector<FrameLog> frames = some_frames(2);
  LogCache cache(largest(frames));
  cache.put(0, copy_of(frames[0]));
  cache.put(1, copy_of(frames[1]));  // replaces the first, which is not in use
  std::shared_ptr<const FrameLog> held = cache.take(0, tracing(frames[0]));
  std::atomic<bool> let_go{false};
  bool waited = false;
  std::thread other([&] {
    const std::shared_ptr<const FrameLog> log = cache.take(1, tracing(frames[1]));
    waited = let_go;
    EXPECT_TRUE(equal(*log, frames[1]));
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  let_go = true;
  held.reset();
  other.join();
  EXPECT_TRUE(waited);
}

TEST(LogCache, WhatCannotBeTracedMayBeTriedAgain) {
  const std::vector<FrameLog> frames = some_frames(1);
  LogCache cache(0);
  EXPECT_THROW(static_cast<void>(cache.take(0, never)), sim::InternalError);
  EXPECT_TRUE(equal(*cache.take(0, tracing(frames[0])), frames[0]));
  cache.put(1, copy_of(frames[0]));  // the first has to go, but its size is known
  const std::uint64_t before = cache.in_memory();
  EXPECT_THROW(static_cast<void>(cache.take(0, never)), sim::InternalError);
  EXPECT_LE(cache.in_memory(), before);
  EXPECT_TRUE(equal(*cache.take(0, tracing(frames[0])), frames[0]));
}

TEST(LogCache, ALogOutlivesItsCache) {
  const std::vector<FrameLog> frames = some_frames(1);
  std::shared_ptr<const FrameLog> log;
  {
    LogCache cache(0);
    cache.put(0, copy_of(frames[0]));
    log = cache.take(0, never);
  }
  EXPECT_TRUE(equal(*log, frames[0]));
}

}  // namespace
}  // namespace marti::studies
