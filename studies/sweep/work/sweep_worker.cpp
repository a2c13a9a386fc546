#include "studies/sweep/work/sweep_worker.h"

#include <chrono>
#include <exception>
#include <mutex>
#include <new>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "processors/replay/host_bytes.h"
#include "processors/replay/replay.h"
#include "scenes/open.h"
#include "sim/config_errors.h"
#include "sim/error.h"
#include "sim/shown.h"
#include "studies/host/cpu_time.h"
#include "studies/host/image_file.h"
#include "studies/run/functional_run.h"
#include "studies/run/open_frame.h"
#include "studies/run/scene_hash.h"

namespace marti::studies::sweep {

namespace {

FrameLog trace(const SweepFrame& frame) {
  const keys::FrameConfig& config = frame.config;
  const scenes::Scene scene = run::open_frame(config);
  const std::uint64_t hash = run::scene_hash(scene);
  if (frame.scene_hash && *frame.scene_hash != hash) {
    throw sim::KeyError(
        "scene.source",
        sim::shown(config.scene) + ": the scene has changed since the sweep was begun; begin it again");
  }
  const run::FunctionalRun run = run::run_functional(config, scene);
  return {run.frame.log, frame_row(run, hash)};
}

// A fault of the frame is reported at the place of its key.
FrameLog trace(const SweepSite& site, const SweepFrame& frame) {
  return sim::with_places(frame.settings, site.plan.file, [&] { return trace(frame); });
}

// Tracing uses all of the computer's threads, so what it takes is the time that passes.
void do_trace(SweepSite& site, TaskSource& source, const SweepTask& task) {
  const auto begin = std::chrono::steady_clock::now();
  const SweepFrame& frame = site.plan.frames[task.frame];
  FrameLog log = trace(site, frame);
  const FrameRow row = log.row;
  site.logs.put(task.frame, std::move(log));
  const auto end = std::chrono::steady_clock::now();
  source.traced(task.frame, row, std::chrono::duration_cast<std::chrono::nanoseconds>(end - begin).count());
}

std::string name_of(const SweepMachine& machine) {
  std::string name;
  for (const SettingsPart& part : machine.settings) {
    for (const sim::EffectiveValue& value : *part) {
      if (value.given) {
        name += (name.empty() ? "" : ", ") + value.key + " = " + value.value;
      }
    }
  }
  return name;
}

processors::replay::MachineResult replay(SweepSite& site, const SweepTask& task,
                                         const std::shared_ptr<const processors::program::WorkLog>& log,
                                         const processors::machine::MachineConfig& machine) {
  const std::shared_ptr<const processors::walk::StrippedLog> stripped =
      site.strips.get(task.frame, log, machine, task.sharing, task.ways);
  const std::uint64_t bytes = processors::replay::host_bytes(*log, machine);
  site.memory.require(bytes, "a machine with what it counts takes", "lower machine.nodes");
  const MemoryGate::Pass pass(site.machines, bytes);
  processors::replay::ReplayOptions options;
  options.stripped = stripped.get();
  // Rows count an event for each read, whatever the interconnect is.
  options.keep_read_events = true;
  return processors::replay::replay(*log, machine, options);
}

void do_time(SweepSite& site, TaskSource& source, const SweepTask& task) {
  const std::shared_ptr<const FrameLog> log = site.log_of(task.frame);
  std::optional<std::size_t> timing;  // of `result`
  processors::replay::MachineResult result;
  for (const std::size_t number : task.machines) {
    const SweepMachine& machine = site.plan.machines[number];
    const std::int64_t begin = host::thread_cpu_nanoseconds();
    SweepRow row;
    try {
      row = sim::with_places(all_of(machine.settings), site.plan.file, [&] {
        if (timing != machine.timing) {
          result = replay(site, task, log->log, machine.config);
          timing = machine.timing;
        } else {
          processors::replay::work_out_energy(*log->log, machine.config, result);
        }
        return sweep_row(machine.config, result);
      });
    } catch (const sim::UserError& error) {
      throw sim::UserError(std::string(error.what()) + " (the machine with " + sim::shown(name_of(machine)) +
                           ")");
    } catch (const std::bad_alloc&) {
      throw sim::UserError("the computer ran out of memory (while it timed the machine with " +
                           sim::shown(name_of(machine)) + ")");
    }
    source.timed(number, row, host::thread_cpu_nanoseconds() - begin);
  }
}

void take_tasks(SweepSite& site, TaskSource& source) {
  for (;;) {
    const SweepTask task = source.next();
    switch (task.kind) {
      case SweepTask::Kind::trace:
        do_trace(site, source, task);
        break;
      case SweepTask::Kind::time:
        do_time(site, source, task);
        break;
      case SweepTask::Kind::wait:
        throw sim::InternalError("a worker was told to wait");
      case SweepTask::Kind::end:
        return;
    }
  }
}

}  // namespace

std::shared_ptr<const FrameLog> SweepSite::log_of(std::size_t frame) {
  return logs.take(frame, [&] { return trace(*this, plan.frames[frame]); });
}

void work_together(SweepSite& site, TaskSource& source, unsigned workers) {
  std::mutex mutex;
  std::exception_ptr first;
  {
    std::vector<std::jthread> threads;
    const auto run = [&] {
      try {
        take_tasks(site, source);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (first == nullptr) {
          first = std::current_exception();
        }
        source.stop();
      }
    };
    try {
      for (unsigned worker = 0; worker < workers; ++worker) {
        threads.emplace_back(run);
      }
    } catch (const std::system_error& error) {
      // The system gives no more threads: those that there are do the work.
      if (threads.empty()) {
        throw sim::UserError(std::string("no thread can be started: ") + error.what());
      }
    }
  }
  if (first != nullptr) {
    std::rethrow_exception(first);
  }
}

}  // namespace marti::studies::sweep
