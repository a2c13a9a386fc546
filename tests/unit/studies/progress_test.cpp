// Progress: what a meter says, how its work is stopped, and that a line leaves nothing behind.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>
#include <thread>
#include <vector>

#include "sim/work_meter.h"
#include "studies/progress/progress_line.h"
#include "studies/progress/whole_estimate.h"
#include "tests/support/screen.h"

namespace marti::studies {

using namespace progress;

namespace {

using std::chrono::milliseconds;

TEST(WorkMeter, CountsTheStepsOfItsPartFromAllThreads) {
  sim::WorkMeter meter;
  EXPECT_EQ(meter.state().part, "");
  meter.begin("reading");
  meter.count(7);
  meter.begin("tracing", "rows", 4000);
  std::vector<std::jthread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] {
      for (int step = 0; step < 1000; ++step) {
        meter.count();
      }
    });
  }
  threads.clear();
  const sim::WorkMeter::State state = meter.state();
  EXPECT_EQ(state.part, "tracing");
  EXPECT_EQ(state.unit, "rows");
  EXPECT_EQ(state.done, 4000U);
  EXPECT_EQ(state.of, 4000U);
}

TEST(WorkMeter, StopsItsWorkAndThatOfItsParts) {
  sim::WorkMeter whole;
  sim::WorkMeter part(&whole);
  sim::WorkMeter other;
  part.count();
  EXPECT_EQ(whole.state().done, 0U);
  part.end_if_stopped();
  whole.stop();
  EXPECT_THROW(whole.count(), sim::Stopped);
  EXPECT_THROW(whole.begin("more"), sim::Stopped);
  EXPECT_THROW(part.count(), sim::Stopped);
  EXPECT_THROW(sim::end_if_stopped(&part), sim::Stopped);
  other.count();
  sim::count_step(nullptr);
  sim::begin_part(nullptr, "nobody waits");
  sim::end_if_stopped(nullptr);
}

TEST(ShownMeter, SaysWhatIsDone) {
  EXPECT_EQ(meter_text({}, 5.0), "");
  EXPECT_EQ(meter_text({"building the octree"}, 5.0), "building the octree, 5.0 s");
  EXPECT_EQ(meter_text({"tracing", "rows", 120, 240}, 65.0),
            "[############............] tracing: 120 of 240 rows, 1 min 05 s");
  // Steps that were not foreseen.
  EXPECT_EQ(meter_text({"timing", "packets", 250, 240}, 65.0),
            "[########################] timing: 240 of 240 packets, 1 min 05 s");
  EXPECT_EQ(meter_text({"timing machines", "machines", 3, 12}, 5.0, {12.0, 24.0}),
            "[######..................] timing machines: 3 of 12 machines, 5.0 s, 12.0 s left (24.0 s of "
            "processor time)");
  EXPECT_EQ(meter_text({"tracing", "rows", 120, 240}, 65.0, {60.0, 60.0}, 195.0),
            "[############............] tracing: 120 of 240 rows, 1 min 05 s of about 3 min 15 s");
  EXPECT_EQ(meter_text({"building the octree"}, 5.0, {}, 20.0), "building the octree, 5.0 s of about 20.0 s");
}

// What is left takes as long as parts of its kind have taken; those that were found finished took no time.
TEST(WorkMeter, TellsWhatIsLeftOfAllItsParts) {
  sim::WorkMeter meter;
  EXPECT_EQ(meter.state().whole_of, 0U);
  meter.plan("frames", 2);
  meter.plan("machines", 40);
  meter.plan("machines", 4);
  meter.finish("frames", false);
  EXPECT_EQ(meter.state().left.seconds, 0.0) << "nothing is known yet";
  std::this_thread::sleep_for(milliseconds(20));
  meter.finish("machines", true);
  const sim::WorkMeter::State state = meter.state();
  EXPECT_EQ(state.whole_unit, "parts");
  EXPECT_EQ(state.whole_done, 2U);
  EXPECT_EQ(state.whole_of, 6U);
  EXPECT_GT(state.left.seconds, 0.0) << "four parts, each like the machine";
  meter.begin("timing");
  EXPECT_EQ(meter_text(meter.state(), 5.0).find("[########................] 2 of 6 parts, 5.0 s"), 0U);
  for (int more = 0; more < 9; ++more) {
    meter.finish("machines", true);
  }
  EXPECT_EQ(meter.state().whole_of, 12U) << "more than were planned";
}

// Steps that were done before the part was first seen say nothing about its pace, nor do those of other
// parts.
TEST(Pace, IsThatOfTheStepsSeenDone) {
  Pace pace;
  const auto left = [&pace](std::uint64_t done, Duration now, const char* part = "timing") {
    return pace.left({part, "machines", done, 12}, now);
  };
  EXPECT_EQ(left(4, {10.0, 10.0}).seconds, 0.0);
  EXPECT_EQ(left(6, {14.0, 18.0}).seconds, 12.0);
  EXPECT_EQ(left(6, {14.0, 18.0}).processor, 24.0);
  EXPECT_EQ(left(12, {20.0, 20.0}).seconds, 0.0) << "nothing is left";
  EXPECT_EQ(left(3, {30.0, 30.0}, "tracing").seconds, 0.0) << "another part";
  EXPECT_EQ(left(6, {33.0, 31.0}, "tracing").seconds, 6.0);
  EXPECT_EQ(pace.left({"reading", "", 0, 0}, {40.0, 40.0}).seconds, 0.0) << "what is not counted";
}

