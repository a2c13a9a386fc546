#include "studies/sweep/plan/sweep_row.h"

#include <array>

#include "studies/figures/machine_totals.h"

namespace marti::studies::sweep {

namespace {

constexpr std::array<std::string_view, 4> histogram_names = {"interconnect_wait", "bank_wait", "network_wait",
                                                             "l2_wait"};

}  // namespace

std::span<const std::string_view> sweep_histogram_names() { return histogram_names; }

SweepRow sweep_row(const processors::machine::MachineConfig& machine,
                   const processors::replay::MachineResult& result) {
  const figures::MachineTotals totals = figures::totals_of(result);
  SweepRow row;
  row.counters = figures::counts_of(machine, result, totals);
  const std::array<const std::optional<memory::WaitStatistics>*, histogram_names.size()> waits = {
      &totals.interconnect_waits, &totals.bank_waits, &totals.network_waits, &totals.l2_waits};
  for (std::size_t i = 0; i < waits.size(); ++i) {
    if (!*waits[i] || (*waits[i])->histogram.count() == 0) {
      continue;
    }
    SweepHistogram& histogram = row.histograms.emplace_back();
    histogram.what = histogram_names[i];
    for (const sim::LogHistogram::Bucket& bucket : (*waits[i])->histogram.buckets()) {
      histogram.buckets.push_back({bucket.lowest, bucket.highest, bucket.count});
    }
  }
  return row;
}

}  // namespace marti::studies::sweep
