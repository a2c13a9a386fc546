#include "studies/paper/traced_run.h"

#include "studies/run/functional_run.h"

namespace marti::studies::paper {

TracedRun trace_run(const PaperConfig& config, const PaperRun& run) {
  TracedRun traced;
  traced.run = run;
  const run::FunctionalRun functional = run::run_functional(config.frame_of(run));
  traced.totals = functional.totals;
  traced.log = functional.frame.log;
  traced.levels = count_levels(traced.log->topology);
  traced.visits = count_visits(*traced.log);
  return traced;
}

}  // namespace marti::studies::paper
