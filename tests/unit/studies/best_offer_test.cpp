// Prices, the best machine, the Pareto front, metrics.
#include "studies/figures/best_offer.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <map>

#include "studies/keys/machine_cost.h"
#include "tests/support/user_error.h"

namespace marti::studies {

using namespace figures;
using namespace keys;

namespace {

// Few different figures, so that many are equal.
std::vector<Offer> random_offers() {
  const auto figures = *rc::gen::container<std::vector<std::pair<int, int>>>(
      rc::gen::pair(rc::gen::inRange(0, 8), rc::gen::inRange(-8, 8)));
  std::vector<Offer> offers;
  for (const auto& [cost, metric] : figures) {
    offers.push_back({static_cast<double>(cost), static_cast<double>(metric) / 4.0});
  }
  return offers;
}

bool no_worse(double a, double b, Better better) { return better == Better::lower ? a <= b : a >= b; }

RC_GTEST_PROP(Best, BeatsAllOthersWithinTheBudget, ()) {
  const std::vector<Offer> offers = random_offers();
  const Better better = *rc::gen::element(Better::lower, Better::higher);
  std::optional<double> budget;
  if (*rc::gen::arbitrary<bool>()) {
    budget = *rc::gen::inRange(-1, 9);
  }
  const std::optional<std::size_t> best = best_within(offers, budget, better);
  std::size_t affordable = 0;
  for (std::size_t i = 0; i < offers.size(); ++i) {
    if (budget && offers[i].cost > *budget) {
      continue;
    }
    ++affordable;
    RC_ASSERT(best.has_value());
    const Offer& chosen = offers[*best];
    RC_ASSERT(no_worse(chosen.metric, offers[i].metric, better));
    if (chosen.metric == offers[i].metric) {
      RC_ASSERT(chosen.cost <= offers[i].cost);
      RC_ASSERT((chosen.cost < offers[i].cost || *best <= i));
    }
  }
  RC_ASSERT(best.has_value() == (affordable > 0));
  RC_ASSERT((!best || !budget || offers[*best].cost <= *budget));
}

RC_GTEST_PROP(Pareto, IsWhatNoOtherOfferBeats, ()) {
  const std::vector<Offer> offers = random_offers();
  const Better better = *rc::gen::element(Better::lower, Better::higher);
  const std::vector<std::size_t> front = pareto_front(offers, better);
  std::vector<bool> on_front(offers.size());
  for (std::size_t i = 0; i < front.size(); ++i) {
    on_front[front[i]] = true;
    if (i > 0) {
      RC_ASSERT(offers[front[i - 1]].cost < offers[front[i]].cost);
    }
  }
  for (std::size_t i = 0; i < offers.size(); ++i) {
    bool beaten = false;
    for (std::size_t j = 0; j < offers.size(); ++j) {
      const bool no_dearer =
          offers[j].cost <= offers[i].cost && no_worse(offers[j].metric, offers[i].metric, better);
      const bool equal = offers[j].cost == offers[i].cost && offers[j].metric == offers[i].metric;
      beaten = beaten || (no_dearer && (!equal || j < i));
    }
    RC_ASSERT(on_front[i] == !beaten);
  }
}

// In binary numbers 3 * (3.3 + 16 * 0.1) + 8.8 is more than 23.5.
TEST(Cost, FitsABudgetOfTheDecimalPrices) {
  const Prices prices{8.8, 3.3, 0.0, 0.1, 0.0, 0.0, 0.0, 0.0};
  for (std::uint32_t nodes = 1; nodes <= 1000; ++nodes) {
    processors::machine::MachineConfig machine;
    machine.nodes = nodes;
    machine.cache.cache.size = 16384;
    const std::int64_t tenths = 88 + 49 * std::int64_t{nodes};
    EXPECT_EQ(cost_of(prices, machine), static_cast<double>(tenths) / 10.0) << nodes;
  }
}

TEST(Cost, IsThatOfEachPart) {
  const Prices prices{1000.0, 100.0, 10.0, 3.0, 0.5, 7.0, 20.0, 11.0};
  processors::machine::MachineConfig machine;
  machine.clusters = 2;
  machine.nodes = 3;
  machine.contexts = 4;
  machine.cache.cache.size = 2048;
  machine.interconnect.width = 8;
  machine.banks.count = 5;
  const double node = 100.0 + 3 * 10.0 + 2 * 3.0;
  EXPECT_DOUBLE_EQ(cost_of(prices, machine), 2 * (1000.0 + 3 * node + 8 * 7.0 + 5 * 11.0));
  machine.interconnect.kind = memory::InterconnectKind::crossbar;
  EXPECT_DOUBLE_EQ(cost_of(prices, machine), 2 * (1000.0 + 3 * node + 5 * 8 * 7.0 + 5 * 11.0));
  machine.interconnect.kind = memory::InterconnectKind::ideal;
  EXPECT_DOUBLE_EQ(cost_of(prices, machine), 2 * (1000.0 + 3 * node));
  machine.l2.sharing = processors::machine::SecondLevel::shared;
  machine.l2.cache.size = 8192;
  EXPECT_DOUBLE_EQ(cost_of(prices, machine), 2 * (1000.0 + 3 * node + 8 * 0.5));
  machine.l2.sharing = processors::machine::SecondLevel::private_caches;
  EXPECT_DOUBLE_EQ(cost_of(prices, machine), 2 * (1000.0 + 3 * (node + 8 * 0.5)));
  machine.l2.sharing = processors::machine::SecondLevel::none;
  machine.cache.organisation = processors::machine::CacheOrganisation::split;
  machine.cache.split_sizes = {1024, 1024, 1024, 1024};
  EXPECT_DOUBLE_EQ(cost_of(prices, machine), 2 * (1000.0 + 3 * (node + 2 * 3.0)));
  machine.cache.organisation = processors::machine::CacheOrganisation::none;
  machine.placement = processors::machine::Placement::distributed;
  machine.network.width = 4;
  EXPECT_DOUBLE_EQ(cost_of(prices, machine), 2 * (1000.0 + 3 * (130.0 + 4 * 20.0)));
}

}  // namespace
}  // namespace marti::studies
