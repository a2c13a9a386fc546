// Machines for which queueing theory knows the answer: N nodes that alternate between computing and one bus.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "memory/bus.h"
#include "processors/replay/bounds.h"
#include "processors/replay/replay.h"
#include "processors/theory/closed_network.h"
#include "sim/engine.h"
#include "tests/support/cyclic_machine.h"

namespace marti::processors {

using namespace machine;
using namespace replay;
using namespace theory;

namespace {

using tests::Cyclic;

TEST(ClosedForms, DeterministicNodesOnOneBusAreExact) {
  constexpr std::int64_t reads = 50;
  bool below = false;
  bool at = false;
  bool above = false;
  // A time of the banks that makes N* a whole number.
  const std::int64_t cycles = Cyclic(1, 1, 1).think / MachineConfig().clock.period();
  std::int64_t whole = 5;
  while (cycles % (whole + 2) != 0) {
    ++whole;
  }
  for (const std::int64_t bank_cycles : {std::int64_t{1}, std::int64_t{13}, whole}) {
    for (std::uint32_t nodes = 1; nodes <= 70; ++nodes) {
      const Cyclic cyclic(nodes, reads, bank_cycles);
      const sim::Ticks z = cyclic.think;
      const sim::Ticks s = cyclic.service;
      const sim::Ticks n = nodes;
      const MachineResult result = replay::replay(cyclic.log, cyclic.machine);
      ASSERT_EQ(result.unloaded_miss - cyclic.machine.interconnect.clock.cycles(3), s)
          << "a material is one beat, an interleave four";
      EXPECT_EQ(cyclic.off(result, reads), 0) << nodes << " nodes";
      (n * s < z + s ? below : (n * s == z + s ? at : above)) = true;
      const sim::Ticks write =
          cyclic.machine.interconnect.clock.cycles(2) + cyclic.machine.banks.clock.cycles(bank_cycles);
      EXPECT_EQ(result.end, result.nodes.back().finish + write);
    }
  }
  EXPECT_TRUE(below && above);
  EXPECT_TRUE(at) << "no N is N* exactly";
}

// The bounds are near a saturated bus: they leave out the first round and the light load at the end.
TEST(ClosedForms, ASaturatedBusIsAtItsBound) {
  const Cyclic cyclic(64, 400, 4);
  const MachineResult result = replay::replay(cyclic.log, cyclic.machine);
  const FrameBounds bounds = frame_bounds(cyclic.machine, result);
  EXPECT_EQ(bounds.least(), bounds.interconnect);
  EXPECT_LE(result.end - bounds.interconnect, cyclic.think + cyclic.after + 64 * cyclic.service);
  const std::optional<Prediction> prediction = predict(cyclic.machine, result);
  ASSERT_TRUE(prediction.has_value());
  EXPECT_EQ(prediction->network.customers, 64U);
  EXPECT_LT(*prediction->network.saturation(), 64.0);
  EXPECT_NEAR(prediction->mean_value / static_cast<double>(result.end), 1.0, 0.02);
}

/// Nodes that think for exponential times and ask a real bus for records of exponential length.
class Terminals final : public memory::InterconnectClient, public sim::EventHandler {
 public:
  struct Config {
    std::uint32_t nodes = 1;
    double think = 0.0;    // ticks
    double service = 0.0;  // of the data on the bus
    memory::BusMode mode = memory::BusMode::held;
    std::uint32_t banks = 1;
    std::int64_t bank_access = 0;
  };

  Terminals(const Config& config, std::uint64_t seed) : config_(config), state_(seed) {
    memory::InterconnectConfig bus;
    bus.mode = config.mode;
    bus.clock = sim::Clock::from_period(1);
    bus.width = 1;
    bus.cycles_per_beat = 1;
    bus.address_cycles = 0;
    memory::BankConfig banks;
    banks.count = config.banks;
    banks.clock = sim::Clock::from_period(1);
    banks.access_cycles = config.bank_access;
    banks.busy_cycles = config.bank_access;
    bus_ = std::make_unique<memory::Bus>(bus, banks,
                                         memory::InterconnectSite{engine_, *this, 1, 0, config.nodes});
    engine_.attach(0, *this);
    engine_.attach(1, *this);
  }

  /// Reads a tick, from the first `warm_up` reads on, over `reads` more.
  double throughput(std::int64_t warm_up, std::int64_t reads) {
    left_ = warm_up + reads;
    for (std::uint32_t node = 0; node < config_.nodes; ++node) {
      think(node, 0);
    }
    warm_left_ = warm_up;
    engine_.run(std::numeric_limits<std::uint64_t>::max());
    return static_cast<double>(reads) / static_cast<double>(last_ - warm_);
  }

