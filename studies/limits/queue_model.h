// Throughput of a closed network of queues whose service times are not exponential.
//
// Sources: S. L. Brumelle, On the relation between customer and time averages in queues, Journal of Applied
// Probability 8, 1971 (the work that a customer finds); M. Reiser, S. S. Lavenberg, Mean-value analysis of
// closed multichain queueing networks, JACM 27(2), 1980 (the arrival theorem, here an approximation).
#pragma once

#include <cstdint>
#include <vector>

namespace marti::studies::limits {

/// A queue that serves one visit at a time. Times may have any unit.
struct Station {
  double load = 0.0;         ///< visits of a cycle that occupy it
  double waits = 0.0;        ///< visits of a cycle for which the customer waits
  double service = 0.0;      ///< mean time that a visit occupies it
  double half_square = 0.0;  ///< half of the mean square of that time
};

struct QueueModel {
  double think = 0.0;  ///< time of a cycle that meets no queue, above 0
  std::vector<Station> stations;
};

/// Cycles per unit of time with 0, 1, ... `customers` customers. All waits are multiplied by `stretch`. Never
/// more than the busiest station can serve.
[[nodiscard]] std::vector<double> throughputs(const QueueModel& model, std::uint64_t customers,
                                              double stretch = 1.0);

/// Of a mean number of customers, linear between whole ones; beyond the last, that of the last.
[[nodiscard]] double throughput_at(const std::vector<double>& throughputs, double customers);

}  // namespace marti::studies::limits
