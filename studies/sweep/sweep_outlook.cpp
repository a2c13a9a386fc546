#include "studies/sweep/sweep_outlook.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <functional>

#include "processors/replay/host_bytes.h"
#include "studies/sweep/frame_samples.h"
#include "studies/sweep/machine_samples.h"

namespace marti::studies::sweep {

namespace {

using Clock = std::chrono::steady_clock;

// Until when samples are begun.
constexpr std::chrono::milliseconds for_frames(700);
constexpr std::chrono::milliseconds for_machines(600);

// A short sweep is not held up by its estimate.
constexpr std::size_t fewest_frames = 3;
constexpr std::size_t fewest_machines = 16;
constexpr std::chrono::milliseconds for_fewest(100);

// Says when there are enough samples: after `most`, or after `fewest` samples that took for_fewest.
std::function<bool()> enough_after(Clock::duration most, std::size_t fewest) {
  return [begin = Clock::now(), most, fewest, taken = std::size_t{0}]() mutable {
    const Clock::duration passed = Clock::now() - begin;
    return passed >= most || (++taken >= fewest && passed >= for_fewest);
  };
}

// std::nullopt when no estimate is worth the time that it would take.
std::optional<double> seconds_of(const SweepPlan& plan, const std::vector<std::size_t>& frames,
                                 const std::vector<std::size_t>& machines, std::size_t at_once,
                                 SweepOutlook& outlook) {
  const FrameSamples samples(plan, frames, enough_after(for_frames, fewest_frames));
  if (samples.too_large()) {
    return std::nullopt;
  }
  const std::vector<FrameEstimate> estimates = samples.estimates();
  std::vector<const FrameEstimate*> of_frame(plan.frames.size());
  outlook.costs.tracing.resize(plan.frames.size());
  double preparing = 0.0;
  double tracing = 0.0;
  double most_bytes = 0.0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    of_frame[frames[i]] = &estimates[i];
    preparing += estimates[i].prepare_seconds;
    tracing += estimates[i].trace_seconds;
    outlook.costs.tracing[frames[i]] = estimates[i].prepare_seconds + estimates[i].trace_seconds;
    most_bytes = std::max(most_bytes, estimates[i].log_bytes);
  }
  outlook.log_bytes = static_cast<std::uint64_t>(most_bytes);
  MachinesEstimate timing;
  if (!machines.empty()) {
    const std::optional<MachinesEstimate> found = estimate_machines(
        plan, machines, samples, [&](std::size_t frame) -> const FrameEstimate& { return *of_frame[frame]; },
        enough_after(for_machines, fewest_machines));
    if (!found) {
      return std::nullopt;
    }
    timing = *found;
  }
  outlook.costs.timing = timing.of_frame;
  outlook.costs.timing.resize(plan.frames.size());
  const auto cores = static_cast<double>(tbb::this_task_arena::max_concurrency());
  const double threads = std::min(static_cast<double>(at_once), cores);
  // One frame is prepared before anything else can be done; several are prepared while machines are timed.
  return preparing / (frames.size() == 1 ? 1.0 : threads) + (tracing + timing.stripping) / cores +
         timing.timing / threads;
}

}  // namespace

SweepOutlook outlook_of(const SweepPlan& plan, const std::vector<bool>& machines_done,
                        const std::vector<bool>& frames_done, unsigned threads) {
  SweepOutlook outlook;
  outlook.machines_done = static_cast<std::size_t>(std::ranges::count(machines_done, true));
  std::vector<std::size_t> left;
  std::vector<bool> needed(plan.frames.size());
  std::vector<std::uint64_t> bytes;
  for (std::size_t i = 0; i < plan.machines.size(); ++i) {
    const SweepMachine& machine = plan.machines[i];
    if (machines_done[i]) {
      continue;
    }
    bytes.push_back(processors::replay::host_bytes(machine.config));
    left.push_back(i);
    needed[machine.frame] = true;
  }
  std::vector<std::size_t> to_trace;
  for (std::size_t frame = 0; frame < plan.frames.size(); ++frame) {
    if (needed[frame] || !frames_done[frame]) {
      to_trace.push_back(frame);
    } else {
      ++outlook.frames_done;
    }
  }
  if (to_trace.empty()) {
    return outlook;
  }
  const std::size_t at_once =
      std::min<std::size_t>(std::max(1U, threads), std::max<std::size_t>(1, bytes.size()));
  outlook.seconds = seconds_of(plan, to_trace, left, at_once, outlook);
  outlook.not_estimated = !outlook.seconds;
  const auto largest = bytes.begin() + static_cast<std::ptrdiff_t>(std::min(at_once, bytes.size()));
  std::partial_sort(bytes.begin(), largest, bytes.end(), std::greater<>());
  std::uint64_t together = 0;
  for (auto it = bytes.begin(); it != largest; ++it) {
    together += *it;
  }
  outlook.machine_bytes = together;
  return outlook;
}

}  // namespace marti::studies::sweep
