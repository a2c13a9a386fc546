#include "studies/sweep/machine_samples.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "processors/replay/host_bytes.h"
#include "processors/replay/replay.h"
#include "processors/walk/stripped_log.h"
#include "sim/error.h"
#include "studies/host/cpu_time.h"
#include "studies/sweep/work/batches.h"
#include "studies/sweep/work/stripped_log_cache.h"

namespace marti::studies::sweep {

namespace {

using processors::machine::MachineConfig;
using processors::walk::StrippedLog;

// A machine whose energy does not fit is refused when it is timed, with the line of its key.
MachineConfig without_energy(const MachineConfig& machine) {
  MachineConfig plain = machine;
  plain.energy = {};
  return plain;
}

class Sampling {
 public:
  Sampling(const SweepPlan& plan, const std::vector<std::size_t>& machines, const FrameSamples& samples,
           const std::function<const FrameEstimate&(std::size_t)>& frame_of)
      : plan_(plan),
        machines_(machines),
        samples_(samples),
        frame_of_(frame_of),
        batches_(batches_of(plan, machines)),
        batch_of_(plan.machines.size()) {
    for (std::size_t batch = 0; batch < batches_.size(); ++batch) {
      for (const std::size_t machine : batches_[batch].machines) {
        batch_of_[machine] = batch;
      }
    }
  }

  void time(std::size_t number) {
    const SweepMachine& machine = plan_.machines[number];
    const FrameEstimate& frame = frame_of_(machine.frame);
    const FrameSample& sample = samples_.samples()[frame.sample];
    const MachineConfig plain = without_energy(machine.config);
    try {
      // What is as long in a small image, such as to build a tree or to fill caches, is not scaled.
      const double large = seconds_of(number, plain, sample.large, frame.scale);
      double a_byte = large / sample.large.bytes;
      if (sample.small.log != nullptr) {
        const double small = seconds_of(number, plain, sample.small, 0.0);
        a_byte = std::clamp((large - small) / (sample.large.bytes - sample.small.bytes), 0.0, a_byte);
      }
      ++timed_;
      fixed_seconds_ += large - a_byte * sample.large.bytes;
      growing_seconds_ += a_byte * frame.log_bytes;
      growing_bytes_ += frame.log_bytes;
    } catch (const sim::UserError&) {
      // It is refused when it is timed.
    }
  }

  [[nodiscard]] std::optional<MachinesEstimate> estimate() const {
    if (timed_ == 0) {
      return std::nullopt;
    }
    MachinesEstimate all;
    all.of_frame.resize(plan_.frames.size());
    std::set<std::size_t> replayed;
    for (const std::size_t number : machines_) {
      const std::size_t frame = plan_.machines[number].frame;
      all.of_frame[frame] = fixed_seconds_ / static_cast<double>(timed_) +
                            growing_seconds_ / growing_bytes_ * frame_of_(frame).log_bytes;
      if (replayed.insert(plan_.machines[number].timing).second) {
        all.timing += all.of_frame[frame];
      }
    }
    for (const MachineBatch& batch : batches_) {
      if (pays(batch) && stripped_bytes_ > 0.0) {
        all.stripping += stripped_seconds_ / stripped_bytes_ * frame_of_(batch.frame).log_bytes;
      }
    }
    return all;
  }

 private:
  // Whether the sweep strips the log of these machines.
  static bool pays(const MachineBatch& batch) {
    return !batch.key.empty() && StrippedLogCache::pays(batch.machines.size(), batch.ways.back() != 0);
  }

  // Processor time of a machine on the log. Its stripping counts as that of a log so many times as large.
  double seconds_of(std::size_t number, const MachineConfig& plain, const SmallLog& log, double scale) {
    processors::replay::ReplayOptions options;
    const std::shared_ptr<const StrippedLog> stripped = stripped_for(number, plain, log, scale);
    options.stripped = stripped.get();
    options.keep_read_events = true;
    const double begin = host::thread_cpu_seconds();
    static_cast<void>(processors::replay::replay(*log.log, plain, options));
    return host::thread_cpu_seconds() - begin;
  }

  // The stripped log that the machine will have, of this log; null: none.
  std::shared_ptr<const StrippedLog> stripped_for(std::size_t number, const MachineConfig& plain,
                                                  const SmallLog& log, double scale) {
    const MachineBatch& batch = batches_[batch_of_[number]];
    if (!pays(batch)) {
      return nullptr;
    }
    const std::vector<std::uint32_t>& ways = batch.ways;
    const auto [made, is_new] = stripped_.try_emplace({log.log.get(), batch.key, ways});
    if (is_new) {
      const double begin = host::process_cpu_seconds();
      made->second = StrippedLog::make(*log.log, plain, ways);
      stripped_seconds_ += (host::process_cpu_seconds() - begin) * scale;
      stripped_bytes_ += log.bytes * scale;
    }
    const auto at = std::ranges::lower_bound(ways, StrippedLog::ways_of(plain));
    return made->second[static_cast<std::size_t>(at - ways.begin())];
  }

  const SweepPlan& plan_;
  const std::vector<std::size_t>& machines_;
  const FrameSamples& samples_;
  const std::function<const FrameEstimate&(std::size_t)>& frame_of_;
  std::vector<MachineBatch> batches_;
  std::vector<std::size_t> batch_of_;  // of each machine of the plan
  std::map<std::tuple<const processors::program::WorkLog*, std::string, std::vector<std::uint32_t>>,
           std::vector<std::shared_ptr<const StrippedLog>>>
      stripped_;
  // Of the machines that were timed: what does not grow with the image, and what does, at their frames' own
  // size.
  std::size_t timed_ = 0;
  double fixed_seconds_ = 0.0;
  double growing_seconds_ = 0.0;
  double growing_bytes_ = 0.0;
  // Of the logs that were stripped: processor time and bytes, at their frames' own size.
  double stripped_seconds_ = 0.0;
  double stripped_bytes_ = 0.0;
};

}  // namespace

std::optional<MachinesEstimate> estimate_machines(
    const SweepPlan& plan, const std::vector<std::size_t>& machines, const FrameSamples& samples,
    const std::function<const FrameEstimate&(std::size_t frame)>& frame_of,
    const std::function<bool()>& enough) {
  Sampling sampling(plan, machines, samples, frame_of);
  std::vector<std::size_t> order;
  std::ranges::copy_if(machines, std::back_inserter(order), [&](std::size_t number) {
    return processors::replay::host_bytes(plan.machines[number].config) <= most_sample_bytes;
  });
  std::mt19937_64 chance(1);
  std::ranges::shuffle(order, chance);
  for (std::size_t i = 0; i < order.size() && (i == 0 || !enough()); ++i) {
    sampling.time(order[i]);
  }
  return sampling.estimate();
}

}  // namespace marti::studies::sweep
