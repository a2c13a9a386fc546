// A sweep leaves other things out than a run does, and times several machines together: figures of machines
// are the same.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "studies/run/run_result.h"
#include "studies/sweep/plan/sweep_keys.h"
#include "studies/sweep/store/sweep_reader.h"
#include "studies/sweep/sweep.h"
#include "tests/support/temporary_directory.h"

namespace marti::studies {
namespace {

using figures::FigureEntry;

TEST(Figures, OfASweepAreThoseOfRuns) {
  const test::TemporaryDirectory directory;
  sim::Config config =
      sim::Config::from_file(sweep::sweep_schema(), MARTI_SOURCE "/tests/golden/machines.toml",
                             std::vector<std::string>{"image.width=8", "image.height=8"});
  const sweep::SweepPlan plan = sweep::plan_sweep(config);
  ASSERT_GE(plan.points.size(), 200U);
  const sweep::SweepReport report = sweep::run_sweep(plan, {.directory = directory.path(), .quiet = true},
                                                     sim::MemoryBudget(), [](const std::string&) {});
  for (const sweep::StoredPoint& point : report.reader->points()) {
    std::vector<std::string> settings;
    for (const auto& [key, value] : report.reader->settings(point.machine)) {
      settings.push_back(key + "=" + value);
    }
    sim::Config machine = sim::Config::from_text(run::run_schema(), "", "run.toml", settings);
    const run::RunResult run = run::run(machine);
    const figures::Counts here = report.reader->read_result(point.machine)->counters;
    const figures::Counts base = report.reader->read_result(point.base)->counters;
    for (const auto& entries : {figures::counted_figures(), figures::derived_figures()}) {
      for (const FigureEntry& entry : entries) {
        if (entry.of_machine()) {
          EXPECT_EQ(run.figure(entry.name), figures::figure_of({&here, &base}, entry.name))
              << entry.name << " of point " << point.ordinal;
        }
      }
    }
  }
}

}  // namespace
}  // namespace marti::studies
