// What machines that are timed at once share: memory, and how far they say they are.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <future>
#include <random>
#include <thread>
#include <vector>

#include "studies/sweep/work/memory_gate.h"
#include "studies/sweep/work/progress.h"
#include "studies/tables/text_units.h"

namespace marti::studies {

using namespace sweep;
using namespace tables;

namespace {

template <class Work>
void on_threads(unsigned count, const Work& work) {
  std::vector<std::jthread> threads;
  for (unsigned thread = 0; thread < count; ++thread) {
    threads.emplace_back([&work, thread] { work(thread); });
  }
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
  const MemoryGate::Pass all(gate, ~std::uint64_t{0});
}

TEST(Progress, SaysHowFarItIs) {
  EXPECT_EQ(progress_text(350, 1000, 1, 2, progress::Duration{125.0, 250.0}, 0),
            "350 of 1000 machines, 1 of 2 frames, 2 min 05 s left (4 min 10 s of processor time)");
  EXPECT_EQ(progress_text(3, 4, 1, 1, progress::Duration{0.9, 1.8}, 0), "3 of 4 machines, 1 of 1 frames")
      << "never 0 s for long";
  EXPECT_EQ(progress_text(3, 4, 1, 1, progress::Duration{-5.0, 0.0}, 0), "3 of 4 machines, 1 of 1 frames");
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