const std::vector<ForeseenPart> three_parts = {{"reading", 2.0, false}, {"tracing", 4.0}, {"timing", 6.0}};

// Where all takes what was foreseen, the estimate is the truth at any time, up to what is kept in reserve for
// a part that is nearly over and not counted.
TEST(WholeEstimate, IsTheTruthWhereAllIsAsForeseen) {
  WholeEstimate estimate;
  for (int quarter = 0; quarter <= 48; ++quarter) {
    const double passed = 0.25 * quarter;
    const sim::WorkMeter::State state =
        passed < 2.0   ? sim::WorkMeter::State{"reading the scene"}
        : passed < 6.0 ? sim::WorkMeter::State{"tracing", "rows", static_cast<std::uint64_t>(quarter - 8), 16}
                       : sim::WorkMeter::State{"timing the machine", "packets",
                                               static_cast<std::uint64_t>(quarter - 24), 24};
    EXPECT_NEAR(estimate.seconds(state, three_parts, passed), 12.0, passed < 2.0 ? 0.1 : 1e-9) << passed;
  }
}

// A part that is counted says itself how long it takes: what was foreseen wrongly does less and less harm,
// and none at the end.
TEST(WholeEstimate, ComesToTheTruthWhateverWasForeseen) {
  for (const double times : {0.1, 0.5, 2.0, 10.0}) {
    WholeEstimate estimate;
    double error = 1e300;
    for (std::uint64_t step = 0; step <= 100; ++step) {
      const double passed = 6.0 * times * static_cast<double>(step) / 100.0;
      const double seconds = estimate.seconds({"timing", "packets", step, 100}, {{"timing", 6.0}}, passed);
      EXPECT_GE(seconds, passed);
      if (step > 25) {
        EXPECT_LE(std::abs(seconds - 6.0 * times), error + 1e-9) << times << " " << step;
      }
      error = std::abs(seconds - 6.0 * times);
    }
    EXPECT_NEAR(error, 0.0, 1e-9) << times;
  }
}

TEST(WholeEstimate, KnowsOfPartsOverAndToComeAndOfNoOthers) {
  WholeEstimate estimate;
  EXPECT_EQ(estimate.seconds({"reading the log"}, {}, 1.0), 0.0);
  EXPECT_EQ(estimate.seconds({"verifying"}, three_parts, 1.0), 0.0);
  EXPECT_EQ(estimate.seconds({"reading"}, three_parts, 1.0), 12.0);
  const double overdue = estimate.seconds({"reading"}, three_parts, 4.0);
  EXPECT_GT(overdue, 14.0) << "it is not done";
  EXPECT_LT(overdue, 5.0 + 2.0 * 10.0) << "what is to come takes at most twice as long, too";
  // Reading took 5 s in place of 2: the computer is taken for slower, within bounds. Nothing was traced.
  const double timing = estimate.seconds({"timing", "packets", 0, 10}, three_parts, 5.0);
  EXPECT_GE(timing, 5.0 + 6.0 / 2.0);
  EXPECT_LE(timing, 5.0 + 6.0 * 2.0);
  EXPECT_EQ(estimate.seconds({"timing", "packets", 10, 10}, three_parts, 9.0), 9.0);
}

std::string content_of(std::FILE* file) {
  std::rewind(file);
  std::string text;
  for (int c = std::fgetc(file); c != EOF; c = std::fgetc(file)) {
    text += static_cast<char>(c);
  }
  return text;
}

TEST(ProgressLine, IsDrawnOverAndTakenAway) {
  std::FILE* const out = std::tmpfile();
  std::atomic<int> asked = 0;
  {
    ProgressLine line({out, milliseconds(1), milliseconds(1)}, [&] {
      const int time = ++asked;
      return time == 1 ? std::string("a long text") : time == 2 ? "short" : std::string(time, 'x');
    });
    while (asked < 100) {
      std::this_thread::sleep_for(milliseconds(1));
    }
    line.end();
    const int after = asked;
    std::this_thread::sleep_for(milliseconds(20));
    EXPECT_EQ(asked, after) << "nothing is drawn after the end";
    line.end();
  }
  const std::string text = content_of(out);
  std::fclose(out);
  EXPECT_EQ(text.find('\n'), std::string::npos);
  EXPECT_EQ(test::screen_after(text.substr(0, text.find("\rshort") + 12)), "short");
  EXPECT_EQ(test::screen_after(text), "");
  EXPECT_EQ(text.back(), '\r');
  EXPECT_EQ(text.find(std::string(80, 'x')), std::string::npos) << "one line of a terminal of unknown width";
}

TEST(ProgressLine, WhatIsDoneSoonHasNone) {
  std::FILE* const out = std::tmpfile();
  {
    const ProgressLine line({out, std::chrono::hours(1)}, [] { return std::string("never"); });
  }
  {
    const ProgressLine line({out, milliseconds(1)}, [] { return std::string(); });
  }
  EXPECT_EQ(content_of(out), "");
  std::fclose(out);
}

}  // namespace
}  // namespace marti::studies
