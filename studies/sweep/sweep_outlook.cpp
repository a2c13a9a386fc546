#include "studies/sweep/sweep_outlook.h"

#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "processors/replay/host_bytes.h"
#include "processors/replay/replay.h"
#include "processors/walk/stripped_log.h"
#include "studies/run/functional_run.h"
#include "studies/sweep/work/stripped_log_cache.h"

namespace marti::studies {

namespace {

constexpr std::uint32_t sample_side = 64;
constexpr std::size_t most_samples = 3;

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

using Machines = std::vector<const processors::MachineConfig*>;

// Whether the sweep will strip the log for this machine, one of those of a frame.
bool shares_stripped(const processors::MachineConfig& machine, const Machines& machines) {
  const std::string key = processors::StrippedLog::key_of(machine);
  std::size_t sharing = 0;
  bool lru = false;
  for (const processors::MachineConfig* other : machines) {
    if (processors::StrippedLog::key_of(*other) == key) {
      ++sharing;
      lru = lru || processors::StrippedLog::ways_of(*other) != 0;
    }
  }
  return !key.empty() && StrippedLogCache::pays(sharing, lru);
}

// Estimates for one frame and one of its machines, scaled up from a small image.
struct Sample {
  double trace_seconds = 0.0;
  double machine_seconds = 0.0;
  double log_bytes = 0.0;
};

Sample take_sample(const SweepFrame& frame, const processors::MachineConfig* machine, bool strips) {
  FrameConfig config = frame.config;
  const std::uint32_t longer = std::max(config.render.width, config.render.height);
  const double pixels = static_cast<double>(config.render.width) * config.render.height;
  if (longer > sample_side) {
    config.render.width = std::max(1U, config.render.width * sample_side / longer);
    config.render.height = std::max(1U, config.render.height * sample_side / longer);
  }
  config.render.voxel_cut = 0.0;  // a coarse image would cut more than the frame
  const double scale = pixels / (static_cast<double>(config.render.width) * config.render.height);
  const auto begin = std::chrono::steady_clock::now();
  const FunctionalRun run = run_functional(config);
  Sample sample;
  sample.trace_seconds = seconds_since(begin) * scale;
  sample.log_bytes = static_cast<double>(run.totals.bytes) * scale;
  if (machine != nullptr) {
    // A machine whose energy does not fit is refused when it is timed, with the line of its key.
    processors::MachineConfig plain = *machine;
    plain.energy = {};
    const auto stripped = strips ? processors::StrippedLog::make(*run.frame.log, plain) : nullptr;
    processors::ReplayOptions options;
    options.stripped = stripped.get();
    const auto timing = std::chrono::steady_clock::now();
    (void)processors::replay(*run.frame.log, plain, options);
    sample.machine_seconds = seconds_since(timing) * scale;
  }
  return sample;
}

}  // namespace

SweepOutlook outlook_of(const SweepPlan& plan, const std::vector<bool>& machines_done,
                        const std::vector<bool>& frames_done, unsigned threads) {
  SweepOutlook outlook;
  outlook.machines_done =
      static_cast<std::size_t>(std::count(machines_done.begin(), machines_done.end(), true));
  std::vector<Machines> left(plan.frames.size());
  std::vector<std::uint64_t> bytes;
  for (std::size_t i = 0; i < plan.machines.size(); ++i) {
    const SweepMachine& machine = plan.machines[i];
    if (machines_done[i]) {
      continue;
    }
    bytes.push_back(processors::host_bytes(machine.config));
    left[machine.frame].push_back(&machine.config);
  }
  std::vector<std::size_t> to_trace;
  for (std::size_t frame = 0; frame < plan.frames.size(); ++frame) {
    if (!left[frame].empty() || !frames_done[frame]) {
      to_trace.push_back(frame);
    } else {
      ++outlook.frames_done;
    }
  }
  if (to_trace.empty()) {
    return outlook;
  }
  const std::size_t samples = std::min(most_samples, to_trace.size());
  Sample sum;
  double most_bytes = 0.0;
  for (std::size_t i = 0; i < samples; ++i) {
    const Machines& machines = left[to_trace[i]];
    const processors::MachineConfig* middle = machines.empty() ? nullptr : machines[machines.size() / 2];
    const Sample sample = take_sample(plan.frames[to_trace[i]], middle,
                                      middle != nullptr && shares_stripped(*middle, machines));
    sum.trace_seconds += sample.trace_seconds;
    sum.machine_seconds += sample.machine_seconds;
    most_bytes = std::max(most_bytes, sample.log_bytes);
  }
  const auto mean = [samples](double value) { return value / static_cast<double>(samples); };
  const std::size_t at_once =
      std::min<std::size_t>(std::max(1U, threads), std::max<std::size_t>(1, bytes.size()));
  outlook.seconds =
      mean(sum.trace_seconds) * static_cast<double>(to_trace.size()) +
      mean(sum.machine_seconds) * static_cast<double>(bytes.size()) / static_cast<double>(at_once);
  outlook.log_bytes = static_cast<std::uint64_t>(most_bytes);
  const auto largest = bytes.begin() + static_cast<std::ptrdiff_t>(std::min(at_once, bytes.size()));
  std::partial_sort(bytes.begin(), largest, bytes.end(), std::greater<>());
  std::uint64_t together = 0;
  for (auto it = bytes.begin(); it != largest; ++it) {
    together += *it;
  }
  outlook.machine_bytes = together;
  return outlook;
}

}  // namespace marti::studies
