// `marti study suite` as its user runs it.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/cli/printed_json.h"
#include "tests/cli/sweep_files.h"
#include "tests/support/csv_records.h"
#include "tests/support/temporary_directory.h"

namespace marti::test {
namespace {

namespace fs = std::filesystem;

const std::string machines = R"(
[image]
width = 16
height = 12

[energy]
preset = "22nm"

[sweep.points.few]
machine.nodes = 2

[sweep.points.many]
machine.nodes = 8
)";

const std::string scenes = R"(
[suite]
baseline = "few"

[[suite.scene]]
name = "pot"
source = "teapot:2"

[[suite.scene]]
name = "lost"
source = "lost/"
found = "the attic"

[[suite.scene]]
name = "two of them"
source = ["tri.obj", { source = "tri.obj", translate = [0, 0, 1] }]
)";

std::string one_scene(const std::string& name, const std::string& source) {
  return "\n[[suite.scene]]\nname = \"" + name + "\"\nsource = \"" + source + "\"\n";
}

// A square of two triangles whose texture, of 16 by 16 texels, has holes.
const std::string quad_with_holes =
    R"({"asset": {"version": "2.0"}, "scene": 0, "materials": [{"pbrMetallicRoughness":
{"baseColorTexture": {"index": 0}, "metallicFactor": 0}, "alphaMode": "MASK"}], "meshes": [{"primitives":
[{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}], "nodes": [{"mesh": 0}],
"scenes": [{"nodes": [0]}], "images": [{"uri":
"data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAABAAAAAQCAYAAAAf8/9hAAAAJ0lEQVR4nGM4YWTEAMX/oZgkPgM1DCBLI4xPFQNGw2A0DEbDwIgBAP+sq5DmVVfPAAAAAElFTkSuQmCC"
}], "textures": [{"source": 0}], "accessors": [
{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-1, -1, 0], "max": [1, 1, 0]},
{"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
{"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"}], "bufferViews": [
{"buffer": 0, "byteOffset": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 32},
{"buffer": 0, "byteOffset": 80, "byteLength": 12}], "buffers": [{"byteLength": 92, "uri":
"data:application/octet-stream;base64,AACAvwAAgL8AAAAAAACAPwAAgL8AAAAAAACAPwAAgD8AAAAAAACAvwAAgD8AAAAAAAAAAAAAgD8AAIA/AACAPwAAgD8AAAAAAAAAAAAAAAAAAAEAAgAAAAIAAwA="
}]})";

