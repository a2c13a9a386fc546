// How far a long piece of work is: told by the threads that do it, asked by those that wait for it, who may
// also stop it. It changes no result.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "sim/cpu_time.h"

namespace marti::sim {

class FinishedParts;

/// Thrown in place of a result for which nobody waits any more.
struct Stopped {};

/// How long something takes.
struct Duration {
  double seconds = 0.0;  ///< as people wait
  double processor =
      0.0;  ///< seconds of processor time: less beside other programs, more with several threads
};

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
    // Of the whole work, which may be planned as parts of several kinds:
    std::string whole_unit{};      ///< the kind of its parts, or "parts" if they are of several kinds
    std::uint64_t whole_done = 0;  ///< parts
    std::uint64_t whole_of = 0;    ///< 0: it was not planned
    Duration left{};               ///< all parts left, each as long as those of its kind took; 0: not known
  };

  /// The whole work has so many parts of this kind; said again, the number is another one.
  void plan(const std::string& kind, std::uint64_t parts) {
    const std::lock_guard lock(mutex_);
    kind_named(kind).of = parts;
  }
  /// One more part of this kind is there; `timed`: it was done since the part before it.
  void finish(const std::string& kind, bool timed) {
    {
      const std::lock_guard lock(mutex_);
      Kind& own = kind_named(kind);
      ++own.done;
      const Duration now = passed();
      if (timed) {
        ++own.timed;
        own.took.seconds += now.seconds - last_.seconds;
        own.took.processor += now.processor - last_.processor;
      }
      last_ = now;
    }
    end_if_stopped();
  }
  /// Where finished parts are kept (sim/finished_parts.h); null: nowhere.
  void keep_in(FinishedParts* parts) { parts_ = parts; }
  [[nodiscard]] FinishedParts* parts() const { return parts_; }

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
    add_whole(now);
    return now;
  }

 private:
  /// Parts of the whole work that take about equally long.
  struct Kind {
    std::string name;
    std::uint64_t of = 0;
    std::uint64_t done = 0;
    std::uint64_t timed = 0;  ///< of those that are done
    Duration took{};          ///< these, together
  };

  Kind& kind_named(const std::string& name) {
    const auto found = std::ranges::find(kinds_, name, &Kind::name);
    return found == kinds_.end() ? kinds_.emplace_back(Kind{name}) : *found;
  }

  /// Since the meter was made.
  [[nodiscard]] Duration passed() const {
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - made_;
    return {seconds.count(), process_cpu_seconds() - processor_made_};
  }

  void add_whole(State& now) const {
    Kind all;
    for (const Kind& kind : kinds_) {
      all.timed += kind.timed;
      all.took.seconds += kind.took.seconds;
      all.took.processor += kind.took.processor;
    }
    for (const Kind& kind : kinds_) {
      const std::uint64_t of = std::max(kind.of, kind.done);
      now.whole_of += of;
      now.whole_done += kind.done;
      now.whole_unit = kinds_.size() == 1 ? kind.name : "parts";
      // A kind of which nothing is known yet takes as long as the others.
      const Kind& like = kind.timed > 0 ? kind : all;
      if (like.timed > 0) {
        const double times = static_cast<double>(of - kind.done) / static_cast<double>(like.timed);
        now.left.seconds += times * like.took.seconds;
        now.left.processor += times * like.took.processor;
      }
    }
    const Duration since = passed();
    now.left.seconds = std::max(0.0, now.left.seconds - (since.seconds - last_.seconds));
    now.left.processor = std::max(0.0, now.left.processor - (since.processor - last_.processor));
  }

  const WorkMeter* whole_ = nullptr;
  mutable std::mutex mutex_;  // of all but done_ and stopped_
  State state_;
  std::vector<Kind> kinds_;
  Duration last_;  // when the last part was finished
  std::chrono::steady_clock::time_point made_ = std::chrono::steady_clock::now();
  double processor_made_ = process_cpu_seconds();
  FinishedParts* parts_ = nullptr;
  std::atomic<std::uint64_t> done_ = 0;
  std::atomic<bool> stopped_ = false;
};

/// WorkMeter::plan(); does nothing if `meter` is null, because nobody waits.
inline void plan_parts(WorkMeter* meter, const std::string& kind, std::uint64_t parts) {
  if (meter != nullptr) {
    meter->plan(kind, parts);
  }
}
/// WorkMeter::finish() of a part that was done now; does nothing if `meter` is null.
inline void finish_part(WorkMeter* meter, const std::string& kind) {
  if (meter != nullptr) {
    meter->finish(kind, true);
  }
}
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
