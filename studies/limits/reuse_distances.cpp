#include "studies/limits/reuse_distances.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace marti::studies::limits {

namespace {

// Beyond this number of ways a Poisson distribution is taken for its mean.
constexpr double most_poisson_ways = 256.0;

// A round that lowers the squared error by less than this share of it is the last. Lines do not fall into
// sets at random; a fit that went on would explain the difference by distances that are not there.
constexpr double least_gain = 0.01;
constexpr int most_rounds = 1000;

double squared_error(const std::vector<double>& fitted) {
  double sum = 0.0;
  for (const double each : fitted) {
    sum += (each - 1.0) * (each - 1.0);
  }
  return sum;
}

// The probability that a Poisson distribution of this mean gives at least `count`.
double at_least(double count, double mean) {
  if (count > most_poisson_ways) {
    return mean >= count ? 1.0 : 0.0;
  }
  double fewer = 0.0;
  for (double k = 0.0; k < count; k += 1.0) {
    fewer += std::exp(k * std::log(mean) - mean - std::lgamma(k + 1.0));
  }
  return std::max(0.0, 1.0 - fewer);
}

}  // namespace

ReuseDistances::Row ReuseDistances::miss_shares(double sets, double ways) {
  Row shares{};
  for (std::size_t i = 0; i + 1 < distances; ++i) {
    shares[i] = at_least(ways, std::exp2(static_cast<double>(i) / 2.0) / sets);
  }
  shares.back() = 1.0;
  return shares;
}

ReuseDistances::ReuseDistances(std::span<const CacheMisses> caches) {
  std::vector<Row> rows;
  Row wanted{};
  double sum = 0.0;
  for (const CacheMisses& cache : caches) {
    Row row = miss_shares(cache.sets, cache.ways);
    for (std::size_t i = 0; i < distances; ++i) {
      row[i] /= cache.misses;
      wanted[i] += row[i];
    }
    rows.push_back(row);
    sum += cache.misses;
  }
  references_.fill(sum / static_cast<double>(caches.size() * distances));
  std::vector<double> fitted(rows.size());  // misses / those that are to be fitted
  for (std::size_t k = 0; k < rows.size(); ++k) {
    for (std::size_t i = 0; i < distances; ++i) {
      fitted[k] += rows[k][i] * references_[i];
    }
  }
  double error = squared_error(fitted);
  for (int round = 0; round < most_rounds; ++round) {
    improve(rows, wanted, fitted);
    const double before = std::exchange(error, squared_error(fitted));
    if (error >= before * (1.0 - least_gain)) {
      break;
    }
  }
}

void ReuseDistances::improve(const std::vector<Row>& rows, const Row& wanted, std::vector<double>& fitted) {
  for (std::size_t i = 0; i < distances; ++i) {
    double now = 0.0;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      now += rows[k][i] * fitted[k];
    }
    if (now <= 0.0) {
      continue;
    }
    const double before = references_[i];
    references_[i] *= wanted[i] / now;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      fitted[k] += rows[k][i] * (references_[i] - before);
    }
  }
}

double ReuseDistances::misses(double sets, double ways) const {
  const Row shares = miss_shares(sets, ways);
  double sum = 0.0;
  for (std::size_t i = 0; i < distances; ++i) {
    sum += shares[i] * references_[i];
  }
  return sum;
}

}  // namespace marti::studies::limits
