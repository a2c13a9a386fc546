// The store of a sweep: entered results stay, in any order of entering, and other files are refused.
#include "studies/sweep/store/sweep_store.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <random>

#include "sim/error.h"
#include "sim/files.h"
#include "studies/sweep/store/sweep_reader.h"
#include "studies/tables/sqlite_connection.h"
#include "studies/version.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"
#include "tests/unit/studies/sweep_parts.h"

namespace marti::studies {

using namespace sweep;
using namespace tables;

namespace {

namespace fs = std::filesystem;
using test::made_plan;
using test::made_row;
using test::TemporaryDirectory;
using test::user_error_of;

void fill(SweepStore& store, std::size_t machines) {
  for (std::size_t frame = 0; frame < 2; ++frame) {
    store.add_frame(frame, test::made_frame_row(frame), 17);
  }
  for (std::size_t machine = 0; machine < machines; ++machine) {
    store.add_result(machine, made_row(machine), 23);
  }
}

std::string whole_dump(const fs::path& file, std::size_t machines) {
  SweepStore store(file, made_plan(machines));
  fill(store, machines);
  store.close();
  return test::dump(file);
}

void execute(const fs::path& file, const std::string& sql) {
  SqliteConnection connection(file, SqliteConnection::Access::write);
  connection.execute(sql);
}

std::int64_t count(const fs::path& file, const std::string& query) {
  SqliteConnection connection(file, SqliteConnection::Access::read);
  return connection.value<std::int64_t>(query).value_or(0);
}

TEST(SweepStore, KnowsWhatIsDone) {
  const TemporaryDirectory directory;
  const fs::path file = directory.path() / "results.sqlite";
  {
    SweepStore store(file, made_plan(5));
    EXPECT_EQ(store.done(), std::vector<bool>(5));
    EXPECT_EQ(store.frames_done(), std::vector<bool>(2));
    store.add_frame(1, test::made_frame_row(1), 0);
    store.add_result(3, made_row(3), 0);
    store.add_result(0, made_row(0), 0);
  }
  SweepStore store(file, made_plan(5));
  EXPECT_EQ(store.done(), (std::vector{true, false, false, true, false}));
  EXPECT_EQ(store.frames_done(), (std::vector{false, true}));
  store.close();
  EXPECT_FALSE(fs::exists(file.string() + "-wal"));
  EXPECT_FALSE(fs::exists(file.string() + ".lock"));
}

// The tables are the same in whatever order and in however many runs a sweep was done.
class SweepStores : public testing::TestWithParam<std::uint64_t> {};

TEST_P(SweepStores, AreTheSameInWhateverOrderTheyWereFilled) {
  const TemporaryDirectory directory;
  constexpr std::size_t machines = 9;
  test::Random random(GetParam());
  std::vector<std::size_t> order(machines + 2);
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), random);
  const fs::path file = directory.path() / "b.sqlite";
  auto store = std::make_unique<SweepStore>(file, made_plan(machines));
  for (const std::size_t next : order) {
    if (random() % 4 == 0) {
      store.reset();
      store = std::make_unique<SweepStore>(file, made_plan(machines));
    }
    if (next < machines) {
      store->add_result(next, made_row(next), static_cast<std::int64_t>(random() >> 1U));
    } else {
      store->add_frame(next - machines, test::made_frame_row(next - machines), 1);
    }
  }
  store->close();
  EXPECT_EQ(test::dump(file), whole_dump(directory.path() / "a.sqlite", machines));
}
INSTANTIATE_TEST_SUITE_P(Seeds, SweepStores, testing::Range<std::uint64_t>(1, 9));

TEST(SweepStore, AnotherPlanAddsPointsAndKeepsResults) {
  const TemporaryDirectory directory;
  const fs::path file = directory.path() / "results.sqlite";
  whole_dump(file, 6);
  {
    SweepStore store(file, made_plan(6, 3));
    EXPECT_EQ(store.done(), (std::vector{true, true, true, false, false, false}));
    store.add_result(5, made_row(8), 0);
    store.close();
  }
  EXPECT_EQ(count(file, "SELECT COUNT(*) FROM points"), 6);
  EXPECT_EQ(count(file, "SELECT COUNT(*) FROM machines"), 9);
  EXPECT_EQ(count(file, "SELECT COUNT(*) FROM results"), 7);
  SweepStore store(file, made_plan(6));
  EXPECT_EQ(store.done(), std::vector<bool>(6, true));
}

