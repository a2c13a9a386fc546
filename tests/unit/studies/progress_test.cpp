// Progress: what a meter says, how its work is stopped, and that a line leaves nothing behind.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <string>
#include <thread>
#include <vector>

#include "sim/work_meter.h"
#include "studies/progress/progress_line.h"
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
