#include "studies/paper/traced_run.h"

#include <chrono>

#include "studies/functional_run.h"

namespace marti::studies {

TracedRun trace_run(const PaperConfig& config, const PaperRun& run) {
  TracedRun traced;
  traced.run = run;
  const auto begin = std::chrono::steady_clock::now();
  const FunctionalRun functional = run_functional(config.frame_of(run));
  traced.trace_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  traced.triangles = functional.scene.triangles;
  traced.totals = functional.totals;
  traced.log = functional.frame.log;
  traced.levels = count_levels(traced.log->topology);
  traced.visits = count_visits(*traced.log);
  return traced;
}

}  // namespace marti::studies
