#include "studies/figures/best_offer.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "sim/error.h"

namespace marti::studies::figures {

namespace {

bool is_better(double a, double b, Better better) { return better == Better::higher ? a > b : a < b; }

void check(std::span<const Offer> offers) {
  const bool numbers = std::ranges::none_of(
      offers, [](const Offer& offer) { return std::isnan(offer.cost) || std::isnan(offer.metric); });
  sim::ensure(numbers, "an offer's cost or metric is no number");
}

}  // namespace

std::optional<std::size_t> best_within(std::span<const Offer> offers, std::optional<double> budget,
                                       Better better) {
  check(offers);
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < offers.size(); ++i) {
    if (budget && offers[i].cost > *budget) {
      continue;
    }
    if (!best || is_better(offers[i].metric, offers[*best].metric, better) ||
        (offers[i].metric == offers[*best].metric && offers[i].cost < offers[*best].cost)) {
      best = i;
    }
  }
  return best;
}

std::vector<std::size_t> pareto_front(std::span<const Offer> offers, Better better) {
  check(offers);
  std::vector<std::size_t> order(offers.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    return offers[a].cost != offers[b].cost ? offers[a].cost < offers[b].cost
                                            : is_better(offers[a].metric, offers[b].metric, better);
  });
  std::vector<std::size_t> front;
  for (const std::size_t i : order) {
    if (front.empty() || is_better(offers[i].metric, offers[front.back()].metric, better)) {
      front.push_back(i);
    }
  }
  return front;
}

std::size_t knee_of(std::span<const Offer> front) {
  const bool free = front.front().cost <= 0.0;
  const auto place = [&](const Offer& offer) {
    return std::pair(free ? offer.cost : std::log(offer.cost), std::log(offer.metric));
  };
  const auto [x0, y0] = place(front.front());
  const auto [x1, y1] = place(front.back());
  std::size_t best = front.size() - 1;
  double deepest = 0.0;
  for (std::size_t i = 0; i < front.size(); ++i) {
    const auto [x, y] = place(front[i]);
    const double depth = x1 > x0 ? y0 + (y1 - y0) * (x - x0) / (x1 - x0) - y : 0.0;
    if (depth > deepest + 1e-12) {
      deepest = depth;
      best = i;
    }
  }
  return best;
}

}  // namespace marti::studies::figures
