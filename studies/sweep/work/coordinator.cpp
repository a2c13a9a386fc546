#include "studies/sweep/work/coordinator.h"

#include <utility>

#include "sim/error.h"

namespace marti::studies::sweep {

Coordinator::Coordinator(const SweepPlan& plan, SweepStore& store, Progress& progress,
                         std::function<void(std::size_t)> over, FrameCosts estimated)
    : store_(store),
      progress_(progress),
      over_(std::move(over)),
      schedule_(plan, store.done(), store.frames_done(), std::move(estimated)),
      machines_(plan.machines.size()) {
  progress_.begin(machines_, machines_ - schedule_.machines_left(), plan.frames.size(),
                  plan.frames.size() - schedule_.frames_left());
}

SweepTask Coordinator::next(std::size_t place, std::int64_t nanoseconds, bool wait) {
  std::unique_lock lock(mutex_);
  for (;;) {
    if (stopped_) {
      return {};
    }
    SweepTask task = schedule_.next(place, nanoseconds);
    if (task.kind != SweepTask::Kind::wait || !wait) {
      return task;
    }
    news_.wait(lock);
  }
}

void Coordinator::traced(std::size_t frame, const FrameRow& row, std::int64_t cpu_nanoseconds) {
  std::unique_lock lock(mutex_);
  store_.add_frame(frame, row, cpu_nanoseconds);
  schedule_.traced(frame, cpu_nanoseconds);
  progress_.traced(nanoseconds_to_come());
  news_.notify_all();
  tell_if_over(lock, frame);
}

void Coordinator::timed(std::size_t machine, const SweepRow& row, std::int64_t cpu_nanoseconds) {
  std::unique_lock lock(mutex_);
  store_.add_result(machine, row, cpu_nanoseconds);
  const std::size_t frame = schedule_.timed(machine, cpu_nanoseconds);
  progress_.timed(nanoseconds_to_come());
  if (schedule_.finished()) {
    news_.notify_all();
  }
  tell_if_over(lock, frame);
}

void Coordinator::advised(std::size_t machine, const Advice& advice) {
  const std::lock_guard lock(mutex_);
  store_.add_advice(machine, advice);
}

// Calls over_() without the lock: when a signal ends the program, removing a file waits for ever, and
// close_for_good(), which takes the lock, must not wait for that.
void Coordinator::tell_if_over(std::unique_lock<std::mutex>& lock, std::size_t frame) {
  const bool over = schedule_.over(frame);
  lock.unlock();
  if (over) {
    over_(frame);
  }
}

// What is under way is half done, on average.
std::int64_t Coordinator::nanoseconds_to_come() const {
  return schedule_.nanoseconds_left() + schedule_.nanoseconds_under_way() / 2;
}

void Coordinator::stop() {
  const std::lock_guard lock(mutex_);
  stopped_ = true;
  news_.notify_all();
}

std::int64_t Coordinator::nanoseconds_left() {
  const std::lock_guard lock(mutex_);
  return schedule_.nanoseconds_left();
}

std::size_t Coordinator::saved() {
  const std::lock_guard lock(mutex_);
  return machines_ - schedule_.machines_left();
}

std::size_t Coordinator::close_for_good() {
  mutex_.lock();  // never unlocked: nothing may be written any more
  progress_.end();
  try {
    store_.close();
  } catch (const sim::UserError&) {
    // What is committed is safe in the log beside the store, which the next run takes in.
  }
  return machines_ - schedule_.machines_left();
}

}  // namespace marti::studies::sweep
