// A damaged store: bytes that have changed on a disk, values that somebody has
// changed, and the lock beside it.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "sim/files.h"
#include "studies/sweep/store/store_parts.h"
#include "studies/sweep/store/sweep_reader.h"
#include "studies/sweep/store/sweep_store.h"
#include "studies/tables/sqlite_connection.h"
#include "tests/support/long_tests.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"
#include "tests/unit/studies/sweep_parts.h"

namespace marti::studies {

using namespace sweep;
using namespace tables;

namespace {

namespace fs = std::filesystem;
using test::made_plan;
using test::TemporaryDirectory;
using test::user_error_of;

constexpr std::size_t damaged_machines = 2;

void add_cell(std::string& text, const Cell& cell) {
  text += std::to_string(cell.index());
  if (const auto* integer = std::get_if<std::int64_t>(&cell)) {
    text += std::to_string(*integer);
  } else if (const auto* real = std::get_if<double>(&cell)) {
    text += std::to_string(*real);
  } else if (const auto* string = std::get_if<std::string>(&cell)) {
    text += *string;
  }
  text += ';';
}

void add_counters(std::string& text, const figures::Counts& counters) {
  for (const std::optional<figures::Count>& counter : counters) {
    add_cell(text, counter);
  }
}

// Everything that reports and comparisons read.
std::string figures_of(const fs::path& file) {
  const SweepReader reader(file);
  std::string text = reader.version();
  const std::vector<std::string> names = reader.figures();
  for (const std::string& name : names) {
    text += name + ";";
  }
  add_cell(text, reader.compare() ? Cell(*reader.compare()) : Cell());
  reader.for_each_point(names, [&](const StoredPoint& point, std::span<const Cell> figures) {
    text += point.done ? "done;" : "left;";
    for (const std::vector<Cell>& cells : {point.values, std::vector<Cell>(figures.begin(), figures.end())}) {
      for (const Cell& cell : cells) {
        add_cell(text, cell);
      }
    }
    if (const auto row = reader.read_result(point.machine)) {
      add_counters(text, row->counters);
      for (const std::string& histogram : row->histograms) {
        text += histogram + ";";
      }
    }
    if (const auto frame = reader.read_frame(point.machine)) {
      add_counters(text, frame->counters);
      for (const std::string& part : {frame->scene, frame->scene_hash, frame->image_hash, frame->hit_hash}) {
        text += part + ";";
      }
      for (const std::string& note : frame->notes) {
        text += note + ";";
      }
    }
    for (const auto& [key, value] : reader.settings(point.machine)) {
      text += key + "=" + value + ";";
    }
  });
  DoneKeys done;
  done.add(file);
  for (const std::set<std::string>& keys : {done.machines, done.frames}) {
    for (const std::string& key : keys) {
      text += key + ";";
    }
  }
  return text;
}

class DamagedStore : public testing::Test {
 protected:
  DamagedStore() {
    test::write_store(file_, made_plan(damaged_machines), test::plain_row);
    bytes_ = sim::read_file(file_, std::int64_t{1} << 30);
  }

  // Both a reader and a sweep that goes on refuse it.
  void expect_refused(const std::string& change, const std::string& what) {
    sim::write_file(file_, bytes_);
    {
      SqliteConnection connection(file_, SqliteConnection::Access::write);
      connection.execute(change);
    }
    for (const std::string& message : {user_error_of([&] { (void)figures_of(file_); }), user_error_of([&] {
                                         SweepStore(file_, made_plan(damaged_machines));
                                       })}) {
      EXPECT_TRUE(message.starts_with(file_.string())) << change << "\n" << message;
      EXPECT_NE(message.find(what), std::string::npos) << change << "\n" << message;
    }
  }

