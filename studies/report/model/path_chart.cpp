#include "studies/report/model/path_chart.h"

#include <cstdint>

#include "studies/report/model/chart_library.h"
#include "studies/report/model/run_charts.h"
#include "studies/tables/table.h"

namespace marti::studies::report {

void add_path_chart(const tables::RunJson& run, ReportData& report) {
  tables::Table table("run_path", "The critical path",
                      {tables::text_column("what", "what is done, see docs/model.md, The critical path"),
                       tables::integer_column("ps", "ps", "time of it on the path"),
                       tables::real_column("share", "fraction", "of the frame time")});
  const tables::RunJson times = run.part("machine.critical_path.time_ps");
  if (!times.json().is_object()) {
    return;
  }
  double all = 0.0;
  for (const auto& [name, value] : times.json().items()) {
    all += times.count(name);
  }
  for (const auto& [name, value] : times.json().items()) {
    if (const std::int64_t ps = whole(times, name); ps > 0) {
      table.add_row({name, ps, static_cast<double>(ps) / all});
    }
  }
  if (!table.rows().empty()) {
    report.charts.push_back(
        make_chart(table.name(), table,
                   "The chain of work that sets the end of the frame; the parts add up to the frame."));
  }
}

}  // namespace marti::studies::report
