// Machines of a sweep that share a replay: each has the results of its own replay.
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <string_view>

#include "processors/replay/replay.h"
#include "studies/run/functional_run.h"
#include "studies/run/open_frame.h"
#include "studies/sweep/plan/sweep_row.h"
#include "tests/unit/studies/sweep_tables.h"

namespace marti::studies {

using namespace sweep;

namespace {

using processors::replay::MachineResult;

const std::string frame = R"(
[scene]
source = "teapot:2"
[image]
width = 12
height = 12
max_depth = 2
[machine]
nodes = 3
)";

// Replays every machine and compares with the result of the first machine of its timing. Returns the number
// of timings.
std::size_t check_timings(const std::string& text) {
  const SweepPlan plan = test::plan_of(frame + text);
  const keys::FrameConfig& config = plan.frames.front().config;
  const run::FunctionalRun run = run::run_functional(config, run::open_frame(config));
  std::map<std::size_t, MachineResult> first;
  for (const SweepMachine& machine : plan.machines) {
    const MachineResult own = processors::replay::replay(*run.frame.log, machine.config);
    MachineResult& shared = first.emplace(machine.timing, own).first->second;
    processors::replay::work_out_energy(*run.frame.log, machine.config, shared);
    EXPECT_EQ(sweep_row(machine.config, shared), sweep_row(machine.config, own)) << text;
  }
  return first.size();
}

constexpr std::string_view widths =
    "[sweep.axes]\ninterconnect.width = [1, 2, 3, 4, 8, 15, 16, 31, 32, 64]\n";

std::string with_widths(const std::string& text) { return text + std::string(widths); }

TEST(SweepTiming, WidthsThatMoveALineInAsManyBeatsShareAReplay) {
  // The speed-up's machine of one node has the same widths. Lines of 32 bytes take 32, 16, 11, 8, 4, 3, 2, 2,
  // 1 and 1 beats, pixels of 4 bytes 4, 2, 2 and then 1.
  EXPECT_EQ(check_timings(with_widths("")), 2 * 8U);
  EXPECT_EQ(check_timings(with_widths("[cache]\nline = 16\n[interconnect]\nkind = \"crossbar\"\n")), 2 * 6U);
  EXPECT_EQ(check_timings(with_widths("[layout]\npixel = \"48 B\"\n")), 2 * 10U);
  EXPECT_EQ(check_timings(with_widths("[l2]\nsharing = \"shared\"\nsize = \"4 KiB\"\n")), 2 * 8U);
  EXPECT_EQ(check_timings(with_widths("[prefetch]\nnext_line = true\n")), 2 * 8U);
}

TEST(SweepTiming, WidthsOfOtherTransfersDoNot) {
  EXPECT_EQ(check_timings(with_widths("[cache]\norganisation = \"none\"\n")), 2 * 10U) << "parts of a record";
  EXPECT_EQ(check_timings(with_widths("[build]\nsharing = \"shared\"\n")), 2 * 10U)
      << "written nodes of the tree";
}

TEST(SweepTiming, FiguresOfEnergyShareAReplay) {
  EXPECT_EQ(check_timings("[sweep.axes]\nenergy.preset = [\"none\", \"45nm\", \"22nm\"]\n"), 2U);
  EXPECT_EQ(check_timings("[energy]\npreset = \"22nm\"\n[sweep.axes]\nenergy.voltage = [0.7, 1.0]\n"
                          "energy.wire = [0.1, 0.2]\n"),
            2U);
}

TEST(SweepTiming, OtherKeysDoNot) {
  EXPECT_EQ(check_timings("[sweep.axes]\ncache.size = [\"1 KiB\", \"2 KiB\"]\ncache.ways = [1, 2]\n"),
            2 * 4U);
  EXPECT_EQ(check_timings("[sweep.axes]\ninterconnect.clock = [\"33 MHz\", \"66 MHz\"]\n"), 2 * 2U);
}

}  // namespace

}  // namespace marti::studies
