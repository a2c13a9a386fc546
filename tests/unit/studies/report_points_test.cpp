// Points of a store as a page reads them.
#include <gtest/gtest.h>

#include <functional>
#include <optional>

#include "studies/report/read/read_points.h"
#include "studies/sweep/store/sweep_store.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"
#include "tests/unit/studies/sweep_parts.h"

namespace marti::studies {

using namespace figures;
using namespace report;
using namespace sweep;

namespace {

namespace fs = std::filesystem;
using test::made_plan;
using test::TemporaryDirectory;
using test::user_error_of;

// Five machines on two frames, four of them timed; `change` changes the plan, or the row of a machine.
class ReadReportPoints : public testing::Test {
 protected:
  void make(
      const std::function<void(SweepPlan&)>& change_plan = [](SweepPlan&) {},
      const std::function<void(std::size_t, Counts&)>& change = [](std::size_t, Counts&) {}) {
    fs::remove(file_);
    SweepPlan plan = made_plan(5);
    change_plan(plan);
    test::write_store(
        file_, plan,
        [&](std::size_t machine) -> std::optional<SweepRow> {
          if (machine == 4) {
            return std::nullopt;
          }
          Counts counts(counted_figures().size(), 1000 + 10 * machine);
          change(machine, counts);
          return SweepRow{counts, {}};
        },
        [](std::size_t frame) {
          FrameRow row = test::made_frame_row(frame);
          row.image_hash = test::made_key(frame).substr(16);
          return row;
        });
  }

  TemporaryDirectory directory_;
  fs::path file_ = directory_.path() / "results.sqlite";
};

TEST_F(ReadReportPoints, ReadsThemWithTheirFrames) {
  make();
  const ReportPoints sweep = read_report_points(file_);
  EXPECT_EQ(sweep.planned, 5U);
  ASSERT_EQ(sweep.points.size(), 4U);
  EXPECT_EQ(sweep.frames, 2U);
  EXPECT_EQ(sweep.points[0].frame, sweep.points[2].frame);
  EXPECT_NE(sweep.points[0].frame, sweep.points[1].frame);
  EXPECT_EQ(sweep.points[1].figure("end"), 1010.0);
  EXPECT_EQ(sweep.points[1].figure("price"), 1.5);
  EXPECT_EQ(sweep.points[0].advice, "") << "none was measured";
}

// Sums over 2^24 nodes of a long frame are that large.
TEST_F(ReadReportPoints, TakesTheLargestCountsThatAStoreHolds) {
  make([](SweepPlan&) {},
       [](std::size_t machine, Counts& counts) {
         for (std::size_t i = 0; machine == 2 && i < counts.size(); ++i) {
           const bool sum = counted_figures()[i].merge == Merge::sum;
           counts[i] = sum ? static_cast<Count>(largest_count) : INT64_MAX;
         }
       });
  EXPECT_EQ(read_report_points(file_).points[2].figure("end"), 0x1p63);
  EXPECT_EQ(read_report_points(file_).points[2].figure("time_idle"), largest_count);
}

TEST_F(ReadReportPoints, RefusesAFrameThatTakesNoTime) {
  make([](SweepPlan&) {},
       [](std::size_t machine, Counts& counts) {
         if (machine == 2) {
           counts.assign(counts.size(), 0);
         }
       });
  EXPECT_NE(user_error_of([&] { (void)read_report_points(file_); }).find("point 2: the frame takes no time"),
            std::string::npos);
}

TEST_F(ReadReportPoints, RefusesNumbersThatAChartCannotTellApart) {
  constexpr std::int64_t odd = (std::int64_t{1} << 53U) + 1;
  make([odd](SweepPlan& plan) {
    plan.points[1].values[1] = odd - 1;
    plan.points[2].values[1] = odd;
  });
  EXPECT_NE(user_error_of([&] { (void)read_report_points(file_); }).find("axis machine.nodes has two values"),
            std::string::npos);
}

}  // namespace
}  // namespace marti::studies
