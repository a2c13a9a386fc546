#include "studies/sweep/work/sweep_results.h"

#include <algorithm>
#include <vector>

#include "sim/cpu_time.h"
#include "sim/error.h"
#include "studies/sweep/work/advice_work.h"

namespace marti::studies::sweep {

namespace {

// The first machines carry what is done for all, and those that other threads have begun: after one of a
// thousand the estimate was five times what the sweep took, after sixteen at most half as much again.
constexpr std::size_t enough_to_tell = 16;

}  // namespace

SweepResults::SweepResults(const SweepPlan& plan, SweepStore& store, Progress& progress)
    : store_(store), progress_(progress), plan_(plan), last_(sim::process_cpu_seconds()) {
  const std::vector<bool> frames = store.frames_done();
  const std::vector<bool> machines = store.done();
  for (std::size_t frame = 0; frame < frames.size(); ++frame) {
    frames_.left += frames[frame] ? 0.0 : plan.frames[frame].rays();
  }
  for (std::size_t machine = 0; machine < machines.size(); ++machine) {
    machines_.left += machines[machine] ? 0.0 : plan.frames[plan.machines[machine].frame].rays();
  }
  saved_ = static_cast<std::size_t>(std::ranges::count(machines, true));
  to_time_ = machines.size() - saved_;
  progress_.begin(plan.machines.size(), saved_, plan.frames.size(),
                  static_cast<std::size_t>(std::ranges::count(frames, true)));
}

double SweepResults::taken() {
  const double before = last_;
  last_ = sim::process_cpu_seconds();
  return last_ - before;
}

std::int64_t SweepResults::nanoseconds_left() const {
  if (timed_ < std::clamp<std::size_t>(to_time_ / 4, 1, enough_to_tell)) {
    return 0;
  }
  const double of_machines = machines_.seconds_left();
  return static_cast<std::int64_t>(
      1e9 * (frames_.seconds_left() + of_machines + advice_seconds(machines_.seconds + of_machines)));
}

void SweepResults::traced(std::size_t frame, const FrameRow& row, std::int64_t nanoseconds) {
  const std::lock_guard lock(mutex_);
  if (store_.add_frame(frame, row, nanoseconds)) {
    frames_.add(plan_.frames[frame].rays(), taken());
    progress_.traced(nanoseconds_left());
  }
}

void SweepResults::timed(std::size_t machine, const SweepRow& row, std::int64_t cpu_nanoseconds) {
  const std::lock_guard lock(mutex_);
  store_.add_result(machine, row, cpu_nanoseconds);
  ++saved_;
  ++timed_;
  machines_.add(plan_.frames[plan_.machines[machine].frame].rays(), taken());
  progress_.timed(nanoseconds_left());
}

void SweepResults::advised(std::size_t machine, const Advice& advice) {
  const std::lock_guard lock(mutex_);
  store_.add_advice(machine, advice);
}

std::size_t SweepResults::saved() {
  const std::lock_guard lock(mutex_);
  return saved_;
}

std::size_t SweepResults::close_for_good() {
  mutex_.lock();  // never unlocked: nothing may be written any more
  progress_.end();
  try {
    store_.close();
  } catch (const sim::UserError&) {
    // What is committed is safe in the log beside the store, which the next run takes in.
  }
  return saved_;
}

}  // namespace marti::studies::sweep
