// `marti run --save-log`, and the log in the place of the scene.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/cli/shell.h"
#include "tests/support/ray_file.h"
#include "tests/support/temporary_directory.h"

namespace marti::test {
namespace {

namespace fs = std::filesystem;

class SavedLog : public ::testing::Test {
 protected:
  [[nodiscard]] fs::path file(const std::string& name) const { return directory_.path() / name; }
  [[nodiscard]] std::string from_log() const { return " --set scene.log=" + quoted(log_); }

  const TemporaryDirectory directory_;
  const fs::path log_ = directory_.path() / "a.log";
};

// What the program prints as JSON, without the settings.
nlohmann::json printed(const std::string& arguments) {
  const Outcome outcome = marti(arguments + " --json");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  nlohmann::json json = nlohmann::json::parse(outcome.output);
  json.erase("config");
  return json;
}

TEST_F(SavedLog, EveryShippedMachineHasTheFiguresOfItsScene) {
  for (const char* config : {"apollo-sequential.toml", "contexts.toml", "distributed.toml", "dram.toml",
                             "dynamic.toml", "marti.toml", "naive-pixel.toml", "pipeline.toml",
                             "replicated.toml", "second-level.toml", "space.toml", "today.toml"}) {
    const std::string run = "run " + shipped(config) + small_teapot + " --no-what-helps";
    const nlohmann::json of_scene = printed(run + " --save-log " + quoted(log_));
    EXPECT_EQ(of_scene, printed(run + from_log())) << config;
  }
}

// A log has what is left of other images and structures, too.
TEST_F(SavedLog, OtherFramesHaveTheFiguresOfTheirScenes) {
  for (const char* frame :
       {"image.voxel_cut=4 --set image.samples=2", "image.integrator=path", "structure.kind=bsp",
        "structure.kind=grid", "structure.kind=none", "structure.mailboxes=true",
        "image.region=[3,2,10,9] --set structure.kind=bvh", "scene.source=balls:1"}) {
    const std::string run = "run " + small_run + " --what-helps --set " + frame;
    const nlohmann::json of_scene = printed(run + " --save-log " + quoted(log_));
    EXPECT_EQ(of_scene, printed(run + from_log())) << frame;
  }
}

// Neither the scene nor a setting of the frame is needed; what was set otherwise is refused.
TEST_F(SavedLog, StandsInThePlaceOfTheScene) {
  fs::copy_file(fs::path(MARTI_SOURCE) / "configs" / "scenes" / "swing.glb", file("swing.glb"));
  write(file("scene.toml"),
        "scene.source = \"swing.glb\"\nframes.first = 7\nimage.width = 20\nimage.height = 10\n"
        "machine.nodes = 3\n");
  const nlohmann::json whole = printed("run " + quoted(file("scene.toml")) + " --save-log " + quoted(log_) +
                                       " -o " + quoted(file("s")));
  fs::remove(file("swing.glb"));
  write(file("log.toml"), "scene.log = \"a.log\"\nmachine.nodes = 3\n");
  nlohmann::json same = printed("run " + quoted(file("log.toml")) + " -o " + quoted(file("l")));
  EXPECT_EQ(names_in(file("l")), std::set<std::string>{"result.json"}) << "a log has no image";
  same["files"] = whole["files"];
  EXPECT_EQ(same, whole);
  EXPECT_EQ(marti("report " + quoted(file("l"))).status, 0);

  write(file("wrong.toml"), "scene.log = \"a.log\"\nmachine.nodes = 3\nimage.width = 21\n");
  expect_refused("run " + quoted(file("wrong.toml")),
                 "wrong.toml:3: image.width: the log " + log_.string() + " was made with 20");
  expect_refused("run " + quoted(file("log.toml")) + " --set structure.kind=bsp", "was made with \"octree\"");
  expect_refused("run " + quoted(file("log.toml")) + " --set structure.grid_density=3",
                 "has no effect with structure.kind");
  expect_refused("sweep " + quoted(file("log.toml")) + " --axis image.width=20,30 -o " + quoted(file("w")),
                 "was made with 20");
  // A command that names the log takes it in the place of what the file describes.
  EXPECT_EQ(printed("run " + quoted(file("wrong.toml")) + from_log()),
            printed("run " + quoted(file("log.toml"))));
  expect_refused("run " + quoted(file("wrong.toml")) + from_log() + " --set image.width=21",
                 "was made with 20");
}

// The rays are in the log: their file is not needed any more.
TEST_F(SavedLog, OfGivenRaysNeedsNoFileOfThem) {
  write(file("rays.npy"), ray_file({0.0, 0.0, 9.0, 0.0, 0.0, 0.0, -1.0, 1e9,  //
                                    0.1, 0.2, 9.0, 0.0, 0.0, 0.0, -2.0, 1e9}));
  const std::string run = "run " + shipped("marti.toml") + " --no-what-helps";
  const nlohmann::json of_rays =
      printed(run + " --set scene.source=balls:1 --set image.integrator=rays --set image.rays=" +
              quoted(file("rays.npy")) + " --save-log " + quoted(log_));
  fs::remove(file("rays.npy"));
  EXPECT_EQ(of_rays, printed(run + from_log()));
}

TEST_F(SavedLog, ServesEveryCommandThatTimesMachines) {
  const std::string scene = shipped("sweep-small.toml") + small_teapot;
  ASSERT_EQ(marti("run " + scene + " --save-log " + quoted(log_)).status, 0);
  for (const std::string& command : {std::string("sweep "), std::string("trace --nodes 0 ")}) {
    ASSERT_EQ(marti(command + scene + " -o " + quoted(file("s"))).status, 0);
    const Outcome logged = marti(command + scene + from_log() + " -o " + quoted(file("l")));
    ASSERT_EQ(logged.status, 0) << logged.output;
    const std::string name = command.starts_with("sweep") ? "points.csv" : "node-00000.din";
    EXPECT_NE(read(file("s") / name), "");
    EXPECT_EQ(read(file("s") / name), read(file("l") / name)) << command;
    fs::remove_all(file("s"));
    fs::remove_all(file("l"));
  }
  const std::string estimate =
      "run " + shipped("marti.toml") +
      " --set image.width=256 --set image.height=256 --set scene.source=teapot:4 --set machine.nodes=4";
  ASSERT_EQ(marti(estimate + " --save-log " + quoted(log_)).status, 0);
  EXPECT_EQ(marti(estimate + " --within 20%").output, marti(estimate + " --within 20%" + from_log()).output);
}

TEST_F(SavedLog, SaysWhatItCannotAnswer) {
  ASSERT_EQ(marti("run " + small_run + " --save-log " + quoted(log_)).status, 0);
  for (const char* study : {"error", "stability", "operations"}) {
    expect_refused("study " + std::string(study) + " " + small_run + from_log() + " -o " + quoted(file("o")),
                   "a log serves to time machines. Take scene.source in its place");
  }
  for (const char* study : {"frames animation.toml", "paper paper.toml"}) {
    const std::string name(study);
    const std::size_t space = name.find(' ');
    expect_refused("study " + name.substr(0, space) + " " + shipped(name.substr(space + 1)) + from_log() +
                       " -o " + quoted(file("o")),
                   "a log serves to time machines. Take scene.source in its place");
  }
  const std::string run = "run " + small_run + from_log();
  expect_refused(run + " --keep textures", "\"textures\" can be kept only while the scene is traced");
  EXPECT_TRUE(says(marti(run + " --verify-plan"), "not verified"));
  expect_refused("run " + small_run + " --within 5% --save-log " + quoted(file("b.log")), "leave one out");
  write(file("scene.obj"), "v 0 0 0\n");
  expect_refused("run " + small_run + " --save-log " + quoted(file("scene.obj")),
                 "is no work log, so it is not replaced");

  const std::string bvh = "run " + small_run + " --set structure.kind=bvh";
  ASSERT_EQ(marti(bvh + " --save-log " + quoted(log_)).status, 0);
  expect_refused(bvh + " --set node.kind=simt" + from_log(), "was written for nodes without stacks");
}

TEST_F(SavedLog, RefusesOtherFilesAndDamagedOnes) {
  const std::string run = "run " + small_run + from_log();
  expect_refused(run, log_.string() + ": cannot be read: No such file or directory");
  fs::create_directory(log_);
  expect_refused(run, "not a regular file");
  fs::remove(log_);
  write(log_, "# a configuration\n");
  expect_refused(run, "is no work log as `marti run --save-log` writes it");
  fs::remove(log_);
  ASSERT_EQ(marti("run " + small_run + " --save-log " + quoted(log_)).status, 0);
  expect_refused("run " + small_run + from_log() + " --save-log " + quoted(log_), "is read as input");
  std::string bytes = read(log_);
  write(log_, bytes.substr(0, bytes.size() / 2));
  expect_refused(run, "has been cut off");
  std::string newer = bytes;
  newer[16] = 77;
  write(log_, newer);
  expect_refused(run, "is a work log of format 77, and this program reads format 2");
  bytes[bytes.size() - 9] = static_cast<char>(~bytes[bytes.size() - 9]);
  write(log_, bytes);
  expect_refused(run, "is damaged");
}

TEST_F(SavedLog, OnAFullDiskLeavesNoFile) {
  const Outcome full =
      shell("ulimit -f 8; trap '' XFSZ; " + quoted(MARTI_PROGRAM) + " run " + shipped("marti.toml") +
            " --set scene.source=teapot:6 --no-what-helps --save-log " + quoted(log_));
  EXPECT_EQ(full.status, 2);
  EXPECT_TRUE(says(full, "a.log: cannot be written: "));
  EXPECT_EQ(names_in(log_.parent_path()), std::set<std::string>{});
  expect_refused("run " + small_run + " --save-log " + quoted(file("none") / "a.log"), "cannot be written");
}

}  // namespace
}  // namespace marti::test
