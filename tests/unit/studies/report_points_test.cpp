// Points of a store that may have been changed by hand.
#include <gtest/gtest.h>

#include "studies/report/read/read_points.h"
#include "studies/sweep/store/sweep_store.h"
#include "studies/tables/sqlite_connection.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"
#include "tests/unit/studies/sweep_parts.h"

namespace marti::studies {

using namespace figures;
using namespace report;
using namespace sweep;
using namespace tables;

namespace {

namespace fs = std::filesystem;
using test::made_plan;
using test::TemporaryDirectory;
using test::user_error_of;

class ReadReportPoints : public testing::Test {
 protected:
  ReadReportPoints() { make({}); }

  // Five machines on two frames, four of them timed.
  void make(const std::vector<std::string>& changes) {
    fs::remove(file_);
    const auto row_of = [](std::size_t machine) {
      return machine == 4
                 ? std::nullopt
                 : std::optional(SweepRow{Counts(counted_figures().size(), 1000 + 10 * machine), {}});
    };
    test::write_store(file_, made_plan(5), row_of, [](std::size_t frame) {
      FrameRow row = test::made_frame_row(frame);
      row.image_hash = test::made_key(frame).substr(16);
      return row;
    });
    if (!changes.empty()) {
      SqliteConnection connection(file_, SqliteConnection::Access::write);
      for (const std::string& change : changes) {
        connection.execute(change);
      }
      // As a store without checksums; that checksums detect a change is tested elsewhere.
      connection.execute("PRAGMA user_version = 1; UPDATE store SET value = '1' WHERE what = 'format'");
    }
  }

  std::string error(const std::string& change) {
    make({change});
    return user_error_of([&] { (void)read_report_points(file_); });
  }

  void expect_refused(const std::string& change, const std::string& what) {
    const std::string message = error(change);
    EXPECT_NE(message.find("results.sqlite: point 2: "), std::string::npos) << change << "\n" << message;
    EXPECT_NE(message.find(what), std::string::npos) << change << "\n" << message;
  }

  TemporaryDirectory directory_;
  fs::path file_ = directory_.path() / "results.sqlite";
};

TEST_F(ReadReportPoints, ReadsThemWithTheirFrames) {
  const ReportPoints sweep = read_report_points(file_);
  EXPECT_EQ(sweep.planned, 5U);
  ASSERT_EQ(sweep.points.size(), 4U);
  EXPECT_EQ(sweep.frames, 2U);
  EXPECT_EQ(sweep.points[0].frame, sweep.points[2].frame);
  EXPECT_NE(sweep.points[0].frame, sweep.points[1].frame);
  EXPECT_EQ(sweep.points[1].figure("end"), 1010.0);
  EXPECT_EQ(sweep.points[1].figure("price"), 1.5);
  EXPECT_EQ(sweep.points[0].limit, "") << "its settings are not known";
}

TEST_F(ReadReportPoints, RefusesFrameTimesThatAreNone) {
  for (const char* end : {"NULL", "'soon'", "-5", "1e300", "1.5", "9223372036854775807", "1e308", "9e999"}) {
    expect_refused(std::string("UPDATE results SET \"end\" = ") + end + " WHERE machine = 3", "its end is ");
  }
  // This one can be right: a machine whose operations cost nothing.
  EXPECT_NE(
      error("UPDATE results SET \"end\" = 0 WHERE machine = 3").find("point 2: the frame takes no time"),
      std::string::npos);
  EXPECT_EQ(error("UPDATE results SET \"end\" = 4611686018427387904 WHERE machine = 3"), "no UserError");
}

TEST_F(ReadReportPoints, RefusesFiguresOutOfRange) {
  for (const char* value : {"-1", "'many'", "1e300", "9e999", "9223372036854775807"}) {
    expect_refused(std::string("UPDATE results SET hits = ") + value + " WHERE machine = 3", "hit");
    expect_refused(std::string("UPDATE results SET nodes = ") + value + " WHERE machine = 3", "");
    expect_refused(std::string("UPDATE points SET cost = ") + value + " WHERE ordinal = 2", "its cost is ");
  }
  EXPECT_EQ(error("UPDATE results SET hits = NULL WHERE machine = 3"), "no UserError");
}

TEST_F(ReadReportPoints, RefusesValuesThatAreNoPlace) {
  expect_refused("UPDATE points SET \"machine.nodes\" = NULL WHERE ordinal = 2", "machine.nodes is missing");
  expect_refused("UPDATE points SET \"cache.size\" = 9e999 WHERE ordinal = 2", "cache.size is inf");
  expect_refused("UPDATE points SET \"cache.size\" = -1e300 WHERE ordinal = 2", "out of range");
  expect_refused("UPDATE points SET \"machine.nodes\" = 0, \"cache.size\" = 0.0 WHERE ordinal = 2",
                 "the same values as point 0");
  EXPECT_NE(error("UPDATE points SET \"machine.nodes\" = 'x', \"cache.size\" = 1.0, \"l2.on\" = 0")
                .find("point 1: it has the same values as point 0"),
            std::string::npos);
}

TEST_F(ReadReportPoints, RefusesNumbersThatAChartCannotTellApart) {
  expect_refused(
      "UPDATE points SET \"machine.nodes\" = 9007199254740992 + (ordinal = 2) WHERE ordinal >= 1 AND ordinal "
      "<= 2",
      "the same number");
}

TEST_F(ReadReportPoints, RefusesMachinesThatAreNotThere) {
  expect_refused("UPDATE points SET machine = 99 WHERE ordinal = 2", "its machine 99 is not in the store");
  EXPECT_NE(error("UPDATE points SET machine = 99 WHERE ordinal = 4").find("point 4: "), std::string::npos)
      << "one that has not been timed";
}

}  // namespace
}  // namespace marti::studies
