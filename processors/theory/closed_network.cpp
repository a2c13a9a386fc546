#include "processors/theory/closed_network.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace marti::processors::theory {

double ClosedNetwork::demand() const { return std::accumulate(demands.begin(), demands.end(), 0.0); }

double ClosedNetwork::largest() const {
  return demands.empty() ? 0.0 : *std::max_element(demands.begin(), demands.end());
}

std::optional<double> ClosedNetwork::saturation() const {
  return largest() > 0.0 ? std::optional((demand() + think) / largest()) : std::nullopt;
}

namespace {

// Throughput cannot exceed what the busiest queue can serve.
double served(const ClosedNetwork& network, double throughput) {
  return network.largest() > 0.0 ? std::min(1.0 / network.largest(), throughput) : throughput;
}

MeanValues exact_values(const ClosedNetwork& network) {
  MeanValues values;
  values.queues.resize(network.demands.size());
  std::vector<double> residences(network.demands.size());
  for (std::uint64_t n = 1; n <= network.customers; ++n) {
    double cycle = network.think;
    for (std::size_t k = 0; k < residences.size(); ++k) {
      residences[k] = network.demands[k] * (1.0 + values.queues[k]);
      cycle += residences[k];
    }
    values.throughput = static_cast<double>(n) / cycle;
    for (std::size_t k = 0; k < residences.size(); ++k) {
      values.queues[k] = values.throughput * residences[k];
    }
  }
  return values;
}

// An arriving customer finds (N - 1) / N of the queue that N customers make.
MeanValues approximate_values(const ClosedNetwork& network) {
  const auto n = static_cast<double>(network.customers);
  MeanValues values;
  values.exact = false;
  values.queues.assign(network.demands.size(), n / static_cast<double>(network.demands.size()));
  constexpr int most_rounds = 100'000;
  for (int round = 0; round < most_rounds; ++round) {
    double cycle = network.think;
    for (std::size_t k = 0; k < values.queues.size(); ++k) {
      cycle += network.demands[k] * (1.0 + (n - 1.0) / n * values.queues[k]);
    }
    values.throughput = n / cycle;
    double change = 0.0;
    for (std::size_t k = 0; k < values.queues.size(); ++k) {
      const double queue = values.throughput * network.demands[k] * (1.0 + (n - 1.0) / n * values.queues[k]);
      change = std::max(change, std::abs(queue - values.queues[k]));
      values.queues[k] = queue;
    }
    if (change <= 1e-9 * n) {
      break;
    }
  }
  return values;
}

}  // namespace

ThroughputRange asymptotic_bounds(const ClosedNetwork& network) {
  const auto n = static_cast<double>(network.customers);
  const double d = network.demand();
  return {n / (n * d + network.think), served(network, n / (d + network.think))};
}

ThroughputRange balanced_job_bounds(const ClosedNetwork& network) {
  const auto n = static_cast<double>(network.customers);
  const double d = network.demand();
  if (d == 0.0) {
    return asymptotic_bounds(network);
  }
  const double z = network.think;
  const double mean = d / static_cast<double>(network.demands.size());
  return {n / (d + z + (n - 1.0) * network.largest() / (1.0 + z / (n * d))),
          served(network, n / (d + z + (n - 1.0) * mean / (1.0 + z / d)))};
}

MeanValues mean_values(const ClosedNetwork& network, std::uint64_t most_work) {
  const std::uint64_t queues = std::max<std::uint64_t>(1, network.demands.size());
  if (network.demand() > 0.0 && network.customers > most_work / queues) {
    return approximate_values(network);
  }
  if (network.demand() == 0.0) {
    return {static_cast<double>(network.customers) / network.think,
            std::vector<double>(network.demands.size()), true};
  }
  return exact_values(network);
}

double repairman_utilisation(std::uint64_t customers, double think, double service) {
  const double a = think / service;
  double blocking = 1.0;
  double utilisation = 0.0;
  for (std::uint64_t i = 1; i <= customers; ++i) {
    const auto n = static_cast<double>(i);
    utilisation = n / (n + a * blocking);
    blocking = a * blocking / (n + a * blocking);
  }
  return utilisation;
}

}  // namespace marti::processors::theory
