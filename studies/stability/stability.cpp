#include "studies/stability/stability.h"

#include <string>
#include <vector>

#include <fmt/format.h>

#include "studies/host/cpu_time.h"
#include "studies/stability/precision_table.h"
#include "studies/stability/stability_keys.h"
#include "studies/tables/provenance.h"
#include "studies/tables/text_table.h"

namespace marti::studies {

namespace {

Table empty_table() {
  return Table(
      "stability", "Stiff and extreme cases",
      {{"group", ColumnType::text, "", "what is tried"},
       {"case", ColumnType::text, "", "its name"},
       {"what_could_go_wrong", ColumnType::text, "", "what breaks where no care is taken"},
       {"oracle", ColumnType::text, "", "what must hold instead"},
       {"figure", ColumnType::text, "", "what was found"},
       {"objection", ColumnType::real, "1", "what the oracle objects to; nan when the case ended early"},
       {"limit", ColumnType::real, "1", "the most it may be"},
       {"verdict", ColumnType::text, "", "pass or FAIL"}});
}

Table empty_times() {
  return Table("stability_times", "CPU time of each case on this computer",
               {{"case", ColumnType::text, "", "its name"},
                {"cpu_time", ColumnType::real, "s", "process CPU time, building what it needs included"}});
}

}  // namespace

StudyOutput run_stability(sim::Config& config, sim::WorkMeter* meter) {
  return run_stability(config, stability_cases(), meter);
}

StudyOutput run_stability(sim::Config& config, std::span<const StabilityCase> all, sim::WorkMeter* meter) {
  const StabilityConfig stability = read_stability(config, all);
  const CaseSize& size = stability.size;
  const std::vector<StabilityCase>& cases = stability.cases;
  StudyOutput output;
  Table table = empty_table();
  Table times = empty_times();
  std::string failed;
  std::size_t failures = 0;
  sim::begin_part(meter, "trying extreme cases", "cases", cases.size());
  for (const StabilityCase& one : cases) {
    const double before = process_cpu_seconds();
    const CaseOutcome outcome = run_case(one, size);
    times.add_row({one.id, process_cpu_seconds() - before});
    table.add_row({std::string(one.group == CaseGroup::geometry ? "geometry" : "machine"), one.id, one.risk,
                   one.oracle, outcome.figure, outcome.value, outcome.limit,
                   std::string(outcome.passed() ? "pass" : "FAIL")});
    if (!outcome.passed()) {
      ++failures;
      failed += (failed.empty() ? "" : ", ") + one.id;
    }
    sim::count_step(meter);
  }
  const Table precision = precision_table(compare_precisions(size.rays / 4));
  output.report = text_of(table) + "\n" + text_of(precision) + "\n" +
                  fmt::format("{} cases, {} passed, {} failed{}\n", cases.size(), cases.size() - failures,
                              failures, failed.empty() ? "" : ": " + failed);
  output.tables = {std::move(table), precision, provenance_table(config.effective_values())};
  output.host_tables = {std::move(times), host_table()};
  if (failures > 0) {
    output.fault = fmt::format("{} of {} cases failed: {}", failures, cases.size(), failed);
  }
  return output;
}

}  // namespace marti::studies