class SuiteCommand : public testing::Test {
 protected:
  SuiteCommand() {
    write(config, scenes + machines);
    write(directory.path() / "tri.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  }
  [[nodiscard]] Outcome suite(const std::string& options = {}) const {
    return marti("study suite " + quoted(config) + " --quiet -o " + quoted(out) + " " + options);
  }
  /// What a run of its own takes.
  [[nodiscard]] double frame_time(const std::string& source, int nodes) const {
    const fs::path run = directory.path() / "run.toml";
    write(run, "scene.source = " + source + "\nmachine.nodes = " + std::to_string(nodes) + "\n" + machines);
    return printed_json("run " + quoted(run) + " --no-what-helps")
        .at("figures")
        .at("machine")
        .at("end")
        .get<double>();
  }
  /// A sweep of two points that may leave out what cannot be had: it times one and gives the reason of the
  /// other.
  void expect_one_left_out(const std::string& reason) const {
    const Outcome left = sweep(config, out, "--set sweep.skip_invalid=true");
    EXPECT_EQ(left.status, 0) << left.output;
    EXPECT_TRUE(says(left, "points        1, 1 more cannot be built"));
    EXPECT_TRUE(says(left, reason));
  }

  const TemporaryDirectory directory;
  const fs::path config = directory.path() / "suite.toml";
  const fs::path out = directory.path() / "out";
};

// Each speed-up is that of two runs, the mean is geometric, the scene that is not there is named, and the
// same command finds all done.
TEST_F(SuiteCommand, ComparesEachSceneAndGoesOn) {
  const Outcome first = suite();
  ASSERT_EQ(first.status, 0) << first.output;
  EXPECT_TRUE(says(first, "left out      lost: there is no lost/; found at the attic"));
  EXPECT_TRUE(says(first, "timed         6 machines"));
  const auto records = read_csv(read(out / "suite.csv"));
  ASSERT_TRUE(records);
  const std::vector<CsvRecord>& rows = *records;
  ASSERT_EQ(rows.size(), 4U) << read(out / "suite.csv");
  EXPECT_EQ(rows[0][0], "scene");
  EXPECT_EQ(rows[0][2], "speedup");
  const std::string two = R"(["tri.obj", { source = "tri.obj", translate = [0, 0, 1] }])";
  const double pot = frame_time("\"teapot:2\"", 2) / frame_time("\"teapot:2\"", 8);
  const double both = frame_time(two, 2) / frame_time(two, 8);
  EXPECT_EQ(rows[1][0], "pot");
  EXPECT_EQ(rows[1][1], "many");
  EXPECT_NEAR(std::stod(rows[1][2]), pot, 1e-9);
  EXPECT_EQ(rows[2][0], "two of them");
  EXPECT_NEAR(std::stod(rows[2][2]), both, 1e-9);
  EXPECT_NEAR(std::stod(rows[2][7]), frame_time(two, 8) / 1e9, 1e-9);
  EXPECT_EQ(rows[3][0], "geometric mean");
  EXPECT_NEAR(std::stod(rows[3][2]), std::sqrt(pot * both), 1e-9);
  EXPECT_NEAR(std::stod(rows[3][3]), std::sqrt(std::stod(rows[1][3]) * std::stod(rows[2][3])), 1e-9);
  EXPECT_TRUE(read(out / "suite.tex").find("geometric mean & many & ") != std::string::npos);
  EXPECT_TRUE(read(out / "report.html").find("geometric mean") != std::string::npos);
  EXPECT_TRUE(says(suite(), "all of it was there already"));
}

// A scene that cannot be read is left out, and the others have their results. With no other scene there are
// no results.
TEST_F(SuiteCommand, LeavesOutScenesThatCannotBeRead) {
  write(directory.path() / "bad.obj", "v 0 0 zero\n");
  write(directory.path() / "empty.obj", "v 0 0 0\n");
  const std::string bad = one_scene("the bad one", "bad.obj") + one_scene("nothing", "empty.obj");
  write(config, scenes + bad + machines);
  const Outcome outcome = suite();
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_TRUE(says(outcome, "left out      the bad one: bad.obj:1: 'zero' is no number"));
  EXPECT_TRUE(says(outcome, "left out      nothing: empty.obj: "));
  EXPECT_TRUE(says(outcome, "timed         6 machines"));
  EXPECT_TRUE(says(outcome, "geometric mean of 2 scenes"));
  const std::string table = read(out / "suite_left_out.csv");
  EXPECT_NE(table.find("the bad one,,bad.obj:1: 'zero' is no number"), std::string::npos) << table;
  EXPECT_NE(read(out / "suite.tex").find("the bad one"), std::string::npos);
  EXPECT_NE(read(out / "report.html").find("the bad one"), std::string::npos);
  write(config, "[suite]\nbaseline = \"few\"\n" + bad + machines);
  const Outcome none = suite();
  EXPECT_EQ(none.status, 2);
  EXPECT_TRUE(says(none, "bad.obj:1: 'zero' is no number"));
}

// What the lanes of a warp could help each other with is not recorded of triangles with holes, which is known
// once the scene is there. The machines that the scene can have are compared on it all the same.
TEST_F(SuiteCommand, LeavesOutAMachineThatASceneCannotHave) {
  write(directory.path() / "mask.gltf", quad_with_holes);
  const std::string simt =
      "\n[image]\nwidth = 16\nheight = 12\n[structure]\nkind = \"bvh\"\n[node]\nkind = "
      "\"simt\"\n[sweep.points.plain]\nrt.warps = 1\n[sweep.points.wide]\nrt.warps = 2\n"
      "[sweep.points.helps]\nrt.warps = 1\nrt.share = \"warp\"\n";
  const auto text = [&](const std::string& baseline) {
    return "[suite]\nbaseline = \"" + baseline + "\"\n" + one_scene("pot", "teapot:2") +
           one_scene("leaf", "mask.gltf") + simt;
  };
  write(config, text("plain"));
  const Outcome outcome = suite();
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_TRUE(says(outcome,
                   "left out      leaf, helps: suite.toml:25: rt.share: which hits of triangles with holes"));
  EXPECT_TRUE(says(outcome, "plain in the geometric mean of 1 of 2 scenes"));
  EXPECT_TRUE(says(outcome, "plain in the geometric mean of 2 scenes"));
  const auto records = read_csv(read(out / "suite.csv"));
  ASSERT_TRUE(records);
  const std::vector<CsvRecord>& rows = *records;
  ASSERT_EQ(rows.size(), 7U) << read(out / "suite.csv");
  const auto row = [&](const std::string& scene, const std::string& machine) {
    for (const CsvRecord& each : rows) {
      if (each[0] == scene && each[1] == machine) {
        return each;
      }
    }
    return CsvRecord();
  };
  ASSERT_FALSE(row("leaf", "helps").empty());
  EXPECT_EQ(row("leaf", "helps")[2], "") << "no speed-up";
  EXPECT_EQ(row("leaf", "helps")[7], "") << "no frame time";
  EXPECT_NE(row("leaf", "wide")[2], "");
  ASSERT_FALSE(row("geometric mean of 1 of 2 scenes", "helps").empty());
  EXPECT_EQ(row("geometric mean of 1 of 2 scenes", "helps")[2], row("pot", "helps")[2]);
  ASSERT_FALSE(row("geometric mean", "wide").empty());
  EXPECT_NEAR(std::stod(row("geometric mean", "wide")[2]),
              std::sqrt(std::stod(row("pot", "wide")[2]) * std::stod(row("leaf", "wide")[2])), 1e-9);
  for (const char* const file : {"suite_left_out.csv", "suite.tex", "report.html"}) {
    EXPECT_NE(read(out / file).find("which hits of triangles with holes"), std::string::npos) << file;
  }
  EXPECT_TRUE(says(suite(), "all of it was there already"));
  // Of a baseline that the scene cannot have nothing is compared there.
  write(config, text("helps"));
  const Outcome other = suite();
  EXPECT_EQ(other.status, 0) << other.output;
  EXPECT_TRUE(says(other, "left out      leaf, helps: suite.toml:25: rt.share: "));
  EXPECT_TRUE(says(other, "without the baseline nothing is compared"));
  EXPECT_TRUE(says(other, "in the geometric mean of 1 scene ("));
}

// In a sweep the same is said of the point and its scene, or left out.
TEST_F(SuiteCommand, ASweepSaysWhichPointASceneCannotHave) {
  write(directory.path() / "mask.gltf", quad_with_holes);
  const std::string text =
      "scene.source = \"mask.gltf\"\nimage = { width = 8, height = 8 }\nstructure.kind = \"bvh\"\n"
      "node.kind = \"simt\"\n[sweep.axes]\nrt.share = [\"none\", \"warp\"]\n";
  write(config, text);
  const Outcome refused = sweep(config, out);
  EXPECT_EQ(refused.status, 2);
  EXPECT_TRUE(says(refused, "suite.toml:6: rt.share: which hits of triangles with holes"));
  EXPECT_TRUE(says(refused, "(the point rt.share = \"warp\" on mask.gltf)"));
  expect_one_left_out("suite.toml:6: rt.share: which hits");
  EXPECT_TRUE(says(sweep(config, out, "--set sweep.skip_invalid=true"), "all of it was there already"));
}

// Whether a memory is large enough is known of the tree that is laid out in it.
TEST_F(SuiteCommand, ASweepLeavesOutWhatIsRefusedOnceTheTreeIsThere) {
  write(config,
        "scene.source = \"teapot:16\"\nimage = { width = 8, height = 8 }\nmemory.model = \"dram\"\n"
        "[sweep.axes]\ndram.rows = [1, 32768]\n");
  const Outcome refused = sweep(config, out);
  EXPECT_EQ(refused.status, 2);
  EXPECT_TRUE(says(refused, "suite.toml:5: dram.rows: scene and image take "));
  EXPECT_TRUE(says(refused, " on teapot:16)"));
  expect_one_left_out("suite.toml:5: dram.rows: scene and image take ");
}

// Two folders with the same files give the same bytes, and what one has timed the other need not.
TEST_F(SuiteCommand, DoesNotDependOnItsFolder) {
  const auto run_in = [&](const std::string& name) {
    const fs::path folder = directory.path() / name;
    fs::create_directories(folder);
    fs::copy_file(config, folder / "suite.toml");
    fs::copy_file(directory.path() / "tri.obj", folder / "tri.obj");
    return folder;
  };
  const auto suite_in = [](const fs::path& folder) {
    return shell("cd " + quoted(folder) + " && " + quoted(MARTI_PROGRAM) +
                 " study suite suite.toml --quiet -o o");
  };
  const fs::path a = run_in("a");
  const fs::path b = run_in("b");
  const fs::path c = run_in("c");
  ASSERT_EQ(suite_in(a).status, 0);
  ASSERT_EQ(suite_in(b).status, 0);
  for (const char* const file : {"points.csv", "suite.csv", "suite_left_out.csv", "suite.tex"}) {
    EXPECT_EQ(read(a / "o" / file), read(b / "o" / file)) << file;
  }
  EXPECT_EQ(read(a / "o" / "points.csv").find(directory.path().string()), std::string::npos);
  EXPECT_EQ(read(a / "o" / "report.html").find(directory.path().string()), std::string::npos);
  fs::copy(a / "o", c / "o");
  EXPECT_TRUE(says(suite_in(c), "all of it was there already"));
}

TEST_F(SuiteCommand, NamesWhatTheFilterLeavesOut) {
  const std::string text = "[suite]\nbaseline = \"few\"\n" + one_scene("pot", "teapot:2") +
                           one_scene("tetra", "tetra:1") + machines + "\n[sweep]\nfilter = ";
  write(config, text + "\"scene.source = 'teapot:2' or point <> 'few'\"\n");
  const Outcome without = suite();
  EXPECT_EQ(without.status, 0) << without.output;
  EXPECT_TRUE(says(without, "left out      tetra, few: does not pass sweep.filter"));
  EXPECT_TRUE(says(without, "in the geometric mean of 1 scene ("));
  write(config, text + "\"point <> 'few'\"\n");
  const Outcome none = suite();
  EXPECT_EQ(none.status, 2);
  EXPECT_TRUE(says(none, "left out      pot, few: does not pass sweep.filter"));
  EXPECT_TRUE(says(none, "suite.baseline: the baseline is left out of every scene"));
}

// Nothing is timed, nor written, where the results could not stay.
TEST_F(SuiteCommand, RefusesADirectoryOfSomethingElse) {
  fs::create_directories(out);
  write(out / "report.html", "hi\n");
  write(out / "suite.csv", "mine\n");
  const Outcome refused = suite();
  EXPECT_EQ(refused.status, 2);
  EXPECT_TRUE(says(refused, "report.html"));
  EXPECT_EQ(read(out / "suite.csv"), "mine\n");
  EXPECT_FALSE(fs::exists(out / "results.sqlite"));
  fs::remove_all(out);

  const fs::path plain = directory.path() / "sweep.toml";
  write(plain, "scene.source = \"tetra:1\"\n" + machines);
  ASSERT_EQ(sweep(plain, out).status, 0);
  EXPECT_EQ(suite().status, 2);
  EXPECT_TRUE(says(suite(), "results.sqlite: is there already, of `marti sweep`"));
  fs::remove_all(out);
  ASSERT_EQ(suite().status, 0);
  const std::string before = read(out / "points.csv");
  const Outcome sweep_there = sweep(plain, out);
  EXPECT_EQ(sweep_there.status, 2);
  EXPECT_TRUE(says(sweep_there, "results.sqlite: is there already, of `marti study suite`"));
  EXPECT_EQ(read(out / "points.csv"), before);
}

TEST_F(SuiteCommand, RefusesWhatIsNoSuite) {
  const auto refusal = [&](const std::string& text) {
    write(config, text);
    const Outcome outcome = suite();
    EXPECT_EQ(outcome.status, 2) << outcome.output;
    return outcome;
  };
  EXPECT_TRUE(says(refusal(machines), "suite: is missing"));
  EXPECT_TRUE(
      says(refusal("[suite]\nbaseline = \"none\"\n[[suite.scene]]\nname = \"a\"\nsource = \"tetra:1\"\n" +
                   machines),
           "suite.toml:2: suite.baseline: there is no machine of this name"));
  EXPECT_TRUE(says(refusal("[suite]\nbaseline = \"few\"\n" + one_scene("a", "tetra:1") +
                           "[sweep.points.few]\nmachine.nodes = 2\n"),
                   "suite.toml:2: suite.baseline: there is no other machine"));
  EXPECT_TRUE(
      says(refusal("[suite]\nbaseline = \"few\"\n" + one_scene("geometric mean", "tetra:1") + machines),
           "suite.toml:5: suite.scene.name: stands in the table for the mean"));
  EXPECT_TRUE(says(refusal("[suite]\nbaseline = \"few\"\n[[suite.scene]]\nname = \"flat\"\nsource = { source "
                           "= \"tri.obj\", scale = 0 }\n" +
                           machines),
                   "suite.toml:5: suite.scene.source: flat: entry 1, tri.obj: its transform is singular"));
  EXPECT_TRUE(says(
      refusal("[suite]\nbaseline = \"few\"\n[[suite.scene]]\nname = \"a\"\nsource = \"no.obj\"\n" + machines),
      "none of the suite's scenes is there"));
  EXPECT_TRUE(
      says(refusal("[suite]\nbaseline = \"few\"\n[[suite.scene]]\nnmae = \"a\"\nsource = \"tetra:1\"\n" +
                   machines),
           "suite.scene.nmae: unknown key (did you mean \"name\"?)"));
  EXPECT_TRUE(says(refusal("[suite]\nbaseline = \"few\"\n[[suite.scene]]\nname = \"a\"\nsource = "
                           "\"tri.obj\"\nsha256 = \"" +
                           std::string(64, '0') + "\"\n" + machines),
                   "tri.obj is another file: its SHA-256 is not 00000"));
  write(config, scenes + machines);
  EXPECT_TRUE(says(marti("run " + quoted(config)), "`marti study suite`"));
}

}  // namespace
}  // namespace marti::test
