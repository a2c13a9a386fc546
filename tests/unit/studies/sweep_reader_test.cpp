// What a reader sees of a store.
#include "studies/sweep/store/sweep_reader.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <fstream>

#include "sim/error.h"
#include "studies/sweep/store/axis_effects.h"
#include "studies/sweep/store/sweep_store.h"
#include "studies/version.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"
#include "tests/unit/studies/sweep_parts.h"

namespace marti::studies {

using namespace figures;
using namespace sweep;
using namespace tables;

namespace {

namespace fs = std::filesystem;
using test::made_plan;
using test::made_row;
using test::TemporaryDirectory;
using test::user_error_of;

constexpr std::size_t machines = 7;

double real(const Cell& cell) {
  if (const auto* integer = std::get_if<std::int64_t>(&cell)) {
    return static_cast<double>(*integer);
  }
  const auto* value = std::get_if<double>(&cell);
  return value == nullptr ? NAN : *value;
}

std::optional<Count> counter(std::size_t machine, std::string_view name) {
  for (std::size_t i = 0; i < counted_figures().size(); ++i) {
    if (counted_figures()[i].name == name) {
      return made_row(machine).counters[i];
    }
  }
  return std::nullopt;
}

TEST(SweepReader, ReadsBackWhatWasWritten) {
  const TemporaryDirectory directory;
  const fs::path file = directory.path() / "results.sqlite";
  const SweepPlan plan = made_plan(machines);
  SweepStore store(file, plan);
  store.add_frame(0, test::made_frame_row(0), 1);
  for (std::size_t machine = 0; machine < machines; machine += 2) {
    store.add_result(machine, made_row(machine), 1);
  }
  const SweepReader reader(file);  // while the store is open
  store.add_result(1, made_row(1), 1);
  EXPECT_EQ(reader.version(), version);
  EXPECT_EQ(reader.axes(), plan.axes);
  EXPECT_EQ(reader.compare(), 1);
  const std::vector<StoredPoint> points = reader.points();
  ASSERT_EQ(points.size(), machines);
  for (std::size_t i = 0; i < machines; ++i) {
    EXPECT_EQ(points[i].ordinal, static_cast<std::int64_t>(i));
    EXPECT_EQ(points[i].cost, plan.points[i].cost);
    EXPECT_EQ(points[i].done, i % 2 == 0) << "a reader sees the store as it was opened";
    EXPECT_EQ(points[i].values[1], Cell(static_cast<std::int64_t>(i)));
    EXPECT_EQ(points[i].values[3], Cell(std::get<std::string>(plan.points[i].values[3])));
    EXPECT_EQ(points[i].values[4], Cell(std::int64_t{i % 2 == 0 ? 1 : 0}));
    const std::optional<SweepRow> row = reader.read_result(points[i].machine);
    ASSERT_EQ(row.has_value(), i % 2 == 0);
    EXPECT_TRUE(!row || *row == made_row(i));
    EXPECT_EQ(reader.read_frame(points[i].machine).has_value(), i % 2 == 0);
    EXPECT_EQ(reader.settings(points[i].machine).size(), 74U);
  }
  EXPECT_EQ(*reader.read_frame(1), test::made_frame_row(0));
  EXPECT_FALSE(reader.read_result(1000).has_value());
  EXPECT_TRUE(SweepReader(file).read_result(2).has_value());
}

TEST(SweepReader, DerivesRatios) {
  const TemporaryDirectory directory;
  const fs::path file = directory.path() / "results.sqlite";
  test::write_store(file, made_plan(machines), made_row);
  const SweepReader reader(file);
  const std::vector<std::string> names = {"speed_up", "times_faster", "hit_ratio", "cache.size",
                                          "bank_accesses"};
  std::size_t seen = 0;
  std::size_t ratios = 0;
  reader.for_each_point(names, [&](const StoredPoint& point, std::span<const Cell> figures) {
    const auto i = static_cast<std::size_t>(point.ordinal);
    const double first = static_cast<double>(*counter(0, "end"));
    EXPECT_DOUBLE_EQ(real(figures[0]), first / static_cast<double>(*counter(i, "end")));
    EXPECT_DOUBLE_EQ(real(figures[1]), real(figures[0]));
    const auto hits = counter(i, "hits");
    const auto misses = counter(i, "misses");
    if (hits && misses) {
      const double expected = static_cast<double>(*hits) / static_cast<double>(*hits + *misses);
      EXPECT_NEAR(real(figures[2]), expected, 1e-12 * expected);
      ++ratios;
    }
    EXPECT_EQ(real(figures[3]), 0.5 * static_cast<double>(i));
    const auto accesses = counter(i, "bank_accesses");
    EXPECT_EQ(figures[4], accesses ? Cell(*accesses) : Cell());
    ++seen;
  });
  EXPECT_EQ(seen, machines);
  EXPECT_GT(ratios, 0U);
  const std::vector<std::string> wrong = {"sped_up"};
  const std::string message =
      user_error_of([&] { reader.for_each_point(wrong, [](const StoredPoint&, std::span<const Cell>) {}); });
  EXPECT_NE(message.find("speed_up"), std::string::npos) << message;
  // Every figure that is named can be asked for.
  const std::vector<std::string> all = reader.figures();
  EXPECT_NO_THROW(reader.for_each_point(all, [](const StoredPoint&, std::span<const Cell>) {}));
}

TEST(SweepReader, PointsOfOtherSeedsAreNoise) {
  const TemporaryDirectory directory;
  const fs::path file = directory.path() / "results.sqlite";
  test::write_store_of_seeds(file, {1000, 1010, 1005, 530, 500, 510});
  const SweepReader reader(file);
  EXPECT_NEAR(reader.noise().band, 0.06, 1e-12) << "of two nodes, which differ most";
  EXPECT_EQ(reader.noise().cause(), "another seed of the image");
  const AxisEffects effects = axis_effects(reader);
  ASSERT_EQ(effects.axes.size(), 2U);
  EXPECT_EQ(effects_text(effects),
            "machine.nodes 1.96 times, one axis no more than another seed of the image, 6.00 %");
  const fs::path other = directory.path() / "other" / "results.sqlite";
  test::write_store(other, made_plan(machines), made_row);
  EXPECT_EQ(SweepReader(other).noise_of_seeds().band, 0.0) << "the seed is no axis";
}

TEST(SweepReader, RefusesWhatIsNoStore) {
  const TemporaryDirectory directory;
  const fs::path file = directory.path() / "results.sqlite";
  EXPECT_NE(user_error_of([&] { SweepReader{file}; }).find("no such file"), std::string::npos);
  EXPECT_FALSE(fs::exists(file));
  std::ofstream(file) << "not a database";
  EXPECT_NE(user_error_of([&] { SweepReader{file}; }).find("no SQLite database"), std::string::npos);
}

TEST(SweepReader, AStoreCanBeReadWhereNothingMayBeWritten) {
  const TemporaryDirectory directory;
  const fs::path place = directory.path() / "a b?";
  fs::create_directory(place);
  const fs::path file = place / "results.sqlite";
  test::write_store(file, made_plan(2), made_row);
  fs::permissions(file, fs::perms::owner_read);
  fs::permissions(place, fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_EQ(SweepReader(file).points().size(), 2U);
  EXPECT_EQ(std::distance(fs::directory_iterator(place), fs::directory_iterator()), 1);
  fs::permissions(place, fs::perms::owner_all);
}

}  // namespace
}  // namespace marti::studies
