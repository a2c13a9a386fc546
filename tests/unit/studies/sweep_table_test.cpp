// Reading [sweep]: axes, ranges, zipped keys, named points, and what is refused.
#include "studies/sweep/plan/sweep_table.h"

#include <gtest/gtest.h>

#include "studies/sweep/plan/sweep_points.h"
#include "tests/support/user_error.h"
#include "tests/unit/studies/sweep_tables.h"

namespace marti::studies {

using namespace sweep;

namespace {

using test::sweep_config;
using test::user_error_of;

SweepTable table_of(std::string_view text) { return read_sweep_table(sweep_config(text)); }

std::string table_error_of(std::string_view text) {
  return user_error_of([&] { (void)table_of(text); });
}

// The whole numbers of the first axis's first key.
std::vector<std::int64_t> numbers(const SweepTable& table) {
  std::vector<std::int64_t> found;
  for (const std::vector<sim::Setting>& step : table.axes.front().steps) {
    found.push_back(std::get<std::int64_t>(step.front().values.front()));
  }
  return found;
}

using Numbers = std::vector<std::int64_t>;

// A range means in a file what it means on the command line (axis_values_test.cpp).
TEST(SweepTable, AnAxisMayHoldRanges) {
  EXPECT_EQ(numbers(table_of("sweep.axes.cache.size = \"4 KiB..64 KiB*2\"")),
            (Numbers{4096, 8192, 16384, 32768, 65536}));
  EXPECT_EQ(numbers(table_of("sweep.axes.machine.nodes = \"1..3, 8, 16..20+2\"")),
            (Numbers{1, 2, 3, 8, 16, 18, 20}));
  EXPECT_EQ(numbers(table_of("sweep.axes.machine.nodes = [64, \"1..3\", 8]")), (Numbers{64, 1, 2, 3, 8}));
  EXPECT_EQ(numbers(table_of("[[sweep.zip]]\nmachine.nodes = \"1..16*4\"\ncache.ways = [1, 1, 1]\n")),
            (Numbers{1, 4, 16}));
}

TEST(SweepTable, AxesComeInTheOrderOfTheFileAfterTheNamedPoints) {
  const SweepTable table = table_of(
      "[sweep.axes]\n"
      "machine.nodes = [1, 2]\n"
      "cache.ways = [4]\n"
      "[[sweep.zip]]\n"
      "cache.line = [\"16 B\", \"32 B\"]\n"
      "memory.banks = [1, 2]\n"
      "[sweep.points.\"a b\"]\n"
      "cache.size = \"1 KiB\"\n"
      "[sweep.points.other]\n"
      "interconnect.width = 4\n"
      "cache.size = 64\n"
      "[sweep.base]\n"
      "machine.nodes = 1\n"
      "[sweep.compare]\n");
  const sim::Config config = sweep_config("");
  const auto& names = config.schema().names();
  ASSERT_EQ(table.axes.size(), 4U);
  EXPECT_EQ(SweepPoints(config, table).size(), 8U);
  EXPECT_EQ(table.axes[0].kind, SweepAxis::Kind::named);
  EXPECT_EQ(table.axes[0].names, (std::vector<std::string>{"a b", "other"}));
  ASSERT_EQ(table.axes[0].keys.size(), 2U);
  EXPECT_EQ(names[table.axes[0].keys[0]], "cache.size");
  EXPECT_EQ(table.axes[0].steps[0].size(), 1U);
  EXPECT_EQ(table.axes[0].steps[1].size(), 2U);
  EXPECT_EQ(table.axes[0].steps[1][0].line, 10);
  EXPECT_EQ(names[table.axes[1].keys[0]], "machine.nodes");
  EXPECT_EQ(names[table.axes[2].keys[0]], "cache.ways");
  EXPECT_EQ(table.axes[3].kind, SweepAxis::Kind::zip);
  ASSERT_EQ(table.axes[3].steps.size(), 2U);
  EXPECT_EQ(std::get<std::int64_t>(table.axes[3].steps[1][1].values[0]), 2);
  EXPECT_EQ(table.base.size(), 1U);
  ASSERT_TRUE(table.compare.has_value());
  EXPECT_TRUE(table.compare->empty());
}

TEST(SweepTable, WrongInputIsNamedWithFileLineAndKey) {
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"", "s.toml:1: sweep: there is nothing to sweep over"},
      {"\n[sweep]\nfilter = \"\"\n", "s.toml:2: sweep: there is nothing to sweep over"},
      {"[sweep.axes]\ncache.sise = [1]\n",
       "s.toml:2: cache.sise: unknown key in [sweep.axes] (did you mean \"cache.size\"?)"},
      {"[sweep.axes]\ncahce.size = [1]\n", "s.toml:2: cahce: unknown key in [sweep.axes]"},
      {"[sweep.axes]\ncache = [1]\n", "s.toml:2: cache: in [sweep.axes] is a section"},
      {"[sweep.axes]\ncache.size = []\n", "s.toml:2: cache.size: the list of its values is empty"},
      {"[sweep.axes]\ncache.size = \"4 KiB\"\n",
       "s.toml:2: cache.size: an axis is a list of values in brackets"},
      {"[sweep.axes]\ncache.size = [\"4 KB\"]\n", "s.toml:2: cache.size: "},
      {"[sweep.axes]\ncache.ways = [1,\n 2, 1]\n", "s.toml:3: cache.ways: lists 1 twice"},
      {"[sweep.axes]\ncache.replacement = [\"lur\"]\n",
       "s.toml:2: cache.replacement: must be lru, fifo, random, plru or srrip, not \"lur\" (did you mean "
       "\"lru\"?)"},
      {"[sweep.axes]\nhost_machine.memory_limit = [1]\n",
       "s.toml:2: host_machine.memory_limit: says nothing"},
      {"[sweep.axes]\nprices.node = [1]\n", "s.toml:2: prices.node: says nothing"},
      {"[sweep.axes]\nrecord.heat_maps = [true]\n", "s.toml:2: record.heat_maps: says nothing"},
      {"[sweep.axes]\nmachine.nodes = [1]\n[[sweep.zip]]\nmachine.nodes = [2]\n",
       "s.toml:4: machine.nodes: is swept over twice; the first time in line 2"},
      {"[sweep.axes]\n\"machine.nodes\" = [1]\nmachine.nodes = [2]\n",
       "s.toml:3: machine.nodes: is swept over twice; the first time in line 2"},
      {"[[sweep.zip]]\nmachine.nodes = [1, 2]\ncache.ways = [1]\n",
       "s.toml:3: cache.ways: has 1 values, but machine.nodes, which changes with it, has 2"},
      {"[[sweep.zip]]\n", "s.toml:1: sweep.zip: names no keys"},
      {"sweep.zip = 3\n", "s.toml:1: sweep.zip: must be a table, as [[sweep.zip]], not the integer 3"},
      {"[sweep.points]\na = 3\n", "s.toml:2: sweep.points.a: must be a table"},
      {"[sweep.points]\n", "s.toml:1: sweep.points: names no points"},
      {"[sweep.points.\"\"]\n", "s.toml:1: sweep.points: a point's name has 1 to 60 printable"},
      {"[sweep.axis]\n", "s.toml:1: sweep.axis: unknown key (did you mean \"sweep.axes\"?)"},
      {"[sweep]\ncache.size = [1]\n",
       "s.toml:2: sweep.cache: unknown key (the keys of axes belong in [sweep.axes])"},
      {"[sweep.axes]\nmachine.nodes = [1]\n[sweep.base]\n", "s.toml:3: sweep.base: gives nothing"},
      {"[sweep.axes]\nmachine.nodes = [1]\n[sweep.compare]\nmachine.nodes = [1]\n",
       "s.toml:4: machine.nodes: must be an integer, not a list"},
      {"[sweep.axes]\ncache.size = { from = 1, to = 2, steps = 2 }\n",
       "s.toml:2: cache.size: a range is a text, as \"4 KiB..64 KiB*2\" by factors"},
      {"[sweep.axes]\ncache.size = \"4 KiB..8 KiB\"\n", "s.toml:2: cache.size: the range lacks its step"},
      {"[sweep.axes]\ncache.ways = [1,\n\"2..1\"]\n", "s.toml:3: cache.ways: a range goes up"},
      {"[sweep.axes]\ncache.ways = [2, \"1..3\"]\n", "s.toml:2: cache.ways: lists 2 twice"},
      {"[sweep.axes]\ncache.ways = \"0..2*2\"\n", "s.toml:2: cache.ways: a range by factors begins above 0"},
      {"[sweep.axes]\nscene.source = \"teapot:1..3\"\n",
       "s.toml:2: scene.source: an axis is a list of values in brackets, not the text"},
      {"[sweep.axes]\nmachine.nodes = \"1..2000\"\nhost.latency_cycles = \"1..2000\"\n",
       "s.toml:3: sweep: the axes up to this line make 4000000 points; a sweep has at most 1000000"},
  };
  test::expect_messages(wrong, table_error_of);
  EXPECT_EQ(user_error_of([] {
              (void)read_sweep_table(sweep_config("[sweep.axes]\ncache.ways = [1]\n", {"cache.ways=2"}));
            }),
            "s.toml:2: cache.ways: is swept over, so that \"--set cache.ways=2\" would have no effect");
}

TEST(SweepKeys, UnknownPricesAndRecordsAreRefused) {
  EXPECT_EQ(
      user_error_of([] { (void)test::plan_of("[prices]\nnod = 1\n[sweep.axes]\nmachine.nodes = [1]\n"); }),
      "s.toml:2: prices.nod: unknown key (did you mean \"prices.node\"?); `marti config` lists all keys");
  EXPECT_EQ(user_error_of(
                [] { (void)test::plan_of("record.heat_maps = true\n[sweep.axes]\nmachine.nodes = [1]\n"); }),
            "s.toml:1: record.heat_maps: a sweep records nothing beside its counters; leave it out, or use "
            "`marti run`");
}

}  // namespace
}  // namespace marti::studies