TEST(SweepStore, SettingsAndHistogramsAreThere) {
  const TemporaryDirectory directory;
  const fs::path file = directory.path() / "results.sqlite";
  whole_dump(file, 3);
  EXPECT_EQ(count(file, "SELECT COUNT(*) FROM machine_settings WHERE machine = 2"), 72);
  EXPECT_EQ(count(file, "SELECT COUNT(*) FROM frame_settings"), 4);
  EXPECT_EQ(count(file,
                  "SELECT value FROM machine_settings WHERE machine = 3 AND key = 'machine.key0' "
                  "AND value = '2'"),
            0)
      << "the value is a text";
  std::int64_t waits = 0;
  for (const std::string& histogram : made_row(1).histograms) {
    for (const auto& bucket : nlohmann::json::parse(histogram.empty() ? "[]" : histogram)) {
      waits += bucket.at(2).get<std::int64_t>();
    }
  }
  EXPECT_EQ(count(file, "SELECT SUM(count) FROM histograms WHERE machine = 2"), waits);
  EXPECT_EQ(count(file, "SELECT COUNT(*) FROM histograms WHERE highest IS NULL OR what IS NULL"), 0);
  EXPECT_EQ(count(file, "SELECT COUNT(*) FROM host_machines WHERE cpu_nanoseconds = 23"), 3);
  // Every column of every table that is not of the host is described, and no other.
  EXPECT_EQ(
      count(file,
            "SELECT COUNT(*) FROM (SELECT m.name AS t, p.name AS c FROM sqlite_schema m, "
            "pragma_table_info(m.name) p WHERE m.type IN ('table', 'view') AND m.name NOT LIKE 'host%' AND "
            "m.name <> 'columns' EXCEPT SELECT \"table\", name FROM columns)"),
      0);
  EXPECT_EQ(
      count(file,
            "SELECT COUNT(*) FROM (SELECT \"table\", name FROM columns EXCEPT SELECT m.name, p.name FROM "
            "sqlite_schema m, pragma_table_info(m.name) p)"),
      0);
}

TEST(SweepStore, TheSameMachineMustGiveTheSameResult) {
  const TemporaryDirectory directory;
  const fs::path file = directory.path() / "results.sqlite";
  SweepStore store(file, made_plan(2));
  fill(store, 2);
  EXPECT_NO_THROW(store.add_result(1, made_row(1), 5));
  SweepRow other = made_row(1);
  other.counters[0] = *other.counters[0] + 1;
  EXPECT_THROW(store.add_result(1, other, 5), sim::InternalError);
  other = made_row(1);
  other.histograms[1] = "[[0,0,1]]";
  EXPECT_THROW(store.add_result(1, other, 5), sim::InternalError);
  FrameRow frame = test::made_frame_row(0);
  frame.notes.pop_back();
  EXPECT_THROW(store.add_frame(0, frame, 5), sim::InternalError);
}

TEST(SweepStore, OnlyOneProcessWritesIt) {
  const TemporaryDirectory directory;
  const fs::path file = directory.path() / "results.sqlite";
  SweepStore store(file, made_plan(2));
  const std::string message = user_error_of([&] { SweepStore(file, made_plan(2)); });
  EXPECT_NE(message.find("is writing it"), std::string::npos) << message;
  EXPECT_NE(message.find("process " + std::to_string(getpid())), std::string::npos) << message;
  EXPECT_NO_THROW(fill(store, 2));
}

