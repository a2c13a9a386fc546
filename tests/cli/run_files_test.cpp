// The files that `marti run -o` leaves in a directory.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "sim/sha256.h"
#include "tests/cli/shell.h"
#include "tests/support/temporary_directory.h"

namespace marti::test {
namespace {

namespace fs = std::filesystem;

// What is read is never replaced by a result: the next run would read something else.
TEST(RunFiles, NoneReplacesAnInput) {
  const TemporaryDirectory directory;
  const fs::path config = directory.path() / "result.json";
  const fs::path points = directory.path() / "points.csv";
  const fs::path scene = directory.path() / "swing.glb";
  fs::copy_file(fs::path(MARTI_SOURCE) / "configs" / "marti.toml", config);
  fs::copy_file(config, points);
  fs::copy_file(fs::path(MARTI_SOURCE) / "configs" / "scenes" / "swing.glb", scene);
  const std::string out = " -o " + quoted(directory.path());
  for (const auto& [file, arguments] :
       {std::pair(config, "run " + quoted(config) + small_teapot + out),
        std::pair(points, "sweep " + quoted(points) + small_teapot + " --axis machine.nodes=1,2" + out),
        std::pair(scene, "scene export " + quoted(scene) + " " + quoted(scene))}) {
    const std::string before = read(file);
    expect_refused(arguments, "is read as input");
    EXPECT_EQ(read(file), before) << arguments;
  }
}

// Files of an earlier run that this run does not write are removed; other files stay.
TEST(RunFiles, AreASet) {
  const TemporaryDirectory directory;
  const fs::path out = directory.path() / "out";
  const std::string run = "run " + small_run + " -o " + quoted(out);
  const std::set<std::string> plain = {"image.exr", "image.png", "result.json"};
  const std::string everything =
      " --set count.attribution=true --set count.working_set=true --set record.heat_maps=true"
      " --set record.timeline=true --set image.voxel_cut=1 --set image.voxel_cut_reference=true";
  ASSERT_EQ(marti(run + everything).status, 0);
  const std::set<std::string> all = names_in(out);
  EXPECT_EQ(all.size(), 13U) << "every kind of file";
  const auto named = nlohmann::json::parse(read(out / "result.json"))["files"];
  EXPECT_EQ(named.size(), 12U);
  for (const auto& [name, file] : named.items()) {
    EXPECT_EQ(file["sha256"], sim::sha256_of_file(out / name)) << name;
  }
  ASSERT_EQ(marti(run).status, 0);
  EXPECT_EQ(names_in(out), plain);

  // Results of an older program, which named no files.
  ASSERT_EQ(marti(run + everything).status, 0);
  auto old = nlohmann::ordered_json::parse(read(out / "result.json"));
  old.erase("files");
  write(out / "result.json", old.dump());
  ASSERT_EQ(marti(run).status, 0);
  EXPECT_EQ(names_in(out), plain);

  // Files that were changed, that the result does not name, or only claims to name, are the user's.
  ASSERT_EQ(marti(run + " --set record.heat_maps=true").status, 0);
  write(out / "heat-waits.png", "mine");
  write(out / "timeline.json", "mine");
  write(out / "notes.txt", "mine");
  write(directory.path() / "outside", "mine");
  fs::remove(out / "heat.exr");
  fs::create_symlink("heat-misses.png", out / "heat.exr");
  auto claims = nlohmann::ordered_json::parse(read(out / "result.json"));
  for (const char* name : {"notes.txt", "../outside"}) {
    claims["files"][name] = {{"sha256", sim::sha256_text("mine")}};
  }
  write(out / "result.json", claims.dump());
  ASSERT_EQ(marti(run).status, 0);
  EXPECT_EQ(names_in(out), (std::set<std::string>{"image.exr", "image.png", "result.json", "heat.exr",
                                                  "heat-waits.png", "timeline.json", "notes.txt"}));
  EXPECT_TRUE(fs::exists(directory.path() / "outside"));

  // A refusal changes nothing, and a damaged result names nothing.
  write(out / "result.json", "{");
  EXPECT_EQ(marti(run + " --set cache.size=17").status, 2);
  EXPECT_EQ(read(out / "result.json"), "{");
  ASSERT_EQ(marti(run + " --json").status, 0);
  EXPECT_EQ(names_in(out).size(), 7U);
}

// A page of one machine does not stay beside the results of another, unless somebody has changed it.
TEST(RunFiles, APageOfAnotherRunGoesWithIt) {
  const TemporaryDirectory directory;
  const fs::path out = directory.path() / "out";
  const fs::path page = out / "report.html";
  const std::string run = "run --no-what-helps " + small_run + " -o " + quoted(out) + " --set machine.nodes=";
  const auto report = [&] { ASSERT_EQ(marti("report " + quoted(out)).status, 0); };
  ASSERT_EQ(marti(run + "2").status, 0);
  report();
  ASSERT_EQ(marti(run + "2").status, 0);
  EXPECT_TRUE(fs::exists(page)) << "it is of this machine";
  ASSERT_EQ(marti(run + "3").status, 0);
  EXPECT_FALSE(fs::exists(page));
  report();
  write(page, read(page) + "my notes\n");
  ASSERT_EQ(marti(run + "2").status, 0);
  EXPECT_TRUE(fs::exists(page)) << "it is the user's now";
}

}  // namespace
}  // namespace marti::test
