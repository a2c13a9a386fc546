// Closed queueing networks: mean values and bounds, without simulation, for a fixed number of customers that
// circulate between a delay and some queues.
//
// Sources: M. Reiser, S. S. Lavenberg, Mean-value analysis of closed multichain queueing networks, JACM
// 27(2), 1980 (exact mean values); P. Schweitzer, Approximate analysis of multiclass closed networks of
// queues, 1979 (for many customers); J. Zahorjan, K. C. Sevcik, D. L. Eager, B. Galler, Balanced job bound
// analysis of queueing networks, CACM 25(2), 1982; the asymptotic bounds of R. R. Muntz, J. W. Wong, 1974.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace marti::processors::theory {

/// Times may have any unit; throughputs are in cycles of one customer per that unit.
struct ClosedNetwork {
  std::uint64_t customers = 1;  ///< N, at least 1
  double think = 0.0;           ///< Z, time of a cycle that meets no queue, at least 0
  std::vector<double> demands;  ///< D_k, time of a cycle at each queue when nobody else is there, at least 0

  [[nodiscard]] double demand() const;   ///< D, their sum
  [[nodiscard]] double largest() const;  ///< D_max; 0 without queues
  /// N* = (D + Z) / D_max, the number of customers from which on the busiest queue limits throughput;
  /// std::nullopt when no queue has a demand.
  [[nodiscard]] std::optional<double> saturation() const;
};

struct ThroughputRange {
  double low = 0.0;
  double high = 0.0;
};

// All of the following need D + Z > 0.

/// N / (N D + Z) and min(1 / D_max, N / (D + Z)). The throughput of queues that serve first come, first
/// served lies between them, whatever the distributions are.
[[nodiscard]] ThroughputRange asymptotic_bounds(const ClosedNetwork& network);

/// Narrower than asymptotic bounds; for networks with a product form, such as exponential service.
[[nodiscard]] ThroughputRange balanced_job_bounds(const ClosedNetwork& network);

struct MeanValues {
  double throughput = 0.0;
  std::vector<double> queues;  ///< mean number of customers at each queue, those served included
  bool exact = true;           ///< false: Schweitzer's approximation
};

/// Exact for networks with a product form, while customers times queues stay below `most_work`.
[[nodiscard]] MeanValues mean_values(const ClosedNetwork& network, std::uint64_t most_work = 1U << 24U);

/// Utilisation of the one server of a machine repairman (M/M/1//N) with mean think and service times: the
/// share of time in which somebody is served. By the recursion of Erlang's formula, of positive terms only.
[[nodiscard]] double repairman_utilisation(std::uint64_t customers, double think, double service);

}  // namespace marti::processors::theory
