#include "studies/sweep/work/timing_loop.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <new>
#include <optional>
#include <span>
#include <string>

#include "processors/replay/host_bytes.h"
#include "processors/replay/replay.h"
#include "processors/walk/stripped_log.h"
#include "sim/config_errors.h"
#include "sim/cpu_time.h"
#include "sim/error.h"
#include "sim/shown.h"
#include "studies/sweep/work/batches.h"
#include "studies/sweep/work/memory_gate.h"

namespace marti::studies::sweep {

namespace {

using processors::walk::StrippedLog;

// Batches that are prepared or timed at a time.
constexpr std::size_t batches_at_once = 2;

// A batch that is ready to be timed.
struct ReadyBatch {
  const MachineBatch* batch = nullptr;
  std::shared_ptr<const FrameLog> frame;
  std::vector<std::shared_ptr<const StrippedLog>> stripped;  // for each of MachineBatch::ways, or none at all
};

class Loop {
 public:
  Loop(const SweepPlan& plan, const WorkDone& done, const sim::MemoryBudget& memory, SweepResults& results)
      : plan_(plan),
        memory_(memory),
        results_(results),
        machines_(memory.limit() - memory.limit() / 2 - memory.limit() / 4),
        batches_(batches_left(plan, done)) {}

  void run() {
    while (next_ < batches_.size()) {
      tbb::parallel_pipeline(
          batches_at_once,
          tbb::make_filter<void, ReadyBatch>(tbb::filter_mode::serial_in_order,
                                             [this](tbb::flow_control& control) {
                                               if (next_ == batches_.size() || !may_begin(batches_[next_])) {
                                                 control.stop();
                                                 return ReadyBatch();
                                               }
                                               return prepared(batches_[next_++]);
                                             }) &
              tbb::make_filter<ReadyBatch, void>(tbb::filter_mode::parallel,
                                                 [this](const ReadyBatch& ready) { time(ready); }));
      if (next_ < batches_.size()) {
        frame_.reset();  // there was no room for two logs
      }
    }
  }

  [[nodiscard]] TracedFrame last() const { return {number_, frame_}; }

 private:
  // In the order of the frames. A frame without machines whose row is not there has a batch of none.
  static std::vector<MachineBatch> batches_left(const SweepPlan& plan, const WorkDone& done) {
    std::vector<std::size_t> left;
    std::vector<bool> has_machines(plan.frames.size());
    for (std::size_t machine = 0; machine < plan.machines.size(); ++machine) {
      if (!done.machines[machine]) {
        left.push_back(machine);
        has_machines[plan.machines[machine].frame] = true;
      }
    }
    std::vector<MachineBatch> batches = batches_of(plan, left);
    for (std::size_t frame = 0; frame < plan.frames.size(); ++frame) {
      if (!has_machines[frame] && !done.frames[frame]) {
        batches.push_back({frame, {}, {}, {}});
      }
    }
    std::ranges::stable_sort(batches, {}, &MachineBatch::frame);
    return batches;
  }

  // Whether there is room for the log of the batch's frame beside the one before, judged by its rays.
  [[nodiscard]] bool may_begin(const MachineBatch& batch) const {
    if (frame_ == nullptr || batch.frame == number_) {
      return true;
    }
    const auto bytes = static_cast<double>(memory_of(*frame_->log));
    const double next = bytes * plan_.frames[batch.frame].rays() / plan_.frames[number_].rays();
    return bytes + next <= static_cast<double>(memory_.limit()) / 2.0;
  }

  // What waits in here must not be given the machines of the batch before to time: it would not go on for
  // long.
  ReadyBatch prepared(const MachineBatch& batch) {
    return tbb::this_task_arena::isolate([&] {
      if (frame_ == nullptr || batch.frame != number_) {
        frame_.reset();
        number_ = batch.frame;
        const auto begin = std::chrono::steady_clock::now();
        frame_ = std::make_shared<const FrameLog>(trace_frame(plan_, batch.frame));
        const std::chrono::nanoseconds taken = std::chrono::steady_clock::now() - begin;
        results_.traced(batch.frame, frame_->row, taken.count());
      }
      return ReadyBatch{&batch, frame_, stripped_for(batch, *frame_->log)};
    });
  }

