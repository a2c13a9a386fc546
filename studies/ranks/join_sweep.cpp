#include "studies/ranks/join_sweep.h"

#include <cstdio>
#include <optional>
#include <system_error>
#include <utility>

#include "studies/ranks/rank_sweep.h"
#include "studies/sweep/sweep_memory.h"

namespace marti::studies {

namespace {

std::filesystem::path spill_directory(const std::filesystem::path& results) {
  std::error_code error;
  return std::filesystem::is_directory(results, error) ? results : std::filesystem::temp_directory_path();
}

/// What the workers need, and what it refers to.
struct Workshop {
  Workshop(JoinedSweep sweep, const SweepOptions& options)
      : plan(std::move(sweep.plan)),
        memory(shares_of(sweep.memory_limit)),
        logs({memory.logs, spill_directory(options.directory), options.keep_logs}),
        strips(memory.strips),
        machines(memory.machines) {}

  SweepPlan plan;
  SweepMemory memory;
  LogShelf logs;
  StripShelf strips;
  MemoryGate machines;
  SweepSite site{plan, logs, strips, machines};
};

}  // namespace

void join_sweep(Ranks& ranks, const SweepOptions& options,
                const std::function<JoinedSweep(const std::string& configuration)>& read) {
  std::optional<Workshop> shop;
  RankWork work;
  work.workers = options.threads != 0 ? options.threads : threads_of_rank(ranks);
  work.prepare = [&](const std::string& configuration) -> const SweepSite& {
    return shop.emplace(read(configuration), options).site;
  };
  work.over = [&](std::size_t frame) {
    shop->strips.drop(frame);
    shop->logs.drop(shop->plan.frames[frame].key);
  };
  work_for_rank_0(ranks, work);
  for (const std::string& note : shop->logs.notes()) {
    std::fprintf(stderr, "marti: note: rank %zu: %s\n", ranks.rank(), note.c_str());
  }
}

}  // namespace marti::studies
