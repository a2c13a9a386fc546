// The measured errors that are built into the program, and the choices made by them.
#include "studies/estimate/measured_errors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "processors/replay/replay.h"
#include "sim/error.h"
#include "studies/error/simulator_errors.h"
#include "studies/estimate/simulator_methods.h"
#include "studies/estimate/within.h"
#include "tests/support/random_machine.h"

namespace marti::studies {
namespace {

TEST(MeasuredErrors, CoverEveryMethodThatAnswersAlone) {
  const std::vector<MeasuredError> errors = parse_measured_errors(measured_errors_csv());
  for (std::size_t method = 0; method < simulator_methods().size(); ++method) {
    for (const std::uint32_t nodes_to : node_classes) {
      const auto count = std::count_if(errors.begin(), errors.end(), [&](const MeasuredError& error) {
        return error.method == method && error.nodes_to == nodes_to;
      });
      EXPECT_EQ(count, answers_alone(simulator_methods()[method]) ? 1 : 0) << method << ' ' << nodes_to;
    }
  }
  for (const MeasuredError& error : errors) {
    EXPECT_GT(error.share, 0.0);
    EXPECT_LE(error.covered, 1.0);
    if (error.method == 0) {
      EXPECT_EQ(error.share, 1.0);
      EXPECT_EQ(error.allowance, MachineFigures());
    }
  }
}

TEST(MeasuredErrors, AnotherTableIsAFault) {
  const std::string good(measured_errors_csv());
  const auto refused = [](const std::string& text) {
    EXPECT_THROW((void)parse_measured_errors(text), sim::InternalError) << text.substr(0, 200);
  };
  refused("");
  refused("a,b\n");
  std::string other = good;
  other.replace(other.find('\n') + 1, 1, "9");  // the version
  refused(other);
  refused(good + "1,2\n");
  refused(good + "1,999,16,0.5,1,0,0,0,0,0,0,0,0,0,0\n");
  refused(good + "1,1,17,0.5,1,0,0,0,0,0,0,0,0,0,0\n");
  refused(good + "1,1,16,0.5,1,0,0,0,0,0,0,0,0,0,0,0\n");
  refused(good + "1,1,16,half,1,0,0,0,0,0,0,0,0,0,0\n");
  refused(good + "1,1,16,-0.5,1,0,0,0,0,0,0,0,0,0,0\n");
  EXPECT_EQ(parse_measured_errors(good + "1,1,16,0.5,1,0,0,0,0,0,0,0,0,inf,0\n").size(),
            parse_measured_errors(good).size() + 1);
}

TEST(Within, TolerancesArePercentagesOrFractions) {
  EXPECT_DOUBLE_EQ(parse_tolerance("2%"), 0.02);
  EXPECT_DOUBLE_EQ(parse_tolerance("2 %"), 0.02);
  EXPECT_DOUBLE_EQ(parse_tolerance("0.02"), 0.02);
  EXPECT_EQ(parse_tolerance("0"), 0.0);
  EXPECT_EQ(parse_tolerance("0%"), 0.0);
  EXPECT_EQ(parse_tolerance("100%"), 1.0);
  for (const char* text : {"", "%", "x", "2", "101 %", "-1 %", "nan", "inf", "1e999", "2 % %", "0x1"}) {
    EXPECT_THROW((void)parse_tolerance(text), sim::UserError) << text;
  }
}

TEST(Within, MachinesThatWereNotMeasuredAreOutside) {
  const processors::MachineConfig machine;
  constexpr std::uint64_t packets = 4096;
  EXPECT_FALSE(outside_measured(machine, packets));
  const auto outside = [&](auto change, const std::string& word, std::uint64_t count = 4096) {
    processors::MachineConfig other = machine;
    change(other);
    const std::optional<std::string> reason = outside_measured(other, count);
    ASSERT_TRUE(reason) << word;
    EXPECT_NE(reason->find(word), std::string::npos) << *reason;
  };
  using processors::MachineConfig;
  outside([](MachineConfig& m) { m.scheme = processors::Scheme::space; }, "scheme");
  outside([](MachineConfig& m) { m.contexts = 2; }, "context");
  outside([](MachineConfig& m) { m.build.sharing = processors::Sharing::shared; }, "build.sharing");
  outside([](MachineConfig& m) { m.clusters = 2; }, "cluster");
  outside([](MachineConfig& m) { m.nodes = 257; }, "256 nodes");
  outside([](MachineConfig& m) { m.cache.organisation = processors::CacheOrganisation::none; }, "caches");
  outside([](MachineConfig& m) { m.cache.cache.replacement = memory::Replacement::fifo; }, "LRU");
  outside([](MachineConfig& m) { m.interconnect.kind = memory::InterconnectKind::ideal; }, "bus");
  outside([](MachineConfig& m) { m.interconnect.mode = memory::BusMode::held; }, "split");
  outside([](MachineConfig& m) { m.placement = processors::Placement::replicated; }, "placement");
  outside([](MachineConfig&) {}, "packets", 1000);
}

// By the measured errors the answer is within the tolerance; and no cheaper method is known to be
// good enough.
TEST(Within, AnEstimateIsNeverWiderThanAskedFor) {
  test::Random random(3);
  const processors::WorkLog log = test::random_log(random, 64, 64, 12);
  processors::MachineConfig machine;
  machine.nodes = 4;
  machine.packets = {2, 2, processors::PacketOrder::scanline};
  const std::vector<MeasuredError> errors = parse_measured_errors(measured_errors_csv());
  std::optional<double> last_share;
  for (const double tolerance : {1.0, 0.3, 0.1, 0.03, 0.01, 0.001, 0.0}) {
    const std::optional<EstimatedRun> run = estimate_within(log, machine, tolerance);
    if (!run) {
      continue;
    }
    EXPECT_NE(run->method, 0U);
    EXPECT_EQ(run->nodes_to, 16U);
    EXPECT_LE(run->machine.half_width[Figure::end], tolerance);
    EXPECT_LE(run->machine.half_width[Figure::speed_up], tolerance);
    const auto found = std::find_if(errors.begin(), errors.end(), [&](const MeasuredError& error) {
      return error.method == run->method && error.nodes_to == 16;
    });
    ASSERT_NE(found, errors.end());
    EXPECT_LT(found->share, 1.0);
    EXPECT_GE(found->covered, 0.9);
    for (std::size_t i = 0; i < figure_count; ++i) {
      EXPECT_GE(run->machine.half_width[static_cast<Figure>(i)], found->allowance[static_cast<Figure>(i)]);
    }
    EXPECT_TRUE(!last_share || found->share >= *last_share) << tolerance;
    last_share = found->share;
  }
  EXPECT_FALSE(estimate_within(log, machine, 0.0));
}

}  // namespace
}  // namespace marti::studies
