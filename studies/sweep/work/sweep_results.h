// Where a sweep's results go: into the store, and as progress on standard error.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>

#include "studies/sweep/store/sweep_store.h"
#include "studies/sweep/work/progress.h"

namespace marti::studies::sweep {

/// Thread-safe. Each result is in the store before the call that brings it returns.
class SweepResults {
 public:
  SweepResults(const SweepPlan& plan, SweepStore& store, Progress& progress);

  void traced(std::size_t frame, const FrameRow& row, std::int64_t nanoseconds);
  void timed(std::size_t machine, const SweepRow& row, std::int64_t cpu_nanoseconds);
  void advised(std::size_t machine, const Advice& advice);

  /// Machines of the plan that are saved.
  [[nodiscard]] std::size_t saved();
  /// Closes the store for good, once nobody is writing to it: for a program that is about to be ended.
  /// Returns how many machines of the plan are saved.
  std::size_t close_for_good();

 private:
  /// How many of what a plan has are to do, and what those that were done took.
  struct Kind {
    std::size_t left = 0;
    std::int64_t done = 0;
    std::int64_t nanoseconds = 0;

    void add(std::int64_t taken) {
      --left;
      ++done;
      nanoseconds += taken;
    }
    /// By the mean of those done; 0 while nothing is known.
    [[nodiscard]] std::int64_t nanoseconds_left() const {
      return done == 0 ? 0 : nanoseconds / done * static_cast<std::int64_t>(left);
    }
  };
  [[nodiscard]] std::int64_t nanoseconds_left() const {
    return frames_.nanoseconds_left() + machines_.nanoseconds_left();
  }

  std::mutex mutex_;  // of all below
  SweepStore& store_;
  Progress& progress_;
  std::size_t planned_;
  Kind frames_;
  Kind machines_;
};

}  // namespace marti::studies::sweep
