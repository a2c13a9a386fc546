#include "studies/limits/queue_model.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace marti::studies::limits {

std::vector<double> throughputs(const QueueModel& model, std::uint64_t customers, double stretch) {
  double most = std::numeric_limits<double>::infinity();
  for (const Station& station : model.stations) {
    if (station.load * station.service > 0.0) {
      most = std::min(most, 1.0 / (station.load * station.service));
    }
  }
  std::vector<double> result = {0.0};
  result.reserve(customers + 1);
  std::vector<double> waits(model.stations.size());
  for (std::uint64_t n = 1; n <= customers; ++n) {
    double cycle = model.think;
    for (std::size_t k = 0; k < waits.size(); ++k) {
      const Station& station = model.stations[k];
      waits[k] = result.back() * station.load * (station.service * waits[k] + station.half_square);
      cycle += stretch * station.waits * waits[k];
    }
    result.push_back(std::min(most, static_cast<double>(n) / cycle));
  }
  return result;
}

double throughput_at(const std::vector<double>& throughputs, double customers) {
  const auto below = static_cast<std::size_t>(std::max(0.0, customers));
  if (below + 1 >= throughputs.size()) {
    return throughputs.back();
  }
  return std::lerp(throughputs[below], throughputs[below + 1], customers - static_cast<double>(below));
}

}  // namespace marti::studies::limits
