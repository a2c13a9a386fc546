#include "studies/sweep/work/sweep_results.h"

#include <algorithm>

#include "sim/error.h"

namespace marti::studies::sweep {

SweepResults::SweepResults(const SweepPlan& plan, SweepStore& store, Progress& progress)
    : store_(store), progress_(progress), planned_(plan.machines.size()) {
  frames_.left = static_cast<std::size_t>(std::ranges::count(store.frames_done(), false));
  machines_.left = static_cast<std::size_t>(std::ranges::count(store.done(), false));
  progress_.begin(planned_, planned_ - machines_.left, plan.frames.size(), plan.frames.size() - frames_.left);
}

void SweepResults::traced(std::size_t frame, const FrameRow& row, std::int64_t nanoseconds) {
  const std::lock_guard lock(mutex_);
  if (store_.add_frame(frame, row, nanoseconds)) {
    frames_.add(nanoseconds);
    progress_.traced(nanoseconds_left());
  }
}

void SweepResults::timed(std::size_t machine, const SweepRow& row, std::int64_t cpu_nanoseconds) {
  const std::lock_guard lock(mutex_);
  store_.add_result(machine, row, cpu_nanoseconds);
  machines_.add(cpu_nanoseconds);
  progress_.timed(nanoseconds_left());
}

void SweepResults::advised(std::size_t machine, const Advice& advice) {
  const std::lock_guard lock(mutex_);
  store_.add_advice(machine, advice);
}

std::size_t SweepResults::saved() {
  const std::lock_guard lock(mutex_);
  return planned_ - machines_.left;
}

std::size_t SweepResults::close_for_good() {
  mutex_.lock();  // never unlocked: nothing may be written any more
  progress_.end();
  try {
    store_.close();
  } catch (const sim::UserError&) {
    // What is committed is safe in the log beside the store, which the next run takes in.
  }
  return planned_ - machines_.left;
}

}  // namespace marti::studies::sweep
