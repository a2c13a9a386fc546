#include "studies/report/model/line_model.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "processors/theory/closed_network.h"
#include "sim/error.h"
#include "sim/rounded.h"
#include "studies/report/model/digits.h"

namespace marti::studies::report {

namespace {

// The largest number of customers times queues for which mean values are worked out exactly. A page has
// thousands of them.
constexpr std::uint64_t most_exact_work = 1U << 16U;

// Nodes of a cluster that can have work.
double customers_of(const PointCounters& counters) {
  const double nodes = counters.packets > 0.0 ? std::min(counters.nodes, counters.packets) : counters.nodes;
  return nodes / std::max(1.0, counters.clusters);
}

// The most queues of a network, which has an entry for each: no configuration has more (memory.banks).
constexpr double most_queues = 65536.0;

// The queues of a cluster. `count` may be interpolated, or of a store that somebody may have changed.
std::size_t queues_of(double count, const PointCounters& counters) {
  const double each = std::round(count / std::max(1.0, counters.clusters));
  return each > 0.0 ? static_cast<std::size_t>(std::min(each, most_queues)) : 0;
}

processors::theory::ClosedNetwork network_of(const PointCounters& counters) {
  processors::theory::ClosedNetwork network;
  network.customers = static_cast<std::uint64_t>(std::clamp(std::round(customers_of(counters)), 1.0, 1e9));
  const double around = counters.reads > 0.0 ? counters.reads : 1.0;
  if (counters.reads > 0.0) {
    const auto queues = [&](double count, double busy) {
      const std::size_t each = queues_of(count, counters);
      if (each > 0 && busy > 0.0) {
        network.demands.insert(network.demands.end(), each, busy / around / static_cast<double>(each));
      }
    };
    queues(counters.links, counters.link_busy);
    queues(counters.banks, counters.bank_busy);
  }
  network.think = std::max(0.0, (counters.work + counters.delays) / around - network.demand());
  return network;
}

// Cycles of a cluster's closed network: its reads or, without reads, one for all of its work.
double cycles_of(const PointCounters& counters) {
  return (counters.reads > 0.0 ? counters.reads : 1.0) / std::max(1.0, counters.clusters);
}

// Interpolates linearly in the logarithms if both are above 0.
double interpolate(double a, double b, double share) {
  if (a > 0.0 && b > 0.0) {
    return a == b ? a : std::exp(std::lerp(std::log(a), std::log(b), share));
  }
  return std::max(0.0, std::lerp(a, b, share));
}

PointCounters interpolate(const PointCounters& a, const PointCounters& b, double share) {
  PointCounters c;
  for (double PointCounters::*const member :
       {&PointCounters::end, &PointCounters::base_end, &PointCounters::nodes, &PointCounters::clusters,
        &PointCounters::packets, &PointCounters::work, &PointCounters::delays, &PointCounters::reads,
        &PointCounters::links, &PointCounters::link_busy, &PointCounters::banks, &PointCounters::bank_busy}) {
    c.*member = interpolate(a.*member, b.*member, share);
  }
  return c;
}

}  // namespace

double closed_network_end(const PointCounters& counters) {
  const processors::theory::ClosedNetwork network = network_of(counters);
  if (network.think + network.demand() <= 0.0) {
    return counters.end;
  }
  return cycles_of(counters) / processors::theory::mean_values(network, most_exact_work).throughput;
}

double asymptotic_end(const PointCounters& counters) {
  const processors::theory::ClosedNetwork network = network_of(counters);
  const double cycles = cycles_of(counters);
  // Rounded up to a whole node: with fewer nodes the work takes longer, so this stays a lower bound. A
  // fraction of 1e-12 comes from rounding in the interpolation and does not count.
  const double customers = std::max(1.0, std::ceil(customers_of(counters) * (1.0 - 1e-12)));
  return std::max(counters.work / std::max(1.0, counters.clusters) / customers, network.largest() * cycles);
}

std::optional<double> saturation_nodes(const PointCounters& counters) {
  return network_of(counters).saturation();
}

LineModel::LineModel(std::vector<PointCounters> points, bool logarithmic)
    : points_(std::move(points)), logarithmic_(logarithmic) {
  std::ranges::sort(points_, {}, &PointCounters::x);
  sim::ensure(points_.size() >= 2, "a line model needs two points");
  for (std::size_t i = 0; i < points_.size(); ++i) {
    sim::ensure(points_[i].end > 0.0 && (i == 0 || points_[i - 1].x < points_[i].x) &&
                    (!logarithmic || points_[i].x > 0.0),
                "the points of a line model need frame times and places of their own");
    ratios_.push_back(points_[i].end / closed_network_end(points_[i]));
  }
}

Zone LineModel::zone(double x) const {
  return x < points_.front().x || x > points_.back().x ? Zone::beyond : Zone::between;
}

Modelled LineModel::at(double x) const {
  const auto above =
      std::lower_bound(points_.begin() + 1, points_.end() - 1, x,
                       [](const PointCounters& point, double place) { return point.x < place; });
  const auto right = static_cast<std::size_t>(above - points_.begin());
  const PointCounters& a = points_[right - 1];
  const PointCounters& b = points_[right];
  const double share = logarithmic_ ? (std::log(x) - std::log(a.x)) / (std::log(b.x) - std::log(a.x))
                                    : (x - a.x) / (b.x - a.x);
  const PointCounters counters = interpolate(a, b, share);
  Modelled modelled;
  modelled.asymptote = asymptotic_end(counters);
  // Exact frames never lie below their bound, but the product of two interpolations may. The ratio corrects
  // the network model; beyond the points it is not known, and that of the last point is used.
  modelled.end = std::max(closed_network_end(counters) *
                              interpolate(ratios_[right - 1], ratios_[right], std::clamp(share, 0.0, 1.0)),
                          modelled.asymptote);
  modelled.base_end = counters.base_end;
  modelled.zone = zone(x);
  return modelled;
}

namespace {

// How far beyond `rest` x lies, in steps of the two points beside it; 0 between them.
double steps_beyond(std::span<const PointCounters> rest, double x, bool logarithmic) {
  const auto distance = [&](double a, double b) { return std::abs(logarithmic ? std::log(a / b) : a - b); };
  const std::size_t last = rest.size() - 1;
  if (x < rest[0].x) {
    return distance(x, rest[0].x) / distance(rest[0].x, rest[1].x);
  }
  return x > rest[last].x ? distance(x, rest[last].x) / distance(rest[last].x, rest[last - 1].x) : 0.0;
}

constexpr double most_steps = 2.0 + 1e-6;  // two steps, and room for the rounding of places

}  // namespace

void LeaveOneOut::add(const LineModel& line, bool logarithmic) {
  const std::span<const PointCounters> points = line.points();
  if (points.size() < 3) {
    return;
  }
  for (std::size_t left_out = 0; left_out < points.size(); ++left_out) {
    std::vector<PointCounters> rest;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (i != left_out) {
        rest.push_back(points[i]);
      }
    }
    const PointCounters& exact = points[left_out];
    if (steps_beyond(rest, exact.x, logarithmic) > most_steps) {
      continue;
    }
    const Modelled modelled = LineModel(std::move(rest), logarithmic).at(exact.x);
    const auto zone = static_cast<std::size_t>(modelled.zone);
    end_[zone].push_back(std::abs(std::log(modelled.end / exact.end)));
    if (exact.base_end > 0.0 && modelled.base_end > 0.0) {
      speed_up_[zone].push_back(
          std::abs(std::log(modelled.base_end / modelled.end / (exact.base_end / exact.end))));
    }
  }
}

ModelError LeaveOneOut::summary(std::vector<double> errors) {
  ModelError error;
  error.points = errors.size();
  if (errors.empty()) {
    return error;
  }
  std::ranges::sort(errors);
  const double mean = std::accumulate(errors.begin(), errors.end(), 0.0) / static_cast<double>(errors.size());
  const auto rank = static_cast<std::size_t>(std::ceil(0.95 * static_cast<double>(errors.size())));
  error.mean = sim::rounded(std::expm1(mean), curve_digits);
  error.p95 = sim::rounded(std::expm1(errors[rank - 1]), curve_digits);
  return error;
}

}  // namespace marti::studies::report
