// What of a plan cannot be run, found by trying.
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "processors/replay/host_bytes.h"
#include "processors/replay/replay.h"
#include "sim/config_errors.h"
#include "sim/error.h"
#include "studies/run/open_frame.h"
#include "studies/run/prepared_frame.h"
#include "studies/sweep/plan/sweep_keys.h"
#include "studies/sweep/plan/sweep_points.h"
#include "studies/sweep/store/store_parts.h"
#include "studies/sweep/sweep.h"
#include "studies/sweep/work/frame_log.h"

namespace marti::studies::sweep {

namespace {

using Log = std::shared_ptr<const processors::program::WorkLog>;

constexpr double side_of_trial = 8;  // of its image, in pixels
constexpr std::uint32_t most_trial_samples = 4;

// Calls `work`; the UserError that it throws, or none.
template <class Work>
std::exception_ptr fault_of(const Work& work) {
  try {
    work();
  } catch (const sim::UserError&) {
    return std::current_exception();
  }
  return nullptr;
}

// A fault with the place of its key in the settings of the machine.
std::string reason_of(const SweepPlan& plan, std::size_t machine, const std::exception_ptr& fault) {
  try {
    sim::with_places(settings_of(plan, machine), plan.file, [&] { std::rethrow_exception(fault); });
  } catch (const sim::UserError& error) {
    return error.what();
  }
  return {};
}

Log small_log(const keys::FrameConfig& frame, bool meets) {
  keys::FrameConfig small = frame;
  small.render = keys::made_small(frame.render, side_of_trial);
  small.render.samples = std::min(small.render.samples, most_trial_samples);
  small.render.meets = meets;
  small.render.hits = false;
  small.exact_too = false;
  small.expected = nullptr;
  sim::WorkMeter meter(frame.meter);
  small.meter = &meter;
  const scenes::Scene scene = run::open_frame(small);
  return run::PreparedFrame(small, scene).trace().log;
}

class Trial {
 public:
  explicit Trial(SweepPlan& plan) : plan_(plan), reasons_(plan.machines.size()) {}

  // Tries these machines, which are of one frame.
  void run(const std::vector<std::size_t>& machines) {
    keys::FrameConfig& frame = plan_.frames[plan_.machines[machines.front()].frame].config;
    if (frame.log != nullptr || frame.render.integrator == processors::program::Integrator::rays) {
      return;
    }
    Log log;
    std::exception_ptr fault = fault_of([&] { log = small_log(frame, frame.render.meets); });
    if (fault != nullptr && frame.render.meets) {
      // What machines whose lanes help each other need of the frame may be what it cannot have.
      if (fault_of([&] { log = small_log(frame, false); }) == nullptr) {
        frame.render.meets = false;
        for (const std::size_t machine : machines) {
          if (plan_.machines[machine].config.rt.share != processors::machine::RtShare::none) {
            reasons_[machine] = reason_of(plan_, machine, fault);
          }
        }
        fault = nullptr;
      }
    }
    std::uint64_t largest = 1;
    for (const std::size_t machine : machines) {
      if (fault != nullptr) {
        reasons_[machine] = reason_of(plan_, machine, fault);
      } else {
        largest = std::max(largest, processors::replay::host_bytes(*log, plan_.machines[machine].config));
      }
    }
    const std::uint64_t fit = frame.memory.limit() / largest;
    if (fault != nullptr || fit == 0) {  // run_sweep() refuses machines that do not fit
      return;
    }
    const auto cores = static_cast<std::uint64_t>(tbb::this_task_arena::max_concurrency());
    tbb::task_arena(static_cast<int>(std::min(fit, cores))).execute([&] {
      tbb::parallel_for(std::size_t{0}, machines.size(), [&](std::size_t i) {
        if (reasons_[machines[i]].empty()) {
          try_machine(machines[i], *log, frame.meter);
        }
      });
    });
  }

  // Leaves out what was refused, and machines and frames that no point is left for.
  void end() && {
    std::erase_if(plan_.points, [&](const SweepPoint& point) {
      const bool of_base = reasons_[point.machine].empty();
      const std::string& reason = reasons_[of_base ? point.base : point.machine];
      if (!reason.empty()) {
        plan_.skipped.push_back({point_text(sweep_schema(), plan_.axes, point.values),
                                 reason + (of_base ? " (its base)" : ""), point.values});
      }
      return !reason.empty();
    });
    if (plan_.compare && !reasons_[*plan_.compare].empty()) {
      throw sim::UserError(reasons_[*plan_.compare] + " (the machine of [sweep.compare])");
    }
    if (plan_.points.empty()) {
      throw sim::UserError("no point of the sweep can be run; the first: " + plan_.skipped.front().reason);
    }
    drop_unused();
  }

 private:
  void try_machine(std::size_t number, const processors::program::WorkLog& log, sim::WorkMeter* meter) {
    const processors::machine::MachineConfig& machine = plan_.machines[number].config;
    processors::replay::ReplayOptions options;
    options.meter = meter;
    const std::exception_ptr fault =
        fault_of([&] { static_cast<void>(processors::replay::replay(log, machine, options)); });
    if (fault != nullptr) {
      reasons_[number] = reason_of(plan_, number, fault);
    }
  }

  void drop_unused() {
    std::vector<std::size_t> machines(plan_.machines.size(), unused);
    const auto use = [&](std::size_t machine) { machines[machine] = 0; };
    for (const SweepPoint& point : plan_.points) {
      use(point.machine);
      use(point.base);
    }
    if (plan_.compare) {
      use(*plan_.compare);
    }
    std::vector<std::size_t> frames(plan_.frames.size(), unused);
    for (std::size_t machine = 0; machine < machines.size(); ++machine) {
      if (machines[machine] != unused) {
        frames[plan_.machines[machine].frame] = 0;
      }
    }
    keep_used(plan_.machines, machines);
    keep_used(plan_.frames, frames);
    for (SweepMachine& machine : plan_.machines) {
      machine.frame = frames[machine.frame];
    }
    for (SweepPoint& point : plan_.points) {
      point.machine = machines[point.machine];
      point.base = machines[point.base];
    }
    if (plan_.compare) {
      plan_.compare = machines[*plan_.compare];
    }
  }

  // Leaves the others out of the list, and gives each that is used its new number.
  template <class Item>
  static void keep_used(std::vector<Item>& items, std::vector<std::size_t>& numbers) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < items.size(); ++i) {
      if (numbers[i] != unused) {
        numbers[i] = kept;
        if (kept != i) {
          items[kept] = std::move(items[i]);
        }
        ++kept;
      }
    }
    items.erase(items.begin() + static_cast<std::ptrdiff_t>(kept), items.end());
  }

  static constexpr std::size_t unused = ~std::size_t{0};

  SweepPlan& plan_;
  std::vector<std::string> reasons_;  // why each machine is left out; empty: it is not
};

}  // namespace

void leave_out_unfit(SweepPlan& plan, const std::filesystem::path& directory) {
  if (!plan.leaves_out) {
    return;
  }
  const DoneKeys done = done_in(directory);
  std::vector<std::vector<std::size_t>> of_frame(plan.frames.size());
  for (std::size_t machine = 0; machine < plan.machines.size(); ++machine) {
    if (!done.machines.contains(plan.machines[machine].key)) {
      of_frame[plan.machines[machine].frame].push_back(machine);
    }
  }
  Trial trial(plan);
  for (const std::vector<std::size_t>& machines : of_frame) {
    if (!machines.empty()) {
      trial.run(machines);
    }
  }
  std::move(trial).end();
}

}  // namespace marti::studies::sweep