  TemporaryDirectory directory_;
  fs::path file_ = directory_.path() / "results.sqlite";
  std::string bytes_;
};

TEST_F(DamagedStore, AChangedByteIsRefusedOrWithoutConsequence) {
  const std::string expected = figures_of(file_);
  std::string damaged = bytes_;
  std::size_t refused = 0;
  // A prime: all places within a page have their turn.
  for (std::size_t i = 0; i < bytes_.size(); i += i < 100 ? 3 : test::stride(7001, 61)) {
    for (const unsigned flipped : {1U << (i % 8), 0xffU}) {
      damaged[i] = static_cast<char>(static_cast<unsigned char>(bytes_[i]) ^ flipped);
      sim::write_file(file_, damaged);
      // Anything but a UserError ends the test.
      std::string found;
      const std::string message = user_error_of([&] { found = figures_of(file_); });
      if (message == "no UserError") {
        EXPECT_EQ(found, expected) << "byte " << i << " ^ " << flipped;
      } else {
        ++refused;
        EXPECT_TRUE(message.starts_with(file_.string())) << message;
      }
      if (flipped == 0xffU) {
        continue;
      }
      const std::string going_on = user_error_of([&] {
        test::write_store(file_, made_plan(damaged_machines), test::plain_row);
        found = figures_of(file_);
      });
      EXPECT_TRUE(going_on != "no UserError" || found == expected) << "byte " << i << " ^ " << flipped;
    }
    damaged[i] = bytes_[i];
  }
  EXPECT_GT(refused, 30U);
}

TEST_F(DamagedStore, ChangedValuesAreRefused) {
  for (const char* value : {"NULL", "'soon'", "1.5", "hits + 1", "'9e999'"}) {
    expect_refused(std::string("UPDATE results SET hits = ") + value + " WHERE machine = 2",
                   "row 2 of its table results");
  }
  for (const char* change : {"UPDATE results SET checksum = checksum + 1 WHERE machine = 2",
                             "UPDATE results SET checksum = NULL WHERE machine = 2",
                             "UPDATE results SET bank_wait_histogram = '[]' WHERE machine = 2"}) {
    expect_refused(change, "row 2 of its table results");
  }
  expect_refused("UPDATE results SET hits = x'01'", "its column hits holds a value that is no");
  expect_refused("UPDATE results SET machine = 7 WHERE machine = 2", "row 7 of its table results");
  for (const char* change : {"UPDATE frame_results SET scene = 7 WHERE frame = 1",
                             "UPDATE frame_results SET image_hash = 'f' WHERE frame = 1",
                             "DELETE FROM frame_notes WHERE frame = 1"}) {
    expect_refused(change, "row 1 of its table frame_results");
  }
  for (const char* change :
       {"UPDATE points SET \"machine.nodes\" = 'x'", "UPDATE points SET cost = 7",
        "UPDATE compare SET machine = 2", "UPDATE settings SET value = '7' WHERE id = 1",
        "UPDATE machines SET key = 'k' WHERE id = 1", "UPDATE machines SET frame = 2 WHERE id = 1",
        "UPDATE store SET value = 'x' WHERE what = 'checksum'", "DELETE FROM store WHERE what = 'checksum'",
        "DROP VIEW histograms", "DROP VIEW summary; CREATE VIEW summary AS SELECT * FROM points"}) {
    expect_refused(change, "its plan does not match its checksum");
  }
}

// An index, a view or a table that a user has added is no damage.
TEST_F(DamagedStore, WhatAUserAddsIsNone) {
  const std::string expected = figures_of(file_);
  {
    SqliteConnection connection(file_, SqliteConnection::Access::write);
    connection.execute(
        "CREATE INDEX i ON machines (frame); CREATE VIEW v AS SELECT * FROM results; CREATE TABLE mine (a); "
        "ANALYZE; VACUUM");
  }
  EXPECT_EQ(figures_of(file_), expected);
  EXPECT_NO_THROW(SweepStore(file_, made_plan(damaged_machines)));
}

// The lock is written and removed; a file that may not be a lock is left alone.
TEST_F(DamagedStore, ALockIsNoLinkAndNothingElse) {
  const fs::path lock = file_.string() + ".lock";
  const fs::path precious = directory_.path() / "precious";
  sim::write_file(precious, "process of making it");
  const auto refused = [&](const std::string& why) {
    const std::string message = user_error_of([&] { SweepStore(file_, made_plan(damaged_machines)); });
    EXPECT_TRUE(message.starts_with(lock.string())) << message;
    EXPECT_NE(message.find(why + "; remove it"), std::string::npos) << message;
    EXPECT_TRUE(fs::exists(fs::symlink_status(lock)));
    EXPECT_EQ(sim::read_file(precious, 100), "process of making it");
    fs::remove(lock);
  };
  fs::create_symlink(precious, lock);
  refused("symbolic link");
  fs::create_symlink(directory_.path() / "none", lock);
  refused("symbolic link");
  EXPECT_FALSE(fs::exists(directory_.path() / "none"));
  fs::create_hard_link(precious, lock);
  refused("(a hard link)");
  ASSERT_EQ(mkfifo(lock.c_str(), 0600), 0);
  refused("not a regular file");
  sim::write_file(lock, "notes of mine");
  refused("a file of something else");
  sim::write_file(lock, "process 1 on a computer that has failed\n");
  EXPECT_NO_THROW(SweepStore(file_, made_plan(damaged_machines)));
}

}  // namespace
}  // namespace marti::studies
