#include "studies/stability/stability.h"

#include <string>
#include <vector>

#include <fmt/format.h>

#include "studies/host/cpu_time.h"
#include "studies/stability/precision_table.h"
#include "studies/stability/stability_keys.h"
#include "studies/tables/provenance.h"
#include "studies/tables/text_table.h"
#include "studies/tables/text_units.h"

namespace marti::studies::stability {

namespace {

tables::Table empty_table() {
  return tables::Table(
      "stability", "Stiff and extreme cases",
      {tables::text_column("group", "what is tried"), tables::text_column("case", "its name"),
       tables::text_column("what_could_go_wrong", "what breaks where no care is taken"),
       tables::text_column("oracle", "what must hold instead"),
       tables::text_column("figure", "what was found"),
       tables::real_column("objection", "1", "what the oracle objects to; nan when the case ended early"),
       tables::real_column("limit", "1", "the most it may be"),
       tables::text_column("verdict", "pass or FAIL")});
}

tables::Table empty_times() {
  return tables::Table(
      "stability_times", "CPU time of each case on this computer",
      {tables::text_column("case", "its name"),
       tables::real_column("cpu_time", "s", "process CPU time, building what it needs included")});
}

}  // namespace

tables::StudyOutput run_stability(sim::Config& config, sim::WorkMeter* meter) {
  return run_stability(config, stability_cases(), meter);
}

tables::StudyOutput run_stability(sim::Config& config, std::span<const StabilityCase> all,
                                  sim::WorkMeter* meter) {
  const StabilityConfig stability = read_stability(config, all);
  const CaseSize& size = stability.size;
  const std::vector<StabilityCase>& cases = stability.cases;
  tables::StudyOutput output;
  tables::Table table = empty_table();
  tables::Table times = empty_times();
  std::string failed;
  std::size_t failures = 0;
  sim::begin_part(meter, "trying extreme cases", "cases", cases.size());
  for (const StabilityCase& one : cases) {
    const double before = host::process_cpu_seconds();
    const CaseOutcome outcome = run_case(one, size);
    times.add_row({one.id, host::process_cpu_seconds() - before});
    table.add_row({one.group == CaseGroup::geometry ? "geometry" : "machine", one.id, one.risk, one.oracle,
                   outcome.figure, outcome.value, outcome.limit, outcome.passed() ? "pass" : "FAIL"});
    if (!outcome.passed()) {
      ++failures;
      failed += (failed.empty() ? "" : ", ") + one.id;
    }
    sim::count_step(meter);
  }
  const tables::Table precision = precision_table(compare_precisions(size.rays / 4));
  output.report = tables::text_of(table) + "\n" + tables::text_of(precision) + "\n" +
                  fmt::format("{}, {} passed, {} failed{}\n", tables::counted(cases.size(), "case"),
                              cases.size() - failures, failures, failed.empty() ? "" : ": " + failed);
  output.tables = {std::move(table), precision, tables::provenance_table(config.effective_values())};
  output.host_tables = {std::move(times), tables::host_table()};
  if (failures > 0) {
    output.fault = fmt::format("{} of {} cases failed: {}", failures, cases.size(), failed);
  }
  return output;
}

}  // namespace marti::studies::stability
