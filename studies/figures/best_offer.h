// The best choice for a budget, and all choices that are the best for some budget.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "studies/figures/figure_entry.h"

namespace marti::studies::figures {

/// What a choice costs and what it gives: of a machine its price and a figure. Neither is NaN.
struct Offer {
  double cost = 0.0;
  double metric = 0.0;
};

/// Index of the offer with the best metric among those that cost at most `budget`; of equal ones the
/// cheapest, of these the first. std::nullopt when none is within the budget.
[[nodiscard]] std::optional<std::size_t> best_within(std::span<const Offer> offers,
                                                     std::optional<double> budget, Better better);

/// Indices of the offers that no other beats (costs no more and is no worse, and differs in one of them),
/// ascending by cost, so that each is better than the one before. Of equal offers only the first is given.
[[nodiscard]] std::vector<std::size_t> pareto_front(std::span<const Offer> offers, Better better);

/// Where more money begins to buy less: of offers as pareto_front() orders them, whose metric is a time, the
/// index of the one farthest below the line between the first and the last, in logarithms of cost and time. A
/// cost of 0 has no logarithm, so where the cheapest is free the costs themselves are taken. The last where
/// none is below the line. `front` is not empty.
[[nodiscard]] std::size_t knee_of(std::span<const Offer> front);

}  // namespace marti::studies::figures
