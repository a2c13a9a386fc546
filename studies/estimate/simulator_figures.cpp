#include "studies/estimate/simulator_figures.h"

#include <limits>

#include "studies/figures/derived_figures.h"

namespace marti::studies::estimate {

MachineFigures figures_of(const processors::machine::MachineConfig& machine,
                          const processors::replay::MachineResult& result) {
  MachineFigures figures;
  figures[Figure::end] = static_cast<double>(result.end);
  figures[Figure::misses] = static_cast<double>(result.references().all_misses());
  figures[Figure::use] = figures::figure_of(machine, result, "interconnect_utilisation").value_or(0.0);
  double waited = 0.0;
  double tenures = 0.0;
  for (const processors::replay::ClusterResult& cluster : result.clusters) {
    waited += static_cast<double>(cluster.interconnect.waits.sum);
    tenures += static_cast<double>(cluster.interconnect.waits.count);
  }
  figures[Figure::wait] = tenures > 0.0 ? waited / tenures : 0.0;
  return figures;
}

double error_of(Figure figure, double estimate, double truth) {
  if (figure == Figure::use) {
    return estimate - truth;
  }
  if (truth == 0.0) {
    return estimate == 0.0 ? 0.0 : std::numeric_limits<double>::infinity();
  }
  return estimate / truth - 1.0;
}

void add_speed_up(Estimate& machine, const Estimate& one_node) {
  const double end = machine.value[Figure::end];
  machine.value[Figure::speed_up] = end > 0.0 ? one_node.value[Figure::end] / end : 0.0;
  machine.half_width[Figure::speed_up] = machine.half_width[Figure::end] + one_node.half_width[Figure::end];
}

}  // namespace marti::studies::estimate
