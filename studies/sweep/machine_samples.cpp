#include "studies/sweep/machine_samples.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <tuple>
#include <utility>

#include "processors/replay/replay.h"
#include "processors/walk/stripped_log.h"
#include "sim/error.h"
#include "studies/host/cpu_time.h"
#include "studies/sweep/work/stripped_log_cache.h"

namespace marti::studies {

namespace {

using processors::MachineConfig;
using processors::StrippedLog;

// Machines of a frame that share the pass that strips its log, as studies/sweep/work/schedule.h has them.
struct Batch {
  std::size_t sharing = 0;
  std::vector<std::uint32_t> ways;  // ascending
  [[nodiscard]] bool pays() const {
    return StrippedLogCache::pays(sharing, !ways.empty() && ways.back() != 0);
  }
};

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
      : plan_(plan), machines_(machines), samples_(samples), frame_of_(frame_of), keys_(machines.size()) {
    for (std::size_t i = 0; i < machines_.size(); ++i) {
      const SweepMachine& machine = plan_.machines[machines_[i]];
      keys_[i] = StrippedLog::key_of(machine.config);
      if (!keys_[i].empty()) {
        Batch& batch = batches_[{machine.frame, keys_[i]}];
        ++batch.sharing;
        const std::uint32_t ways = StrippedLog::ways_of(machine.config);
        if (const auto at = std::lower_bound(batch.ways.begin(), batch.ways.end(), ways);
            at == batch.ways.end() || *at != ways) {
          batch.ways.insert(at, ways);
        }
      }
    }
  }

  // Times the machine `machines_[i]`.
  void time(std::size_t i) {
    const SweepMachine& machine = plan_.machines[machines_[i]];
    const FrameEstimate& frame = frame_of_(machine.frame);
    const FrameSample& sample = samples_.samples()[frame.sample];
    const MachineConfig plain = without_energy(machine.config);
    try {
      // What is as long in a small image, such as to build a tree or to fill caches, is not scaled.
      const double large = seconds_of(i, plain, sample.large, frame.scale);
      double a_byte = large / sample.large.bytes;
      if (sample.small.log != nullptr) {
        const double small = seconds_of(i, plain, sample.small, 0.0);
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

  [[nodiscard]] MachinesEstimate estimate() const {
    MachinesEstimate all;
    all.of_frame.resize(plan_.frames.size());
    for (const std::size_t number : machines_) {
      const std::size_t frame = plan_.machines[number].frame;
      if (timed_ != 0) {
        all.of_frame[frame] = fixed_seconds_ / static_cast<double>(timed_) +
                              growing_seconds_ / growing_bytes_ * frame_of_(frame).log_bytes;
      }
      all.timing += all.of_frame[frame];
    }
    for (const auto& [place, batch] : batches_) {
      if (batch.pays() && stripped_bytes_ > 0.0) {
        all.stripping += stripped_seconds_ / stripped_bytes_ * frame_of_(place.first).log_bytes;
      }
    }
    return all;
  }

 private:
  // Processor time of machine `machines_[i]` on the log. Its stripping counts as that of a log so many times
  // as large.
  double seconds_of(std::size_t i, const MachineConfig& plain, const SmallLog& log, double scale) {
    processors::ReplayOptions options;
    const std::shared_ptr<const StrippedLog> stripped = stripped_for(i, plain, log, scale);
    options.stripped = stripped.get();
    options.keep_read_events = true;
    const double begin = thread_cpu_seconds();
    static_cast<void>(processors::replay(*log.log, plain, options));
    return thread_cpu_seconds() - begin;
  }

  // The stripped log that the machine will have, of this log; null: none.
  std::shared_ptr<const StrippedLog> stripped_for(std::size_t i, const MachineConfig& plain,
                                                  const SmallLog& log, double scale) {
    const auto batch = batches_.find({plan_.machines[machines_[i]].frame, keys_[i]});
    if (batch == batches_.end() || !batch->second.pays()) {
      return nullptr;
    }
    const std::vector<std::uint32_t>& ways = batch->second.ways;
    const auto [made, is_new] = stripped_.try_emplace({log.log.get(), keys_[i], ways});
    if (is_new) {
      const double begin = process_cpu_seconds();
      made->second = StrippedLog::make(*log.log, plain, ways);
      stripped_seconds_ += (process_cpu_seconds() - begin) * scale;
      stripped_bytes_ += log.bytes * scale;
    }
    const auto at = std::lower_bound(ways.begin(), ways.end(), StrippedLog::ways_of(plain));
    return made->second[static_cast<std::size_t>(at - ways.begin())];
  }

  const SweepPlan& plan_;
  const std::vector<std::size_t>& machines_;
  const FrameSamples& samples_;
  const std::function<const FrameEstimate&(std::size_t)>& frame_of_;
  std::vector<std::string> keys_;  // StrippedLog::key_of each machine
  std::map<std::pair<std::size_t, std::string>, Batch> batches_;
  std::map<std::tuple<const processors::WorkLog*, std::string, std::vector<std::uint32_t>>,
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

MachinesEstimate estimate_machines(const SweepPlan& plan, const std::vector<std::size_t>& machines,
                                   const FrameSamples& samples,
                                   const std::function<const FrameEstimate&(std::size_t frame)>& frame_of,
                                   const std::function<bool()>& enough) {
  Sampling sampling(plan, machines, samples, frame_of);
  std::vector<std::size_t> order(machines.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    order[i] = i;
  }
  std::mt19937_64 chance(1);
  std::shuffle(order.begin(), order.end(), chance);
  for (std::size_t i = 0; i < order.size() && (i == 0 || !enough()); ++i) {
    sampling.time(order[i]);
  }
  return sampling.estimate();
}

}  // namespace marti::studies
