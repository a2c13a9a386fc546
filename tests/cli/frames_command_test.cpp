// `marti study frames` as its user meets it: exit status, messages, files.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/cli/shell.h"
#include "tests/support/temporary_directory.h"

namespace marti::test {
namespace {

namespace fs = std::filesystem;

const fs::path shipped_frames = fs::path(MARTI_SOURCE) / "configs" / "animation.toml";
const std::string small_frames =
    quoted(shipped_frames) +
    " --set image.width=24 --set image.height=16 --set frames.count=2 --set frames.rate=2";
// A scene in which nothing moves, quickly rendered.
const std::string still = small_frames + " --set scene.source=tetra:2";

TEST(FramesCommand, WritesTablesChartAndImages) {
  const TemporaryDirectory directory;
  const fs::path a = directory.path() / "a";
  const fs::path b = directory.path() / "b";
  const Outcome outcome = marti("study frames " + small_frames + " -o " + quoted(a));
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  for (const char* text : {"swing.glb", "partial_dynamic", "All frames together", "frame-0001.png"}) {
    EXPECT_NE(outcome.output.find(text), std::string::npos) << text;
  }
  for (const char* name :
       {"frames.csv", "cycles.csv", "totals.csv", "columns.csv", "host_frames.csv", "frames.vl.json",
        "results.sqlite", "report.txt", "frame-0000.png", "frame-0000.exr", "frame-0001.exr"}) {
    EXPECT_TRUE(fs::exists(a / name)) << name;
  }
  EXPECT_FALSE(fs::exists(a / "frame-0002.png"));
  ASSERT_EQ(marti("study frames " + small_frames + " -o " + quoted(b)).status, 0);
  expect_same_files(a, b);
}

TEST(FramesCommand, WrongInputIsTwoAndOlderResultsStay) {
  const TemporaryDirectory directory;
  const fs::path out = directory.path() / "out";
  ASSERT_EQ(marti("study frames " + still + " -o " + quoted(out)).status, 0);
  const std::string before = read(out / "cycles.csv") + read(out / "frame-0001.png");
  const auto files = std::distance(fs::directory_iterator(out), {});
  const auto refused = [&](const std::string& options, const std::string& complaint) {
    expect_refused("study frames " + small_frames + options, complaint);
  };
  refused(" -o " + quoted(out) + " --set frames.count=0", "frames.count");
  refused(" -o " + quoted(out) + " --set frames.count=99999999999", "frames.count");
  refused(" -o " + quoted(out) + " --set scene.source=/nonexistent.glb", "/nonexistent.glb");
  refused(" -o " + quoted(out) + " --set scene.animation=waltz", "waltz");
  refused(" -o " + quoted(out) + " --set structure.kind=grid", "structure.kind");
  refused(" -o " + quoted(out) + " --set build.sharing=none", "build.sharing");
  refused("", "--output");
  write(directory.path() / "file", "in the way");
  refused(" -o " + quoted(directory.path() / "file"), "file");
  refused(" -o " + quoted(directory.path() / "file" / "below"), "file");
  // Nothing larger than a few blocks can be written, as on a full disk.
  const Outcome full = shell("ulimit -f 4; trap '' XFSZ; " + quoted(MARTI_PROGRAM) + " study frames " +
                             still + " --set node.clock=40MHz -o " + quoted(out));
  EXPECT_EQ(full.status, 2) << full.output;
  EXPECT_EQ(read(out / "cycles.csv") + read(out / "frame-0001.png"), before);
  EXPECT_EQ(std::distance(fs::directory_iterator(out), {}), files) << "nothing may be left behind";
}

TEST(FramesCommand, ARunOfSeveralFramesIsSentThere) {
  expect_refused("run " + quoted(shipped_frames), "marti study frames");
  expect_refused("run " + small_frames + " --set frames.count=1 --set frames.verify=false", "frames.verify");
}

}  // namespace
}  // namespace marti::test
