#include "studies/sweep/join_sweep.h"

#include <optional>
#include <utility>

#include "studies/sweep/ranks/rank_sweep.h"
#include "studies/sweep/work/sweep_memory.h"

namespace marti::studies {

namespace {

/// What the workers need, and what it refers to.
struct Workshop {
  explicit Workshop(JoinedSweep sweep)
      : plan(std::move(sweep.plan)),
        memory(shares_of(sweep.memory_limit)),
        logs(memory.logs),
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
    return shop.emplace(read(configuration)).site;
  };
  work.over = [&](std::size_t frame) {
    shop->strips.drop(frame);
    shop->logs.drop(frame);
  };
  work_for_rank_0(ranks, work);
}

}  // namespace marti::studies
