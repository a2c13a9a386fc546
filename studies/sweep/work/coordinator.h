// The middle of a sweep: hands out tasks, takes results, keeps store and progress.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>

#include "studies/sweep/store/sweep_store.h"
#include "studies/sweep/work/progress.h"
#include "studies/sweep/work/schedule.h"
#include "studies/sweep/work/task_source.h"

namespace marti::studies::sweep {

/// Thread-safe. Each result is in the store before the call that brings it returns. As a TaskSource it gives
/// tasks to this process, which is place 0.
class Coordinator : public TaskSource {
 public:
  /// `over(frame)` is called once for each frame whose machines are all timed, by the thread that brought the
  /// last.
  Coordinator(const SweepPlan& plan, SweepStore& store, Progress& progress,
              std::function<void(std::size_t)> over, FrameCosts estimated = {});

  /// The next task of a place, see Schedule::next. Without `wait` it returns at once, perhaps with a task
  /// `wait`.
  [[nodiscard]] SweepTask next(std::size_t place, std::int64_t nanoseconds, bool wait);
  SweepTask next() override { return next(0, 0, true); }
  void traced(std::size_t frame, const FrameRow& row, std::int64_t cpu_nanoseconds) override;
  void timed(std::size_t machine, const SweepRow& row, std::int64_t cpu_nanoseconds) override;
  void stop() override;
  /// Saves what would help a machine (SweepStore::add_advice).
  void advised(std::size_t machine, const Advice& advice);
  /// As Schedule::nanoseconds_left.
  [[nodiscard]] std::int64_t nanoseconds_left();
  /// Machines of the plan that are saved.
  [[nodiscard]] std::size_t saved();
  /// Closes the store for good, once nobody is writing to it: for a program that is about to be ended.
  /// Returns how many machines of the plan are saved.
  std::size_t close_for_good();

 private:
  [[nodiscard]] std::int64_t nanoseconds_to_come() const;
  void tell_if_over(std::unique_lock<std::mutex>& lock, std::size_t frame);

  std::mutex mutex_;
  std::condition_variable news_;
  SweepStore& store_;
  Progress& progress_;
  std::function<void(std::size_t)> over_;
  Schedule schedule_;
  std::size_t machines_;
  bool stopped_ = false;
};

}  // namespace marti::studies::sweep
