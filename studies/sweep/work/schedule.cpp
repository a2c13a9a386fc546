#include "studies/sweep/work/schedule.h"

#include <algorithm>
#include <utility>

#include "sim/error.h"
#include "studies/sweep/work/batches.h"

namespace marti::studies::sweep {

Schedule::Schedule(const SweepPlan& plan, const std::vector<bool>& machines_done,
                   const std::vector<bool>& frames_done, FrameCosts estimated)
    : plan_(plan),
      estimated_(std::move(estimated)),
      frames_(plan.frames.size()),
      batch_of_(plan.machines.size()) {
  std::vector<std::size_t> left;
  for (std::size_t machine = 0; machine < plan.machines.size(); ++machine) {
    if (!machines_done[machine]) {
      left.push_back(machine);
    }
  }
  machines_left_ = left.size();
  for (MachineBatch& made : batches_of(plan, left)) {
    Batch& batch = batches_.emplace_back();
    for (const std::size_t machine : made.machines) {
      batch_of_[machine] = batches_.size() - 1;
    }
    batch.frame = made.frame;
    batch.ways = std::move(made.ways);
    batch.machines = std::move(made.machines);
    batch.size = batch.machines.size();
    std::ranges::reverse(batch.machines);
    Frame& frame = frames_[batch.frame];
    frame.batches.push_back(batches_.size() - 1);
    frame.left += batch.size;
    frame.to_hand_out += batch.size;
  }
  for (std::size_t frame = 0; frame < frames_.size(); ++frame) {
    if (frames_[frame].left == 0 && frames_done[frame]) {
      frames_[frame].trace = Trace::done;
    } else {
      ++frames_left_;
    }
  }
}

std::int64_t Schedule::cost_of(const Batch& batch) const {
  if (batch.timed != 0) {
    return batch.spent / batch.timed;
  }
  return share_of(estimated_.timing, batch.frame, spent_, estimated_timing_, timed_);
}

std::int64_t Schedule::share_of(const std::vector<double>& estimated, std::size_t frame, std::int64_t spent,
                                double estimated_of_done, std::int64_t done) {
  if (done == 0) {
    return 0;
  }
  if (frame < estimated.size() && estimated_of_done > 0.0) {
    return static_cast<std::int64_t>(static_cast<double>(spent) * (estimated[frame] / estimated_of_done));
  }
  return spent / done;
}

// A batch with machines to hand out and a traced log; batches_.size() when there is none.
std::size_t Schedule::choose_batch(std::size_t place) const {
  const std::size_t none = batches_.size();
  std::size_t mine = none;
  std::size_t fresh = none;
  std::size_t longest = none;
  std::int64_t most = -1;
  for (std::size_t number = 0; number < batches_.size(); ++number) {
    const Batch& batch = batches_[number];
    if (batch.machines.empty() || frames_[batch.frame].trace != Trace::done) {
      continue;
    }
    if (batch.place == place && mine == none) {
      mine = number;
    }
    if (batch.place == no_place && fresh == none) {
      fresh = number;
    }
    // The nanosecond added for each machine orders batches by size while no cost is known.
    const std::int64_t left = static_cast<std::int64_t>(batch.machines.size()) * (cost_of(batch) + 1);
    if (left > most) {
      most = left;
      longest = number;
    }
  }
  return mine != none ? mine : fresh != none ? fresh : longest;
}

// The first frame that waits to be traced; frames_.size() when there is none.
std::size_t Schedule::frame_to_trace() const {
  for (std::size_t number = 0; number < frames_.size(); ++number) {
    if (frames_[number].trace == Trace::waiting) {
      return number;
    }
  }
  return frames_.size();
}

SweepTask Schedule::next(std::size_t place, std::int64_t nanoseconds) {
  const std::size_t waiting = frame_to_trace();
  // Logs that are traced or being traced, and that machines still need.
  std::size_t ahead = 0;
  for (const Frame& frame : frames_) {
    ahead +=
        frame.trace == Trace::under_way || (frame.trace == Trace::done && frame.to_hand_out != 0) ? 1 : 0;
  }
  // The first log, and one more while the last machines of the one before are handed out.
  const std::size_t number = choose_batch(place);
  if (waiting != frames_.size() && (ahead == 0 || (ahead == 1 && number == batches_.size()))) {
    frames_[waiting].trace = Trace::under_way;
    return {SweepTask::Kind::trace, waiting};
  }
  if (number == batches_.size()) {
    return {finished() ? SweepTask::Kind::end : SweepTask::Kind::wait};
  }
  Batch& batch = batches_[number];
  if (batch.place == no_place) {
    batch.place = place;
  }
  SweepTask task{SweepTask::Kind::time, batch.frame, {}, batch.size, batch.ways};
  const std::int64_t each = std::max<std::int64_t>(1, cost_of(batch));
  std::int64_t given = 0;
  std::size_t timing = 0;
  do {
    timing = plan_.machines[batch.machines.back()].timing;
    task.machines.push_back(batch.machines.back());
    batch.machines.pop_back();
    --frames_[batch.frame].to_hand_out;
    given += each;
  } while (!batch.machines.empty() && (plan_.machines[batch.machines.back()].timing == timing ||
                                       (batch.timed != 0 && given + each <= nanoseconds)));
  return task;
}

void Schedule::traced(std::size_t frame, std::int64_t cpu_nanoseconds) {
  sim::ensure(frames_[frame].trace == Trace::under_way, "a frame was traced that nobody was given");
  frames_[frame].trace = Trace::done;
  --frames_left_;
  ++traced_;
  estimated_tracing_ += frame < estimated_.tracing.size() ? estimated_.tracing[frame] : 0.0;
  spent_tracing_ += cpu_nanoseconds;
}

std::size_t Schedule::timed(std::size_t machine, std::int64_t cpu_nanoseconds) {
  Batch& batch = batches_[batch_of_[machine]];
  sim::ensure(frames_[batch.frame].left != 0, "a machine was timed twice");
  --frames_[batch.frame].left;
  --machines_left_;
  ++batch.timed;
  batch.spent += cpu_nanoseconds;
  ++timed_;
  estimated_timing_ += batch.frame < estimated_.timing.size() ? estimated_.timing[batch.frame] : 0.0;
  spent_ += cpu_nanoseconds;
  return batch.frame;
}

bool Schedule::over(std::size_t frame) const {
  return frames_[frame].trace == Trace::done && frames_[frame].left == 0;
}

bool Schedule::finished() const { return machines_left_ == 0 && frames_left_ == 0; }

std::int64_t Schedule::nanoseconds_left() const {
  std::int64_t left = 0;
  for (const Batch& batch : batches_) {
    left += static_cast<std::int64_t>(batch.machines.size()) * cost_of(batch);
  }
  return left + tracing_of(Trace::waiting);
}

std::int64_t Schedule::nanoseconds_under_way() const {
  std::int64_t under_way = 0;
  for (const Batch& batch : batches_) {
    const auto handed_out = static_cast<std::int64_t>(batch.size - batch.machines.size());
    under_way += (handed_out - batch.timed) * cost_of(batch);
  }
  return under_way + tracing_of(Trace::under_way);
}

// What the frames in this state take, by those that are traced.
std::int64_t Schedule::tracing_of(Trace state) const {
  std::int64_t cost = 0;
  for (std::size_t frame = 0; frame < frames_.size(); ++frame) {
    if (frames_[frame].trace == state) {
      cost += share_of(estimated_.tracing, frame, spent_tracing_, estimated_tracing_, traced_);
    }
  }
  return cost;
}

}  // namespace marti::studies::sweep
