// The catalogue of figures: formulas, and the parts of the lost speed-up.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "studies/figures/derived_figures.h"
#include "studies/run/frame_figures.h"
#include "studies/sweep/plan/sweep_keys.h"
#include "studies/tables/sqlite_connection.h"
#include "tests/contract/random_cases.h"
#include "tests/support/long_tests.h"
#include "tests/support/random_flow.h"
#include "tests/support/random_machine.h"
#include "tests/support/user_error.h"

namespace marti::studies {

using namespace figures;
using namespace run;
using namespace sweep;
using namespace tables;

namespace {

using processors::machine::MachineConfig;
using processors::replay::MachineResult;

TEST(Formulas, AreWrittenAsTheyAreComputed) {
  const Formula a("a");
  const Formula b("b", Whose::base);
  EXPECT_EQ((a / (a + b)).text(), "a / (a + b of the base)");
  EXPECT_EQ((a - (b - a)).text(), "a - (b of the base - a)");
  EXPECT_EQ((a / (b / a)).text(), "a / (b of the base / a)");
  EXPECT_EQ((a * b / a).text(), "a * b of the base / a");
  EXPECT_EQ(least(Formula(1.0), a / Formula("b")).text(), "min(1, a / b)");
  EXPECT_TRUE((a + b).is_relative());
  EXPECT_FALSE(least(Formula(1.0), a).is_relative());
}

TEST(Formulas, HaveNoValueWhereAPartHasNone) {
  const auto figure = [](std::string_view name, Whose whose) -> std::optional<double> {
    return whose == Whose::own && name == "three" ? std::optional(3.0)
           : name == "zero"                       ? std::optional(0.0)
                                                  : std::nullopt;
  };
  const Formula three("three");
  EXPECT_EQ((three / three + three).value(figure), 4.0);
  EXPECT_EQ(least(Formula(1.0), three).value(figure), 1.0);
  EXPECT_FALSE((three / Formula("zero")).value(figure));
  EXPECT_FALSE((three + Formula("three", Whose::base)).value(figure));
}

// SQLite computes the formulas of a store's summary: with equal bits, and with no value in the same places.
TEST(Formulas, AreComputedBySqliteWithEqualBits) {
  SqliteConnection connection(":memory:", SqliteConnection::Access::write);
  test::Random random(11);
  std::string columns;
  for (const FigureEntry& entry : counted_figures()) {
    columns += (columns.empty() ? "" : ", ") + sql_name(entry.name) + " INTEGER";
  }
  for (const std::string table : {"r", "b", "c"}) {
    connection.execute("CREATE TABLE " + table + " (" + columns + ")");
  }
  for (int round = 0; round < 10; ++round) {
    std::array<Counts, 3> rows;
    constexpr std::array<const char*, 3> tables = {"r", "b", "c"};
    for (std::size_t row = 0; row < rows.size(); ++row) {
      for (std::size_t i = 0; i < counted_figures().size(); ++i) {
        const std::uint64_t kind = random() % 8;
        const auto large = static_cast<Count>(random() >> (1 + random() % 60)) << (kind == 2 ? 31U : 0U);
        rows[row].push_back(kind == 0 ? std::nullopt : std::optional(kind == 1 ? 0 : rounded(large)));
      }
      connection.execute(std::string("DELETE FROM ") + tables[row]);
      SqliteStatement(connection, insert_sql(tables[row], counted_figures().size()))
          .run({rows[row].begin(), rows[row].end()});
    }
    for (const FigureEntry& entry : derived_figures()) {
      const std::optional<double> here = figure_of({&rows[0], &rows[1], &rows[2]}, entry.name);
      SqliteStatement there(connection, "SELECT " + entry.formula->sql() + " FROM r, b, c");
      ASSERT_TRUE(there.next());
      const Cell cell = there.cell(0);
      ASSERT_EQ(std::holds_alternative<double>(cell), here.has_value()) << entry.name;
      if (here) {
        EXPECT_EQ(std::get<double>(cell), *here) << entry.name;
      }
    }
  }
}

TEST(Figures, AreDescribedOnce) {
  std::set<std::string> names;
  for (const auto& entries : {counted_figures(), derived_figures()}) {
    for (const FigureEntry& entry : entries) {
      EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
      EXPECT_EQ(entry.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz_0123456789"), std::string::npos);
      EXPECT_FALSE(entry.description.empty() || entry.unit.empty()) << entry.name;
      EXPECT_EQ(entry.formula.has_value(), entry.merge == Merge::ratio) << entry.name;
    }
  }
  EXPECT_EQ(counted_figures()[0].name, "end");
  EXPECT_EQ(figure_named("hits").better, Better::higher);
  EXPECT_EQ(figure_named("end").better, Better::lower);
  EXPECT_NE(test::user_error_of([] { (void)figure_named("speedup"); }).find("\"speed_up\""),
            std::string::npos);
}

// A sweep has columns for its axes beside those of figures.
TEST(Figures, HaveOtherNamesThanKeysAsColumns) {
  std::set<std::string, std::less<>> figures;
  for (const auto& entries : {counted_figures(), derived_figures(), frame_figures()}) {
    for (const FigureEntry& entry : entries) {
      figures.insert(entry.name);
    }
  }
  const sim::Schema schema = sweep_schema();
  for (const sim::Key& key : schema.keys()) {
    std::string column = key.name;
    std::replace(column.begin(), column.end(), '.', '_');
    EXPECT_FALSE(figures.contains(column)) << key.name;
  }
}

struct Pair {
  MachineResult one;
  MachineResult all;
  Counts one_counts;
  Counts all_counts;

  [[nodiscard]] double figure(const std::string& name) const {
    return figure_of({&all_counts, &one_counts}, name).value();
  }
  /// In ticks, rounded: exact as long as times are below 2^52.
  [[nodiscard]] sim::Ticks lost(std::string_view part) const {
    return std::llround(figure("lost_" + std::string(part)) * static_cast<double>(all.end));
  }
  [[nodiscard]] sim::Ticks lost() const {
    return all.end * static_cast<sim::Ticks>(all.nodes.size()) - one.end;
  }
};

Pair time_both(const processors::program::WorkLog& log, const MachineConfig& machine) {
  const MachineConfig one = processors::machine::one_node_of(machine);
  Pair pair;
  pair.all = processors::replay::replay(log, machine);
  pair.all_counts = counts_of(machine, pair.all);
  pair.one = processors::replay::replay(log, one);
  pair.one_counts = counts_of(one, pair.one);
  return pair;
}

// A machine of any kind and a log. The steps that it takes do not depend on the number of nodes. Every third
// machine waits for memory only, so that what all caches hold together shows.
test::TimedCase any_machine(test::Random& random, std::uint64_t number) {
  constexpr std::array makers = {test::image_case, test::contexts_case, test::pipeline_case,
                                 test::space_case};
  test::TimedCase made = makers.at(number % makers.size())(random);
  made.log = test::random_ray_trees(random, 8, 6, 4, 2);
  MachineConfig& machine = made.machine;
  machine.prefetch.children = machine.prefetch.children && made.log.traversal < accel::Traversal::grid;
  if (number % 3 == 0) {
    machine.operations = {0, 0, 0, 0, 0, 0, 0, 0};
    machine.host.latency_cycles = 0;
    machine.host.occupancy_cycles = 0;
    machine.packets = {1, 1, processors::machine::PacketOrder::hilbert};
    machine.cache.cache.size *= 8;
  }
  return made;
}

// Whatever the machine, that which a speed-up is measured against takes the same steps, and more nodes are no
// more than so many times as fast unless the cause that is named took them less time.
TEST(SpeedUp, IsAgainstTheSameWorkOnOneNode) {
  const std::map<std::string_view, std::vector<std::string>> times_of = {
      {"extra_misses", {"time_cache_access", "time_transfer", "time_bank_access"}},
      {"contention", {"time_interconnect_wait", "time_bank_wait"}},
      {"overhead", {"time_dispatch_wait", "time_queue_full_wait", "time_switching"}}};
  const std::uint64_t machines = test::stride(2000, 20'000);
  int larger = 0;
  for (std::uint64_t seed = 1; seed <= machines; ++seed) {
    test::Random random(seed);
    const auto [log, machine, options] = any_machine(random, seed);
    const Pair pair = time_both(log, machine);
    const processors::cost::StepCounts one = pair.one.steps();
    sim::for_each_counter(pair.all.steps(), [&](const auto& counter, std::int64_t value) {
      EXPECT_EQ(value, counter.value(one)) << counter.name << ", seed " << seed;
    });
    if (pair.all.end == 0) {
      continue;  // nothing takes time
    }
    const double nodes = machine.all_nodes();
    const double speed_up = pair.figure("speed_up");
    EXPECT_TRUE(nodes > 1.0 || speed_up == 1.0) << speed_up << ", seed " << seed;
    if (speed_up > nodes) {
      ++larger;
      const auto lost = [&pair](std::string_view part) { return pair.lost(part); };
      const std::string_view cause = *std::ranges::min_element(loss_names, {}, lost);
      ASSERT_TRUE(times_of.contains(cause)) << cause << ", seed " << seed;
      EXPECT_TRUE(std::ranges::any_of(times_of.at(cause),
                                      [&](const std::string& time) {
                                        return figure_of({&pair.all_counts}, time).value() <
                                               figure_of({&pair.one_counts}, time).value();
                                      }))
          << cause << ", seed " << seed;
    }
  }
  EXPECT_GT(larger, 0);
}

// What links and data buses do adds up to all of their time.
TEST(Bandwidth, PartsOfTheTimeAddUpForEveryMachine) {
  std::map<std::string, int> seen;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    test::Random random(seed);
    const auto [log, machine, options] = any_machine(random, seed);
    const MachineResult result = processors::replay::replay(log, machine);
    const Counts counts = counts_of(machine, result);
    for (const std::string whose : {"interconnect", "network", "dram"}) {
      double all = 0.0;
      for (const FigureEntry& entry : derived_figures()) {
        if (entry.name.starts_with(whose + "_share_")) {
          const std::optional<double> share = figure_of({&counts}, entry.name);
          ASSERT_GE(share.value_or(0.0), 0.0) << entry.name << ", seed " << seed;
          all += share.value_or(0.0);
        }
      }
      if (figure_of({&counts}, whose + "_share_no_request")) {
        ++seen[whose];
        ASSERT_NEAR(all, 1.0, 1e-9) << whose << ", seed " << seed;
      }
    }
  }
  EXPECT_EQ(seen.size(), 3U);
}

TEST(LostSpeedUp, AddsUpForEveryMachine) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    test::Random random(seed);
    const processors::program::WorkLog log = test::random_tree_log(random, 9, 7);
    MachineConfig machine = test::random_machine(random);
    // A bus that is not granted first come first served has no tree that is built and shared.
    if (machine.placement == processors::machine::Placement::shared &&
        machine.interconnect.arbitration == memory::Arbitration::fifo && random() % 2 == 0) {
      machine.build = test::random_build(random);
    }
    const Pair pair = time_both(log, machine);
    sim::Ticks sum = 0;
    for (const std::string_view part : loss_names) {
      sum += pair.lost(part);
    }
    EXPECT_EQ(sum, pair.lost());
    EXPECT_GE(pair.lost("idle"), 0);
    const double nodes = machine.all_nodes();
    EXPECT_DOUBLE_EQ(pair.figure("speed_up"),
                     static_cast<double>(pair.one.end) / static_cast<double>(pair.all.end));
    EXPECT_DOUBLE_EQ(pair.figure("efficiency"), pair.figure("speed_up") / nodes);
    if (nodes > 1.0) {
      EXPECT_NEAR(pair.figure("serial_fraction"),
                  (1.0 / pair.figure("speed_up") - 1.0 / nodes) / (1.0 - 1.0 / nodes), 1e-12);
    }
  }
}

TEST(LostSpeedUp, IsNoneOfOneNode) {
  test::Random random(3);
  const processors::program::WorkLog log = test::random_log(random, 6, 6);
  MachineConfig machine = test::random_machine(random);
  machine.clusters = 1;
  machine.nodes = 1;
  const Pair pair = time_both(log, machine);
  for (const std::string_view part : loss_names) {
    EXPECT_EQ(pair.lost(part), 0) << part;
  }
}

// A machine with only one cause of loss has only that part.
TEST(LostSpeedUp, HasTheCauseItSays) {
  test::Random random(4);
  const processors::program::WorkLog log = test::random_log(random, 16, 16);
  MachineConfig machine = test::random_machine(random);
  machine.clusters = 1;
  machine.nodes = 8;
  machine.placement = processors::machine::Placement::shared;
  machine.cache.organisation = processors::machine::CacheOrganisation::none;
  machine.interconnect.kind = memory::InterconnectKind::ideal;
  machine.interconnect.latency_cycles = 7;
  machine.operations = {1, 2, 3, 4, 1, 1, 1, 1};
  machine.write_buffer = 4096;
  machine.host = {processors::machine::Assignment::interleaved, sim::Clock::from_period(10), 0, 0};
  machine.packets = {1, 1, processors::machine::PacketOrder::scanline};
  Pair pair = time_both(log, machine);
  EXPECT_EQ(pair.lost("extra_misses"), 0) << "without caches nobody misses more";
  EXPECT_EQ(pair.lost("contention"), 0) << "nothing is shared";
  EXPECT_EQ(pair.lost("overhead"), 0);
  EXPECT_EQ(pair.lost("idle"), 0);
  EXPECT_GT(pair.lost("imbalance"), 0);
  EXPECT_EQ(pair.lost("imbalance"), pair.lost());

  machine.interconnect.kind = memory::InterconnectKind::bus;
  EXPECT_GT(time_both(log, machine).lost("contention"), 0);

  machine.interconnect.kind = memory::InterconnectKind::ideal;
  machine.cache.organisation = processors::machine::CacheOrganisation::unified;
  machine.cache.cache = {.size = 1U << 20U, .line = 64, .ways = 0};
  pair = time_both(log, machine);
  EXPECT_GT(pair.lost("extra_misses"), 0) << "every cache is filled anew";
  EXPECT_EQ(pair.lost("contention"), 0);

  machine.packets = {16, 16, processors::machine::PacketOrder::scanline};
  pair = time_both(log, machine);
  EXPECT_EQ(pair.lost("idle"), pair.lost()) << "one packet, so seven nodes never have work";
  EXPECT_EQ(pair.lost(), 7 * pair.all.end);
}

}  // namespace
}  // namespace marti::studies
