// How far a long piece of work is: told by the threads that do it, asked by those that wait for it, who may
// also stop it. It changes no result.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>
#include <utility>

namespace marti::sim {

/// Thrown in place of a result for which nobody waits any more.
struct Stopped {};

/// Thread-safe.
class WorkMeter {
 public:
  WorkMeter() = default;
  /// A meter of its own that is stopped when `whole` is, which must outlive it.
  explicit WorkMeter(const WorkMeter* whole) : whole_(whole) {}
  WorkMeter(const WorkMeter&) = delete;
  WorkMeter& operator=(const WorkMeter&) = delete;

  struct State {
    std::string part{};      ///< what is being done: "tracing"; empty: nothing was begun
    std::string unit{};      ///< what its steps are: "rows"
    std::uint64_t done = 0;  ///< steps
    std::uint64_t of = 0;    ///< 0: its steps are not counted
  };

  /// Begins the next part of the work. Throws Stopped after stop(), as do the two below.
  void begin(std::string part, std::string unit = {}, std::uint64_t of = 0) {
    end_if_stopped();
    const std::lock_guard lock(mutex_);
    state_ = {std::move(part), std::move(unit), 0, of};
    done_ = 0;
  }
  /// So many steps more are done.
  void count(std::uint64_t steps = 1) {
    done_.fetch_add(steps, std::memory_order_relaxed);
    end_if_stopped();
  }
  void end_if_stopped() const {
    if (is_stopped()) {
      throw Stopped();
    }
  }

  /// Has the work end at its next step.
  void stop() { stopped_.store(true, std::memory_order_relaxed); }
  [[nodiscard]] bool is_stopped() const {
    return stopped_.load(std::memory_order_relaxed) || (whole_ != nullptr && whole_->is_stopped());
  }

  [[nodiscard]] State state() const {
    const std::lock_guard lock(mutex_);
    State now = state_;
    now.done = done_.load(std::memory_order_relaxed);
    return now;
  }

 private:
  const WorkMeter* whole_ = nullptr;
  mutable std::mutex mutex_;  // of state_
  State state_;
  std::atomic<std::uint64_t> done_ = 0;
  std::atomic<bool> stopped_ = false;
};

/// WorkMeter::begin(); does nothing if `meter` is null, because nobody waits.
inline void begin_part(WorkMeter* meter, std::string part, std::string unit = {}, std::uint64_t of = 0) {
  if (meter != nullptr) {
    meter->begin(std::move(part), std::move(unit), of);
  }
}
/// WorkMeter::count(); does nothing if `meter` is null.
inline void count_step(WorkMeter* meter, std::uint64_t steps = 1) {
  if (meter != nullptr) {
    meter->count(steps);
  }
}
/// WorkMeter::end_if_stopped(); does nothing if `meter` is null.
inline void end_if_stopped(const WorkMeter* meter) {
  if (meter != nullptr) {
    meter->end_if_stopped();
  }
}

}  // namespace marti::sim
