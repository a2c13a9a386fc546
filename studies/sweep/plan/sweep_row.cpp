#include "studies/sweep/plan/sweep_row.h"

#include <fmt/format.h>

#include <array>

#include "studies/figures/machine_totals.h"

namespace marti::studies::sweep {

SweepRow sweep_row(const processors::machine::MachineConfig& machine,
                   const processors::replay::MachineResult& result) {
  const figures::MachineTotals totals = figures::totals_of(result);
  SweepRow row;
  row.counters = figures::counts_of(machine, result, totals);
  const std::array<const std::optional<memory::WaitStatistics>*, histogram_names.size()> waits = {
      &totals.interconnect_waits, &totals.bank_waits, &totals.network_waits, &totals.l2_waits};
  for (std::size_t i = 0; i < waits.size(); ++i) {
    std::string& text = row.histograms[i];
    for (const sim::LogHistogram::Bucket& bucket :
         *waits[i] ? (*waits[i])->histogram.buckets() : std::vector<sim::LogHistogram::Bucket>()) {
      text +=
          fmt::format("{}[{},{},{}]", text.empty() ? '[' : ',', bucket.lowest, bucket.highest, bucket.count);
    }
    text += text.empty() ? "" : "]";
  }
  return row;
}

}  // namespace marti::studies::sweep
