#include "studies/figures/loss.h"

#include <string>

#include "processors/replay/bounds.h"
#include "sim/error.h"

namespace marti::studies {

using processors::Activity;

namespace {

Loss loss_of(Activity activity, bool had_work) {
  switch (activity) {
    case Activity::traversal:
    case Activity::intersection:
    case Activity::shading:
    case Activity::cache_access:
    case Activity::transfer:
    case Activity::bank_access:
      return Loss::extra_misses;
    case Activity::interconnect_wait:
    case Activity::bank_wait:
      return Loss::contention;
    case Activity::building:
    case Activity::switching:
    case Activity::messaging:
    case Activity::lock_wait:
    case Activity::queue_full_wait:
    case Activity::dispatch_wait:
      return Loss::overhead;
    case Activity::message_wait:
    case Activity::idle:
      break;
  }
  return had_work ? Loss::imbalance : Loss::idle;
}

void add(const processors::MachineResult& result, sim::Ticks sign, std::array<sim::Ticks, losses>& parts) {
  for (const processors::NodeStatistics& node : result.nodes) {
    const bool had_work = processors::had_work(node);
    for (std::size_t i = 0; i < processors::activities; ++i) {
      sim::Ticks& part = parts[static_cast<std::size_t>(loss_of(static_cast<Activity>(i), had_work))];
      part = sim::add_ticks(part, sign * node.time[i]);
    }
  }
}

}  // namespace

SpeedUpLoss loss_of(const processors::MachineResult& one, const processors::MachineResult& all) {
  SpeedUpLoss loss;
  loss.total = sim::multiply_ticks(all.end, static_cast<std::int64_t>(all.nodes.size())) - one.end;
  add(all, 1, loss.parts);
  add(one, -1, loss.parts);
  sim::Ticks sum = 0;
  for (const sim::Ticks part : loss.parts) {
    sum = sim::add_ticks(sum, part);
  }
  sim::ensure(one.nodes.size() == 1 && sum == loss.total,
              "the parts of the lost speed-up do not add up to n T(n) - T(1)");
  return loss;
}

}  // namespace marti::studies
