#include "studies/sweep/sweep.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "processors/replay/host_bytes.h"
#include "sim/error.h"
#include "sim/files.h"
#include "sim/input_files.h"
#include "sim/mapped.h"
#include "studies/host/signals_held.h"
#include "studies/show/output.h"
#include "studies/sweep/ranks/rank_sweep.h"
#include "studies/sweep/store/sweep_store.h"
#include "studies/sweep/sweep_outlook.h"
#include "studies/sweep/work/coordinator.h"
#include "studies/sweep/work/sweep_worker.h"
#include "studies/tables/csv.h"
#include "studies/tables/result_directory.h"

namespace marti::studies::sweep {

namespace {

void refuse_large_machines(const SweepPlan& plan, const sim::MemoryBudget& memory) {
  for (const SweepMachine& machine : plan.machines) {
    memory.require(processors::replay::host_bytes(machine.config),
                   "a machine of " + std::to_string(machine.config.all_nodes()) + " nodes takes",
                   "lower machine.nodes or cache.size");
  }
}

unsigned threads_of(const SweepOptions& options) {
  return options.threads != 0       ? options.threads
         : options.ranks != nullptr ? threads_of_rank(*options.ranks)
                                    : static_cast<unsigned>(tbb::this_task_arena::max_concurrency());
}

template <class Part>
std::vector<bool> found_in(const std::vector<std::string>& keys, const std::vector<Part>& parts) {
  return sim::mapped(parts, [&](const Part& part) { return std::ranges::binary_search(keys, part.key); });
}

// Ends a store and removes its file if that holds no result. On a full disk, where a store cannot be ended,
// it stays.
void remove_if_empty(SweepStore& store, const std::filesystem::path& file) {
  const auto any = [](const std::vector<bool>& done) { return std::ranges::find(done, true) != done.end(); };
  try {
    if (any(store.done()) || any(store.frames_done())) {
      return;
    }
    store.close();
    if (std::error_code ignored; !tables::has_log_or_journal(file)) {
      std::filesystem::remove(file, ignored);
    }
  } catch (const sim::UserError&) {
  }
}

}  // namespace

SweepOutlook look_ahead(const SweepPlan& plan, const SweepOptions& options) {
  std::vector<bool> machines(plan.machines.size());
  std::vector<bool> frames(plan.frames.size());
  const std::filesystem::path file = options.directory / tables::database_name;
  if (!options.directory.empty() && is_begun(file)) {
    const SweepReader reader(file);
    machines = found_in(reader.machines_done(), plan.machines);
    frames = found_in(reader.frames_done(), plan.frames);
  }
  return outlook_of(plan, machines, frames, threads_of(options));
}

SweepReport run_sweep(const SweepPlan& plan, const SweepOptions& options, const sim::MemoryBudget& limit,
                      const std::optional<keys::Prices>& prices,
                      const std::function<void(const std::string&)>& announce) {
  refuse_large_machines(plan, limit);
  const sim::MadeDirectory made = show::prepare_output(options.directory);
  SweepReport report;
  report.store = options.directory / tables::database_name;
  report.points = options.directory / "points.csv";
  sim::refuse_input(report.points);
  tables::refuse_other_results(options.directory, tables::database_name);
  // Nobody else may write the store from its check until the tables that follow from it are written.
  std::optional<StoreLock> lock(std::in_place, report.store);
  const auto unlock = [&lock](int /*signal*/) { lock.reset(); };
  const bool is_new = !is_begun(report.store);
  SweepOutlook outlook;
  {
    const host::AtSignal unlocked(unlock);
    outlook = look_ahead(plan, options);  // checks a store that was begun
    announce(describe(plan, outlook));
  }
  const unsigned threads = threads_of(options);
  const unsigned all_threads =
      threads * (options.ranks != nullptr ? static_cast<unsigned>(options.ranks->size()) : 1U);
  SweepStore store(report.store, plan, &*lock);
  const Schedule left(plan, store.done(), store.frames_done());
  report.timed = left.machines_left();
  report.traced = left.frames_left();

  const auto begin = std::chrono::steady_clock::now();
  SweepSite site(plan, limit);
  Progress progress({options.terminal, options.quiet, stderr, all_threads});
  std::optional<RankServer> server;
  if (options.ranks != nullptr) {
    server.emplace(*options.ranks, plan);
  }
  Coordinator coordinator(
      plan, store, progress,
      [&](std::size_t frame) {
        site.drop(frame);
        if (server) {
          server->over(frame);
        }
      },
      std::move(outlook.costs));
  const auto clean_up = [&] {
    progress.end();
    if (is_new) {
      remove_if_empty(store, report.store);
    }
  };
  try {
    const host::AtSignal last_words([&](int signal) {
      const std::size_t saved = coordinator.close_for_good();
      unlock(signal);
      std::fprintf(
          stderr, "marti: interrupted: %zu of %zu machines are saved in %s; the same command does the rest\n",
          saved, plan.machines.size(), report.store.c_str());
    });
    if (server) {
      server->work(site, coordinator, options.configuration, threads);
    } else {
      // More workers than tasks would only wait.
      const std::size_t tasks = std::max<std::size_t>(1, report.timed + report.traced);
      work_together(site, coordinator, static_cast<unsigned>(std::min<std::size_t>(threads, tasks)));
    }
  } catch (const sim::UserError& error) {
    clean_up();
    throw sim::UserError(error.what() + (" (" + std::to_string(coordinator.saved())) + " of " +
                         std::to_string(plan.machines.size()) + " machines are saved)");
  } catch (...) {
    clean_up();
    throw;
  }
  progress.end();
  store.close();
  const host::AtSignal unlocked(unlock);
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  report.reader = std::make_unique<const SweepReader>(report.store);
  report.limited = limits::limited_points(*report.reader, prices);
  sim::write_file(report.points, tables::csv_of(report.limited->table));
  return report;
}

void join_sweep(Ranks& ranks, const SweepOptions& options,
                const std::function<JoinedSweep(const std::string& configuration)>& read) {
  std::optional<JoinedSweep> joined;
  std::optional<SweepSite> site;
  work_for_rank_0(ranks, options.threads != 0 ? options.threads : threads_of_rank(ranks),
                  [&](const std::string& configuration) -> SweepSite& {
                    joined = read(configuration);
                    return site.emplace(joined->plan, joined->memory);
                  });
}

}  // namespace marti::studies::sweep