  void handle(const sim::Event& event) override {
    if (event.event_class() == 1) {
      bus_->reply(event.component());
    } else if (left_ > 0) {
      --left_;
      const auto bytes = static_cast<std::uint32_t>(std::max(1.0, exponential(config_.service)));
      bus_->read({event.component(), (next() % config_.banks) * 32, bytes});
    }
  }
  void read_done(std::uint32_t port, const memory::Service& service) override {
    if (--warm_left_ == 0) {
      warm_ = service.done;
    }
    last_ = std::max(last_, service.done);
    think(port, service.done);
  }
  void write_done(std::uint32_t /*port*/, sim::Ticks /*done*/) override {}

 private:
  void think(std::uint32_t node, sim::Ticks from) {
    engine_.post(sim::Event::make(from + static_cast<sim::Ticks>(exponential(config_.think)), 0, node));
  }
  double exponential(double mean) {
    return -mean * std::log((static_cast<double>(next() >> 11U) + 0.5) * 0x1p-53);
  }
  // SplitMix64 (Steele et al. 2014).
  std::uint64_t next() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15U;
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31U);
  }

  Config config_;
  std::uint64_t state_;
  sim::Engine engine_;
  std::unique_ptr<memory::Bus> bus_;
  std::int64_t left_ = 0;
  std::int64_t warm_left_ = 0;
  sim::Ticks warm_ = 0;
  sim::Ticks last_ = 0;
};

struct Estimate {
  double mean = 0.0;
  double error = 0.0;  ///< standard error of the mean
};

// Independent runs of the same machine.
Estimate estimate(const Terminals::Config& config, int runs, std::int64_t reads) {
  std::vector<double> throughputs;
  for (int run = 0; run < runs; ++run) {
    throughputs.push_back(Terminals(config, 1000003U * static_cast<std::uint64_t>(run + 1) + config.nodes)
                              .throughput(1000, reads));
  }
  const double n = runs;
  const double mean = std::accumulate(throughputs.begin(), throughputs.end(), 0.0) / n;
  double squares = 0.0;
  for (const double x : throughputs) {
    squares += (x - mean) * (x - mean);
  }
  return {mean, std::sqrt(squares / (n - 1.0) / n)};
}

// M/M/1//N. A tick is a ten-thousandth of a service, so rounding down takes half a tick, 0.005 %.
TEST(ClosedForms, RandomNodesOnOneBusAreAMachineRepairman) {
  for (const std::uint32_t nodes : {1U, 2U, 5U, 9U, 16U, 40U}) {
    Terminals::Config config;
    config.nodes = nodes;
    config.think = 80'000.0;
    config.service = 10'000.0;
    const Estimate x = estimate(config, 16, 6'000);
    const double expected = repairman_utilisation(nodes, config.think, config.service) / config.service;
    EXPECT_LT(x.error / expected, 0.005) << "too few runs to say anything";
    EXPECT_NEAR(x.mean, expected, 4.0 * x.error + 1e-4 * expected) << nodes << " nodes";
  }
}

// A split bus with exponential data in front of banks that take a fixed time: only the banks are not
// exponential, an error of mean value analysis.
TEST(ClosedForms, BusAndBanksAreNearMeanValueAnalysis) {
  for (const std::uint32_t nodes : {1U, 4U, 8U, 12U, 20U, 40U}) {
    Terminals::Config config;
    config.nodes = nodes;
    config.think = 80'000.0;
    config.service = 6'000.0;
    config.mode = memory::BusMode::split;
    config.banks = 4;
    config.bank_access = 20'000;
    const Estimate x = estimate(config, 8, 5'000);
    const double bank = static_cast<double>(config.bank_access) / config.banks;
    const ClosedNetwork network = {nodes, config.think, {config.service, bank, bank, bank, bank}};
    const double expected = mean_values(network).throughput;
    EXPECT_NEAR(x.mean / expected, 1.0, 0.05) << nodes << " nodes";
    EXPECT_LE(x.mean - 4.0 * x.error, asymptotic_bounds(network).high);
    EXPECT_GE(x.mean + 4.0 * x.error, asymptotic_bounds(network).low);
    ::testing::Test::RecordProperty("error_" + std::to_string(nodes),
                                    std::to_string(x.mean / expected - 1.0));
  }
}

}  // namespace
}  // namespace marti::processors
