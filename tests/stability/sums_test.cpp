// Sums near their ends, and a simulation that does not get on.
#include <cmath>
#include <cstdint>
#include <limits>

#include <gtest/gtest.h>

#include "memory/wait_statistics.h"
#include "sim/engine.h"
#include "sim/error.h"
#include "sim/statistics.h"

namespace marti::tests {
namespace {

constexpr std::int64_t last = std::numeric_limits<std::int64_t>::max();

// base + {0 .. 9}, each as often: the variance is 8.25, however much larger the samples and their sums are.
TEST(Sums, AThousandMillionSamplesKeepTheirDigits) {
  for (const std::int64_t base : {1'000'000LL, 1'000'000'000'000LL}) {
    sim::Moments block;
    for (int k = 0; k < 1'000'000; ++k) {
      block.add(base + k % 10);
    }
    sim::Moments all;
    for (int k = 0; k < 1000; ++k) {
      all.merge(block);
    }
    EXPECT_DOUBLE_EQ(*all.variance(), 8.25);
    EXPECT_DOUBLE_EQ(*all.mean(), static_cast<double>(base) + 4.5);
  }
  sim::Moments moments;
  for (int k = 0; k < 1000; ++k) {
    moments.add(last);
    moments.add(-last);
  }
  EXPECT_DOUBLE_EQ(*moments.variance(), std::ldexp(1.0, 126));
  EXPECT_EQ(*moments.mean(), 0.0);
}

TEST(Sums, WhatDoesNotFitIsAFaultOfOurs) {
  memory::WaitStatistics full;
  full.count = last;
  memory::WaitStatistics one;
  one.count = 1;
  EXPECT_THROW(sim::merge(full, one), sim::InternalError);
  sim::Moments moments;
  moments.add(last);
  moments.add(1);
  EXPECT_THROW((void)moments.sum(), sim::InternalError);
}

/// Hands every event straight back.
class Endless final : public sim::EventHandler {
 public:
  explicit Endless(sim::Engine& engine) : engine_(engine) {}
  void handle(const sim::Event& event) override { engine_.post(event); }

 private:
  sim::Engine& engine_;
};

TEST(Sums, ALoopOfEventsAtOneInstantIsStopped) {
  sim::Engine engine;
  Endless endless(engine);
  engine.attach(0, endless);
  engine.post(sim::Event::make(5, 0, 1));
  EXPECT_THROW(engine.run(1000), sim::InternalError);
}

}  // namespace
}  // namespace marti::tests
