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
  /// All must outlive this object.
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
  /// How much of what a plan has is to do, in camera rays, and what that which was done took. Everything that
  /// the process does counts, as what comes before the next result: so what is done for many machines is in.
  struct Kind {
    double left = 0.0;
    double done = 0.0;
    double seconds = 0.0;  ///< of processor time

    void add(double rays, double taken) {
      left -= rays;
      done += rays;
      seconds += taken;
    }
    /// As long a ray as those done.
    [[nodiscard]] double seconds_left() const { return done == 0.0 ? 0.0 : seconds / done * left; }
  };
  /// Processor time since the last result.
  [[nodiscard]] double taken();
  /// 0 until enough machines were timed to tell.
  [[nodiscard]] std::int64_t nanoseconds_left() const;

  std::mutex mutex_;  // of all below
  SweepStore& store_;
  Progress& progress_;
  const SweepPlan& plan_;
  std::size_t saved_ = 0;
  std::size_t to_time_ = 0;  // machines of the plan that were not there at first
  std::size_t timed_ = 0;    // of these
  double last_;              // processor time of the process when the last result came
  Kind frames_;
  Kind machines_;
};

}  // namespace marti::studies::sweep
