// `marti study frames` as its user meets it: exit status, messages, files.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/cli/shell.h"
#include "tests/support/temporary_directory.h"

namespace marti::test {
namespace {

namespace fs = std::filesystem;

const std::string shipped_frames = shipped("animation.toml");
const std::string small_frames =
    shipped_frames + " --set image.width=24 --set image.height=16 --set frames.count=2 --set frames.rate=2";
// A scene in which nothing moves, quickly rendered.
const std::string still = small_frames + " --set scene.source=tetra:2";

TEST(FramesCommand, WritesTablesChartAndImages) {
  const TemporaryDirectory directory;
  expect_study("frames " + small_frames, directory.path(),
               {"swing.glb", "partial_dynamic", "All frames together", "frame-0001.png"},
               {"frames.csv", "cycles.csv", "totals.csv", "columns.csv", "host_frames.csv", "frames.vl.json",
                "results.sqlite", "report.txt", "frame-0000.png", "frame-0000.exr", "frame-0001.exr"});
  EXPECT_FALSE(fs::exists(directory.path() / "a" / "frame-0002.png"));
}

TEST(FramesCommand, WrongInputIsTwoAndOlderResultsStay) {
  const TemporaryDirectory directory;
  const fs::path out = directory.path() / "out";
  ASSERT_EQ(marti("study frames " + still + " -o " + quoted(out)).status, 0);
  const auto before = files_of(out);
  const auto refused = [&](const std::string& options, const std::string& complaint) {
    expect_refused("study frames " + small_frames + options, complaint);
  };
  refused(" -o " + quoted(out) + " --set frames.count=0", "frames.count");
  refused(" -o " + quoted(out) + " --set scene.animation=waltz", "waltz");
  EXPECT_TRUE(before == files_of(out));
  expect_kept_on_a_full_disk("frames " + still, out);
}

TEST(FramesCommand, ARunOfSeveralFramesIsSentThere) {
  expect_refused("run " + shipped_frames, "marti study frames");
  expect_refused("run " + small_frames + " --set frames.count=1 --set frames.verify=false", "frames.verify");
}

}  // namespace
}  // namespace marti::test
