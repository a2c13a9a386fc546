#include "studies/sweep/sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <numeric>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "processors/replay/host_bytes.h"
#include "sim/error.h"
#include "sim/files.h"
#include "sim/input_files.h"
#include "sim/mapped.h"
#include "studies/host/signals_held.h"
#include "studies/show/output.h"
#include "studies/sweep/advise.h"
#include "studies/sweep/store/points_table.h"
#include "studies/sweep/store/store_parts.h"
#include "studies/sweep/store/sweep_store.h"
#include "studies/sweep/work/timing_loop.h"
#include "studies/tables/csv.h"
#include "studies/tables/result_directory.h"
#include "studies/tables/sqlite_connection.h"
#include "studies/tables/text_units.h"

namespace marti::studies::sweep {

namespace {

std::uint64_t bytes_of(const SweepPlan& plan, const SweepMachine& machine) {
  const auto& image = plan.frames[machine.frame].config.render;
  return processors::replay::host_bytes(machine.config, image.width, image.height);
}

void refuse_large_machines(const SweepPlan& plan, const sim::MemoryBudget& memory) {
  for (const SweepMachine& machine : plan.machines) {
    memory.require(bytes_of(plan, machine),
                   "a machine of " + std::to_string(machine.config.all_nodes()) + " nodes takes",
                   "lower machine.nodes or cache.size");
  }
}

unsigned threads_of(const SweepOptions& options) {
  return options.threads != 0 ? options.threads : threads_beside();
}

// Which frames must be traced: those that machines are still to be timed on, and those without a row.
std::vector<bool> frames_needed(const SweepPlan& plan, const WorkDone& done) {
  std::vector<bool> needed = done.frames;
  needed.flip();
  for (std::size_t machine = 0; machine < plan.machines.size(); ++machine) {
    if (!done.machines[machine]) {
      needed[plan.machines[machine].frame] = true;
    }
  }
  return needed;
}

SweepOutlook outlook_of(const SweepPlan& plan, const WorkDone& done, unsigned threads) {
  std::vector<std::uint64_t> bytes;
  for (std::size_t machine = 0; machine < plan.machines.size(); ++machine) {
    if (!done.machines[machine]) {
      bytes.push_back(bytes_of(plan, plan.machines[machine]));
    }
  }
  const auto largest =
      bytes.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(threads, bytes.size()));
  std::partial_sort(bytes.begin(), largest, bytes.end(), std::greater<>());
  return {static_cast<std::size_t>(std::ranges::count(done.machines, true)),
          static_cast<std::size_t>(std::ranges::count(frames_needed(plan, done), false)),
          std::reduce(bytes.begin(), largest, std::uint64_t{0})};
}

// Removes a store that this process has made if it holds no result, with what SQLite keeps beside it: also on
// a full disk, where the store cannot be ended, or could not even be begun and is null.
void remove_if_empty(SweepStore* store, const std::filesystem::path& file) {
  const auto any = [](const std::vector<bool>& done) { return std::ranges::find(done, true) != done.end(); };
  try {
    if (store != nullptr && (any(store->done()) || any(store->frames_done()))) {
      return;
    }
  } catch (const sim::UserError&) {
    return;  // it may hold some
  }
  try {
    if (store != nullptr) {
      store->close();
    }
  } catch (const sim::UserError&) {
    // What could not be written is of no use to anybody.
  }
  for (const char* const suffix : {"", "-wal", "-shm", "-journal"}) {
    std::error_code ignored;
    std::filesystem::remove(file.string() + suffix, ignored);
  }
}

// Times what the store in `report.store` lacks of the plan; `lock` is the store's, and ends if a signal
// comes. `held` keeps signals waiting since the lock was taken. Takes `parts` into the store first, and says
// what `say` makes of what is left then.
void complete(const SweepPlan& plan, const SweepOptions& options, const sim::MemoryBudget& limit,
              std::optional<StoreLock>& lock, std::optional<host::SignalsHeld>& held,
              const std::vector<std::filesystem::path>& parts,
              const std::function<void(const SweepOutlook&)>& say, SweepReport& report) {
  const bool is_new = !is_begun(report.store);
  const auto unlock = [&lock](int /*signal*/) { lock.reset(); };
  std::optional<SweepStore> store;
  WorkDone done;
  // SQLite has files beside a store that is open, which only the last words below close.
  if (!held) {
    held.emplace();
  }
  {
    const host::AtSignal unlocked(unlock);
    try {
      store.emplace(report.store, plan, &*lock);
    } catch (...) {
      if (is_new) {
        remove_if_empty(nullptr, report.store);
      }
      throw;
    }
    if (!parts.empty()) {
      held.reset();  // they may take long
    }
    for (const std::filesystem::path& part : parts) {
      store->merge(part);
    }
    done = {store->done(), store->frames_done()};
    say(outlook_of(plan, done, threads_of(options)));
  }
  const std::vector<bool> needed = frames_needed(plan, done);
  report.timed += static_cast<std::size_t>(std::ranges::count(done.machines, false));
  report.traced += static_cast<std::size_t>(std::ranges::count(needed, true));
  Progress progress({options.terminal, options.quiet, stderr, threads_of(options)});
  SweepResults results(plan, *store, progress);
  const auto clean_up = [&] {
    progress.end();
    if (is_new) {
      remove_if_empty(&*store, report.store);
    }
  };
  try {
    const host::AtSignal last_words([&](int signal) {
      const std::size_t saved = results.close_for_good();
      unlock(signal);
      std::fprintf(
          stderr, "marti: interrupted: %zu of %zu machines are saved in %s; the same command does the rest\n",
          saved, plan.machines.size(), report.store.c_str());
    });
    held.reset();
    const TracedFrame last = time_machines(plan, done, limit, threads_of(options), results);
    if (!options.share || report.store.filename() == tables::database_name) {
      advise(
          plan, *store, limit,
          [&](std::size_t frame) {
            return last.log != nullptr && frame == last.number ? *last.log : trace_frame(plan, frame);
          },
          [&](std::size_t machine, const Advice& advice) { results.advised(machine, advice); });
    }
    held.emplace();  // until the store is closed
  } catch (const sim::UserError& error) {
    clean_up();
    throw sim::UserError(error.what() + (" (" + std::to_string(results.saved())) + " of " +
                             std::to_string(plan.machines.size()) + " machines are saved)",
                         error);
  } catch (...) {
    clean_up();
    throw;
  }
  progress.end();
  store->close();
}

// Locks the store if it and its parts have every machine of the plan between them. Of several
// processes that end at the same time, one after the other looks, so the last finds all.
bool lock_if_complete(const SweepPlan& plan, const std::filesystem::path& store,
                      std::optional<StoreLock>& lock) {
  constexpr std::chrono::seconds patience(30);  // for others that look, or merge
  for (const auto begin = std::chrono::steady_clock::now(); !lock;) {
    try {
      lock.emplace(store);
    } catch (const sim::UserError&) {
      if (std::chrono::steady_clock::now() - begin > patience) {
        return false;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
  bool complete = false;
  try {
    DoneKeys done;
    done.add(store);
    for (const std::filesystem::path& part : parts_in(store.parent_path())) {
      // A part that is being written, perhaps on another computer, is locked and has a log; it is not read.
      const StoreLock locked(part);
      if (!tables::has_log_or_journal(part)) {
        done.add(part);
      }
    }
    complete = std::ranges::all_of(
        plan.machines, [&](const SweepMachine& machine) { return done.machines.contains(machine.key); });
  } catch (const sim::UserError&) {
    // A part is being written, or is damaged: `marti sweep` without a share says so.
  }
  if (!complete) {
    lock.reset();
  }
  return complete;
}

}  // namespace

SweepOutlook look_ahead(const SweepPlan& plan, const SweepOptions& options) {
  const DoneKeys done = done_in(options.directory);
  const WorkDone work = {
      sim::mapped(plan.machines,
                  [&](const SweepMachine& machine) { return done.machines.contains(machine.key); }),
      sim::mapped(plan.frames, [&](const SweepFrame& frame) { return done.frames.contains(frame.key); })};
  return outlook_of(plan, work, threads_of(options));
}

SweepReport run_sweep(const SweepPlan& plan, const SweepOptions& options, const sim::MemoryBudget& limit,
                      const std::function<void(const std::string&)>& announce) {
  refuse_large_machines(plan, limit);
  const sim::MadeDirectory made = show::prepare_output(options.directory);
  const std::filesystem::path whole = options.directory / tables::database_name;
  SweepReport report;
  report.points = options.directory / "points.csv";
  sim::refuse_input(report.points);
  tables::refuse_other_results(options.directory, tables::database_name);
  const auto begin = std::chrono::steady_clock::now();
  const auto took = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  // Nobody else may write the store from its check until the tables that follow from it are written.
  std::optional<host::SignalsHeld> held;
  std::optional<StoreLock> lock;
  if (options.share) {
    DoneKeys done;
    done.add(whole);
    const SweepPlan part = part_of(plan, *options.share, [&](const SweepMachine& machine) {
      return done.machines.contains(machine.key);
    });
    announce(fmt::format("share         {}: {} on {}\n", options.share->text(),
                         tables::counted(part.machines.size(), "machine"),
                         tables::counted(part.frames.size(), "frame")));
    if (!part.machines.empty()) {
      report.store = part_file(options.directory, options.share->number, options.share->of);
      std::optional<host::SignalsHeld> held(std::in_place);
      std::optional<StoreLock> part_lock(std::in_place, report.store);
      complete(
          part, options, limit, part_lock, held, {}, [](const SweepOutlook&) {}, report);
    }
    report.seconds = took();
    if (!lock_if_complete(plan, whole, lock)) {
      return report;
    }
    if (!report.store.empty() && !tables::is_there(report.store)) {
      report.merged = true;  // by a process that ended at the same time
      return report;
    }
  } else {
    held.emplace();  // the lock is a file that a signal would leave
    lock.emplace(whole);
  }
  report.store = whole;
  complete(
      plan, options, limit, lock, held, parts_in(options.directory),
      [&](const SweepOutlook& outlook) {
        if (!options.share) {
          announce(describe(plan, outlook));
        }
      },
      report);
  const host::AtSignal unlocked([&lock](int /*signal*/) { lock.reset(); });
  held.reset();
  report.seconds = took();
  report.reader = std::make_unique<const SweepReader>(report.store);
  sim::write_file(report.points, tables::csv_of(points_table(*report.reader)));
  return report;
}

}  // namespace marti::studies::sweep