  [[nodiscard]] std::vector<std::shared_ptr<const StrippedLog>> stripped_for(
      const MachineBatch& batch, const processors::program::WorkLog& log) const {
    if (!pays_to_strip(batch)) {
      return {};
    }
    const processors::machine::MachineConfig& machine = plan_.machines[batch.machines.front()].config;
    std::uint64_t left = memory_.limit() / 4 / batches_at_once;
    std::vector<std::shared_ptr<const StrippedLog>> logs = StrippedLog::make(log, machine, batch.ways, left);
    if (batch.ways.size() > 1 &&
        std::ranges::all_of(logs, [](const auto& each) { return each == nullptr; })) {
      // They do not fit together. Those for many ways take the least memory; after one that does not fit,
      // none does.
      for (std::size_t i = batch.ways.size(); i-- > 0;) {
        logs[i] = StrippedLog::make(log, machine, std::span(batch.ways).subspan(i, 1), left).front();
        if (logs[i] == nullptr) {
          break;
        }
        left -= std::min(left, logs[i]->bytes_of_words());
      }
    }
    return logs;
  }

  void time(const ReadyBatch& ready) {
    const std::vector<std::size_t>& machines = ready.batch->machines;
    std::vector<std::span<const std::size_t>> groups;  // of one timing each
    for (auto begin = machines.begin(); begin != machines.end();) {
      const std::size_t timing = plan_.machines[*begin].timing;
      const auto end = std::find_if(
          begin, machines.end(), [&](std::size_t other) { return plan_.machines[other].timing != timing; });
      groups.emplace_back(begin, end);
      begin = end;
    }
    // One thread ends its batch before it helps with the next one, so that the next may begin.
    tbb::this_task_arena::isolate([&] {
      tbb::parallel_for(
          std::size_t{0}, groups.size(), [&](std::size_t i) { time(ready, groups[i]); },
          tbb::simple_partitioner());
    });
  }

  void time(const ReadyBatch& ready, std::span<const std::size_t> group) {
    std::optional<processors::replay::MachineResult> result;
    for (const std::size_t number : group) {
      const SweepMachine& machine = plan_.machines[number];
      const std::int64_t begin = sim::thread_cpu_nanoseconds();
      SweepRow row;
      std::optional<run::IntervalFigures> intervals;
      try {
        row = sim::with_places(all_of(machine.settings), plan_.file, [&] {
          if (result) {
            processors::replay::work_out_energy(*ready.frame->log, machine.config, *result);
          } else {
            if (machine.interval > 0) {
              intervals.emplace(machine.config, machine.interval);
            }
            result = replay(ready, machine.config, plan_.frames[machine.frame].config.meter,
                            intervals ? &*intervals : nullptr);
          }
          SweepRow timed = sweep_row(machine.config, *result);
          if (intervals) {
            timed.intervals = intervals->rows(timed.counters);
          }
          return timed;
        });
      } catch (const sim::UserError& error) {
        throw sim::UserError(error.what() + asked_by(plan_, number), error);
      } catch (const std::bad_alloc&) {
        throw sim::UserError("the computer ran out of memory while it timed a machine" +
                             asked_by(plan_, number));
      }
      results_.timed(number, row, sim::thread_cpu_nanoseconds() - begin);
    }
  }

  processors::replay::MachineResult replay(const ReadyBatch& ready,
                                           const processors::machine::MachineConfig& machine,
                                           sim::WorkMeter* meter, run::IntervalFigures* intervals) {
    const processors::program::WorkLog& log = *ready.frame->log;
    processors::replay::ReplayOptions options;
    options.meter = meter;
    options.observer = intervals;
    options.intervals = intervals == nullptr ? nullptr : &intervals->asked();
    if (!ready.stripped.empty()) {
      const auto ways = std::ranges::find(ready.batch->ways, StrippedLog::ways_of(machine));
      options.stripped = ready.stripped[static_cast<std::size_t>(ways - ready.batch->ways.begin())].get();
    }
    // Rows count an event for each read, whatever the interconnect is.
    options.keep_read_events = true;
    const std::uint64_t bytes = processors::replay::host_bytes(log, machine);
    memory_.require(bytes, "a machine with what it counts takes", "lower machine.nodes");
    const MemoryGate::Pass pass(machines_, bytes);
    // What holds the pass must not wait for another one.
    return tbb::this_task_arena::isolate([&] { return processors::replay::replay(log, machine, options); });
  }

  const SweepPlan& plan_;
  sim::MemoryBudget memory_;
  SweepResults& results_;
  MemoryGate machines_;
  std::vector<MachineBatch> batches_;
  // These are used by one thread at a time: the one that prepares.
  std::size_t next_ = 0;
  std::shared_ptr<const FrameLog> frame_;
  std::size_t number_ = 0;  // of frame_
};

}  // namespace

TracedFrame time_machines(const SweepPlan& plan, const WorkDone& done, const sim::MemoryBudget& memory,
                          unsigned threads, SweepResults& results) {
  Loop loop(plan, done, memory, results);
  const auto cores = static_cast<unsigned>(tbb::this_task_arena::max_concurrency());
  tbb::task_arena(static_cast<int>(std::min(threads, cores))).execute([&] { loop.run(); });
  return loop.last();
}

}  // namespace marti::studies::sweep
