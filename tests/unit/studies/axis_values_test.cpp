// Axes of a sweep given on the command line.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "studies/sweep/plan/axis_values.h"
#include "studies/sweep/plan/sweep_keys.h"
#include "studies/sweep/plan/sweep_table.h"
#include "tests/support/user_error.h"

namespace marti::studies {

using namespace sweep;

namespace {

sim::Config config_of(std::string_view text = "", const std::vector<std::string>& assignments = {}) {
  return sim::Config::from_text(sweep_schema(), text, "test.toml", assignments);
}

// The values as they would stand in a file.
std::vector<std::string> values_of(const std::string& argument) {
  const sim::Config config = config_of();
  const AxisArgument axis = read_axis_argument(config, argument);
  std::vector<std::string> values;
  for (const sim::Setting& step : axis.steps) {
    EXPECT_EQ(step.key, axis.key);
    EXPECT_EQ(step.place, "--axis " + argument);
    values.push_back(print_values(config.schema().keys()[axis.key], step.values));
  }
  return values;
}

using Values = std::vector<std::string>;

TEST(AxisArgument, ListsValuesOfEveryType) {
  EXPECT_EQ(values_of("machine.nodes=1,4,16"), (Values{"1", "4", "16"}));
  EXPECT_EQ(values_of("machine.nodes = 2 , 1"), (Values{"2", "1"}));
  EXPECT_EQ(values_of("cache.size=1024,16 KiB"), (Values{"\"1 KiB\"", "\"16 KiB\""}));
  EXPECT_EQ(values_of("structure.kind=octree,bsp"), (Values{"\"octree\"", "\"bsp\""}));
  EXPECT_EQ(values_of("structure.mailboxes=true,false"), (Values{"true", "false"}));
  EXPECT_EQ(values_of("node.clock=33MHz,1GHz").size(), 2U);
  EXPECT_EQ(values_of("scene.source=teapot:12,gears:2"), (Values{"\"teapot:12\"", "\"gears:2\""}));
  EXPECT_EQ(values_of("structure.grid_density=0.5,2"), (Values{"0.5", "2.0"}));
}

TEST(AxisArgument, QuotedValuesMayHoldCommas) {
  EXPECT_EQ(values_of(R"(scene.source="a,b.glb",c.glb, "d ""e"", f.obj" ,"g")"),
            (Values{R"("a,b.glb")", R"("c.glb")", R"("d \"e\", f.obj")", R"("g")"}));
  EXPECT_EQ(values_of(R"(machine.nodes="1",2)"), (Values{"1", "2"}));
}

TEST(AxisArgument, RangesHoldEveryStepUpToTheirEnd) {
  EXPECT_EQ(values_of("machine.nodes=1..4"), (Values{"1", "2", "3", "4"}));
  EXPECT_EQ(values_of("machine.nodes=1..8+3"), (Values{"1", "4", "7"}));
  EXPECT_EQ(values_of("machine.nodes=1..20*4,100"), (Values{"1", "4", "16", "100"}));
  EXPECT_EQ(values_of("cache.size=4KiB..32KiB*2"),
            (Values{"\"4 KiB\"", "\"8 KiB\"", "\"16 KiB\"", "\"32 KiB\""}));
  EXPECT_EQ(values_of("cache.size=4KiB..12KiB+4KiB"), (Values{"\"4 KiB\"", "\"8 KiB\"", "\"12 KiB\""}));
  // No rounding leaves out the end: 0.1 five times added to itself is not 0.5.
  EXPECT_EQ(values_of("structure.grid_density=0.1..0.5+0.1").size(), 5U);
  EXPECT_EQ(values_of("structure.grid_density=0.1..0.5+0.1").back(), "0.5");
  EXPECT_EQ(values_of("structure.grid_density=1..3+1e+0"), (Values{"1.0", "2.0", "3.0"}));
  EXPECT_EQ(values_of("structure.grid_density=1..1e+2*10"), (Values{"1.0", "10.0", "100.0"}));
  EXPECT_EQ(values_of("machine.nodes=2..7*1.5"), (Values{"2", "3", "5", "7"}));
}

TEST(AxisArgument, RefusesWithTheArgumentAndTheReason) {
  const auto fault = [](const std::string& argument) {
    return test::user_error_of([&] { static_cast<void>(read_axis_argument(config_of(), argument)); });
  };
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "form"},
      {"=1", "form"},
      {"machine.nodes", "form"},
      {"machine.node=1", "did you mean \"machine.nodes\""},
      {"machine.nodes=", "missing"},
      {"machine.nodes=1,,2", "missing"},
      {R"(scene.source="a,b)", "not closed"},
      {R"(scene.source="a"b,c)", "comes a comma, not b"},
      {R"(scene.source="")", "missing"},
      {R"(scene.source="a","a")", "twice"},
      {"machine.nodes=1,2,1", "twice"},
      {"machine.nodes=two", "integer"},
      {"machine.nodes=1.5", "integer"},
      {"machine.nodes=-1", "must be 1 to"},
      {"machine.nodes=99999999999999999999", "integer"},
      {"machine.nodes=8..1", "goes up"},
      {"machine.nodes=1..1", "goes up"},
      {"machine.nodes=1..", "missing"},
      {"machine.nodes=..4", "missing"},
      {"machine.nodes=1..8+0", "above 0"},
      {"machine.nodes=1..8*1", "above 1"},
      {"machine.nodes=1..8*x", "above 1"},
      {"machine.nodes=1..8+", "number after"},
      {"machine.nodes=2..9*1.1", "too small"},
      {"cache.size=4KiB..8KiB", "step"},
      {"interconnect.address_cycles=0..8*2", "above 0"},
      {"structure.kind=octree..bsp", "octree"},
      {"image.width=1..32768,1..5", "twice"},
      {"interconnect.width=1..9*1e400", "above 1"}};
  for (const auto& [argument, reason] : cases) {
    const std::string message = fault(argument);
    EXPECT_TRUE(message.starts_with("--axis " + argument + ": ")) << message;
    EXPECT_NE(message.find(reason), std::string::npos) << argument << ": " << message;
  }
}

TEST(AxisArgument, StepsOfRealsAreDecimals) {
  EXPECT_EQ(values_of("energy.voltage=0.1..0.7+0.1"),
            (Values{"0.1", "0.2", "0.3", "0.4", "0.5", "0.6", "0.7"}));
  EXPECT_EQ(values_of("energy.voltage=0.1..0.15*1.1"), (Values{"0.1", "0.11", "0.121", "0.1331", "0.14641"}));
}

TEST(AxisArgument, ReplacesAnAxisOfTheFile) {
  const std::string file = "[sweep.axes]\nmachine.nodes = [1, 2]\ncache.ways = [1, 2]\n";
  const std::vector<std::string> axes = {"machine.nodes=4,8,16"};
  const SweepTable table = read_sweep_table(config_of(file), axes);
  ASSERT_EQ(table.axes.size(), 2U);
  EXPECT_EQ(table.axes[0].steps.size(), 3U);
  EXPECT_EQ(table.axes[1].steps.size(), 2U);
  EXPECT_EQ(read_sweep_table(config_of(), axes).axes.size(), 1U) << "the file needs no [sweep]";
}

TEST(AxisArgument, RefusesWhatItCannotReplaceOrWouldHide) {
  const auto fault = [](const std::string& file, const std::vector<std::string>& axes,
                        const std::vector<std::string>& assignments = {}) {
    return test::user_error_of(
        [&] { static_cast<void>(read_sweep_table(config_of(file, assignments), axes)); });
  };
  EXPECT_NE(fault("", {"machine.nodes=1,2", "machine.nodes=4"}).find("another --axis"), std::string::npos);
  EXPECT_NE(fault("", {"machine.nodes=1,2"}, {"machine.nodes=3"}).find("no effect"), std::string::npos);
  EXPECT_NE(fault("", {"host_machine.memory_limit=1GiB,2GiB"}).find("cannot change"), std::string::npos);
  EXPECT_NE(fault("[[sweep.zip]]\nmachine.nodes = [1, 2]\ncache.ways = [1, 2]\n", {"cache.ways=1"})
                .find("test.toml:3: cache.ways"),
            std::string::npos);
}

}  // namespace
}  // namespace marti::studies
