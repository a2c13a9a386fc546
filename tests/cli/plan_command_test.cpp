// What a run leaves out, as its user sees it: the summary, --keep, --verify-plan.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/cli/printed_json.h"
#include "tests/support/temporary_directory.h"

namespace marti::test {
namespace {

namespace fs = std::filesystem;

class PlanCommand : public ::testing::Test {
 protected:
  PlanCommand() { write(config_, "[machine]\nnodes = 2\n[image]\nwidth = 24\nheight = 16\n"); }

  [[nodiscard]] Outcome run(const std::string& arguments) const {
    return marti("run " + quoted(config_) + " " + arguments);
  }
  [[nodiscard]] nlohmann::json json(const std::string& arguments) const {
    return printed_json("run " + quoted(config_) + " " + arguments);
  }

  TemporaryDirectory directory_;
  fs::path config_ = directory_.path() / "run.toml";
};

TEST_F(PlanCommand, WrongItemsAreRefusedBeforeAnythingIsWritten) {
  const fs::path out = directory_.path() / "out";
  const Outcome wrong = run("--keep shadows -o " + quoted(out));
  EXPECT_EQ(wrong.status, 2);
  EXPECT_TRUE(says(wrong, "--keep: the plan has no item \"shadows\""));
  EXPECT_TRUE(says(wrong, "mailboxes, contention, cache and all"));
  EXPECT_FALSE(fs::exists(out));
  EXPECT_EQ(run("--keep").status, 2);
}

TEST_F(PlanCommand, SaysWhatIsLeftOutAndWhatIsKept) {
  const std::string scene = "--set scene.source=teapot:2 --set image.max_depth=3 ";
  const Outcome plain = run(scene);
  EXPECT_EQ(plain.status, 0);
  EXPECT_TRUE(says(plain, "\nplan          left out: refraction-rays (none of the 3 materials"));
  const nlohmann::json planned = json(scene);
  EXPECT_EQ(planned["plan"]["refraction-rays"]["decision"], "left out");
  EXPECT_EQ(planned["plan"]["textures"]["decision"], "not applicable");
  const nlohmann::json all = json(scene + "--keep all");
  for (const auto& [name, entry] : all["plan"].items()) {
    EXPECT_NE(entry["decision"], "left out") << name;
  }
  for (const char* same : {"figures", "machine", "structure", "scene", "config"}) {
    EXPECT_EQ(all[same], planned[same]) << same;
  }
  // Nothing is said where nothing was at stake.
  EXPECT_FALSE(
      says(run("--set scene.source=teapot:2 --set image.max_depth=1 --set cache.size=1KiB"), "\nplan "));
}

TEST_F(PlanCommand, ProvesItself) {
  const std::string same =
      "\nverified      with everything kept the same image, hits, work log, and every figure of the machine";
  // Only the first of the runs that are compared records its critical path.
  const Outcome path =
      run("--verify-plan --set scene.source=teapot:2 --set structure.max_level=5"
          " --set record.critical_path=true");
  EXPECT_EQ(path.status, 0) << path.output;
  EXPECT_TRUE(says(path, same));
  // The plan of an animated file proves itself too.
  const Outcome swing = run("--verify-plan --set scene.source=" + shipped("scenes/swing.glb"));
  EXPECT_EQ(swing.status, 0) << swing.output;
  EXPECT_TRUE(says(swing, same));
}

}  // namespace
}  // namespace marti::test