TEST(SweepStore, RefusesWhatIsNoStore) {
  const TemporaryDirectory directory;
  const fs::path file = directory.path() / "results.sqlite";
  const auto refused = [&](const char* reason) {
    const std::string message = user_error_of([&] { SweepStore(file, made_plan(2)); });
    EXPECT_NE(message.find(reason), std::string::npos) << message;
    EXPECT_TRUE(message.starts_with(file.string())) << message;
  };
  std::ofstream(file) << "This is no database, however long it may be: " << std::string(5000, 'x');
  refused("no SQLite database");
  std::ofstream(file) << "short";
  refused("no SQLite database");
  fs::remove(file);
  execute(file, "CREATE TABLE t (a); INSERT INTO t VALUES (1);");
  refused("not the store of a sweep");
  fs::remove(file);
  fs::create_directory(file);
  refused("not a regular file");
  fs::remove(file);
  std::ofstream(file).close();  // a store that was never written
  EXPECT_NO_THROW(whole_dump(file, 2));
}

TEST(SweepStore, RefusesOtherFormatsAndVersions) {
  const TemporaryDirectory directory;
  const fs::path file = directory.path() / "results.sqlite";
  whole_dump(file, 2);
  const auto refused_after = [&](const std::string& sql, const std::string& reason) {
    const fs::path other = directory.path() / "other.sqlite";
    fs::copy_file(file, other, fs::copy_options::overwrite_existing);
    execute(other, sql);
    const std::string before = sim::read_file(other, std::int64_t{1} << 24U);
    const std::string message = user_error_of([&] { SweepStore(other, made_plan(2)); });
    EXPECT_NE(message.find(reason), std::string::npos) << message;
    EXPECT_TRUE(sim::read_file(other, std::int64_t{1} << 24U) == before) << sql << ": the store was touched";
  };
  refused_after("PRAGMA application_id = 7", "not the store of a sweep");
  refused_after("PRAGMA user_version = 8", "format 8");
  refused_after("PRAGMA user_version = 3", "format 3, but this program reads format 7");
  refused_after("UPDATE store SET value = '0.0.1' WHERE what = 'version'", "version 0.0.1");
  refused_after("UPDATE store SET value = '0.0.1' WHERE what = 'version'", std::string(version));
  refused_after("UPDATE store SET value = 'marti 0.1.0 0' WHERE what = 'build'", "another build");
  refused_after("ALTER TABLE results RENAME COLUMN hits TO found", "another build");
  refused_after("DROP TABLE results", "another build");
  refused_after("DROP TABLE settings", "no such table");
}

TEST(SweepStore, RefusesADamagedFile) {
  const TemporaryDirectory directory;
  const fs::path file = directory.path() / "results.sqlite";
  whole_dump(file, 40);
  const std::uintmax_t size = fs::file_size(file);
  for (const std::uintmax_t left : {size - 1, size / 2, std::uintmax_t{4096}, std::uintmax_t{100}}) {
    const fs::path cut = directory.path() / "cut.sqlite";
    fs::copy_file(file, cut, fs::copy_options::overwrite_existing);
    fs::resize_file(cut, left);
    for (const std::string& message : {user_error_of([&] { SweepStore(cut, made_plan(40)); }),
                                       user_error_of([&] { (void)SweepReader(cut).points(); })}) {
      EXPECT_NE(message.find("is damaged"), std::string::npos) << left << " " << message;
    }
    EXPECT_EQ(fs::file_size(cut), left) << "it was touched";
  }
}

TEST(SweepStore, RefusesADirectoryThatIsNotThere) {
  const TemporaryDirectory directory;
  const std::string message =
      user_error_of([&] { SweepStore(directory.path() / "none" / "results.sqlite", made_plan(2)); });
  EXPECT_NE(message.find("No such file or directory"), std::string::npos) << message;
}

TEST(SweepStore, AnEmptyPlanIsNoTrouble) {
  const TemporaryDirectory directory;
  SweepStore store(directory.path() / "results.sqlite", {});
  EXPECT_TRUE(store.done().empty());
  EXPECT_TRUE(store.frames_done().empty());
  EXPECT_NO_THROW(store.close());
}

}  // namespace
}  // namespace marti::studies
