// The program as its user meets it: exit status, messages, files.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>

#include "tests/cli/printed_json.h"
#include "tests/support/long_tests.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/wrong_configurations.h"

namespace marti::test {
namespace {

namespace fs = std::filesystem;

TEST(Command, StudyOfOperationsWritesItsTables) {
  const TemporaryDirectory directory;
  const Outcome outcome = marti("study operations -o " + quoted(directory.path() / "study") + small_teapot +
                                " --set image.max_depth=2");
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  for (const char* word :
       {"bsp, push-point", "grid, octree's cells", "bvh, 8 quantised", "per unit length", "HERO"}) {
    EXPECT_TRUE(says(outcome, word)) << word;
  }
  const std::string operations = read(directory.path() / "study" / "operations.csv");
  EXPECT_EQ(operations.find("walk,mailboxes,nodes,entries,step,steps_per_ray,add,"), 0U);
  EXPECT_NE(operations.find("\n\"grid, density\",1,"), std::string::npos);
  EXPECT_NE(read(directory.path() / "study" / "unit_length.csv").find("\n8,128,grid,1.5,"),
            std::string::npos);
  EXPECT_EQ(marti("study").status, 2);
  EXPECT_EQ(marti("study operations --set structure.bsp_walk=push_point").status, 2) << "not used";
}

// OpenImageIO's libraries are most of a short run's time, so only what writes or reads an image loads them.
TEST(Command, OnlyImagesLoadOpenImageIO) {
  const TemporaryDirectory directory;
  const fs::path config = directory.path() / "a.toml";
  write(config, "");
  const auto libraries = [&](const std::string& name, const std::string& arguments) {
    const Outcome outcome = shell("LD_DEBUG=files LD_DEBUG_OUTPUT=" + quoted(directory.path() / name) + " " +
                                  quoted(MARTI_PROGRAM) + " " + arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    std::string text;
    for (const auto& entry : fs::directory_iterator(directory.path())) {
      text += entry.path().stem() == name ? read(entry.path()) : "";
    }
    EXPECT_NE(text.find("libtbb"), std::string::npos) << text;
    return text;
  };
  const std::string run = "run " + quoted(config) + small_teapot;
  EXPECT_EQ(libraries("version", "--version").find("OpenImageIO"), std::string::npos);
  EXPECT_EQ(libraries("run", run).find("OpenImageIO"), std::string::npos);
  const std::string images = libraries("images", run + " -o " + quoted(directory.path() / "out"));
  EXPECT_NE(images.find("OpenImageIO"), std::string::npos);
}

TEST(Command, ARunWritesItsFilesAndTheSameBytesAgain) {
  const TemporaryDirectory directory;
  const fs::path a = directory.path() / "a";
  const fs::path b = directory.path() / "b" / "deeper";
  ASSERT_EQ(marti("run " + small_run + " -o " + quoted(a)).status, 0);
  ASSERT_EQ(marti("run " + small_run + " -o " + quoted(b)).status, 0);
  for (const char* name : {"image.exr", "image.png", "result.json"}) {
    EXPECT_FALSE(read(a / name).empty()) << name;
  }
  EXPECT_EQ(read(a / "result.json"), read(b / "result.json"));
  EXPECT_EQ(read(a / "image.png"), read(b / "image.png"));
  EXPECT_EQ(std::distance(fs::directory_iterator(a), {}), 3) << "no temporary file may stay behind";
}

// All of them are refused in tests/fuzz, by the library; here is what the program adds.
TEST(Command, WrongConfigurationsGetOneMessageWithFileLineAndKey) {
  const TemporaryDirectory directory;
  const fs::path config = directory.path() / "wrong.toml";
  for (std::size_t i = 0; i < wrong_configurations().size(); i += stride(8)) {
    const WrongConfiguration& wrong = wrong_configurations()[i];
    write(config, wrong.text);
    const Outcome outcome = marti("run " + quoted(config) + " -o " + quoted(directory.path() / "out"));
    EXPECT_EQ(outcome.status, 2) << wrong.text << "\n" << outcome.output;
    EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
    for (const std::string& part : wrong.complaint) {
      EXPECT_TRUE(says(outcome, part)) << wrong.text;
    }
    EXPECT_FALSE(fs::exists(directory.path() / "out")) << wrong.text;
  }
}

TEST(Command, AnAssignmentMaySwitchOffWhatTheFileDescribes) {
  for (const char* assignment : {"cache.organisation=none", "cache.organisation=split", "structure.kind=none",
                                 "structure.kind=bsp", "structure.kind=grid", "structure.kind=bvh",
                                 "interconnect.kind=ideal", "interconnect.kind=crossbar"}) {
    const Outcome outcome = marti("run " + small_run + " --set " + assignment);
    EXPECT_EQ(outcome.status, 0) << assignment << "\n" << outcome.output;
  }
  const Outcome both = marti("run " + small_run + " --set cache.organisation=none --set cache.size=1KiB");
  EXPECT_EQ(both.status, 2) << "what the same command line gives must be used";
}

TEST(Command, ARefusalLeavesEarlierResultsAlone) {
  const TemporaryDirectory directory;
  const fs::path out = directory.path() / "out";
  ASSERT_EQ(marti("run " + small_run + " -o " + quoted(out)).status, 0);
  const std::string before = read(out / "result.json");
  EXPECT_EQ(marti("run " + small_run + " --set cache.size=17 -o " + quoted(out)).status, 2);
  EXPECT_EQ(read(out / "result.json"), before);
}

TEST(Command, UnwritablePlacesAreTheUsersAffair) {
  const TemporaryDirectory directory;
  const fs::path config = fs::path(MARTI_SOURCE) / "configs" / "marti.toml";
  write(directory.path() / "file", "in the way");
  const Outcome blocked =
      marti("run " + quoted(config) + small_teapot + " -o " + quoted(directory.path() / "file"));
  EXPECT_EQ(blocked.status, 2) << blocked.output;
  // Files larger than a few blocks cannot be written, as on a full disk.
  const Outcome full =
      shell("ulimit -f 1; trap '' XFSZ; " + quoted(MARTI_PROGRAM) + " run " + quoted(config) +
            " --set image.width=200 --set image.height=200 --set scene.source=teapot:2 -o " +
            quoted(directory.path() / "full"));
  EXPECT_EQ(full.status, 2) << full.output;
  EXPECT_TRUE(says(full, "full/image.exr: cannot be written: File too large")) << full.output;
  EXPECT_FALSE(fs::exists(directory.path() / "full")) << "nothing may be left behind";
  const Outcome closed = shell(quoted(MARTI_PROGRAM) + " config > /dev/full");
  EXPECT_EQ(closed.status, 2) << closed.output;
}

TEST(Command, UsageErrorsAreTwoAndHelpIsZero) {
  EXPECT_EQ(marti("fly").status, 2);
  EXPECT_EQ(marti("run").status, 2);
  EXPECT_EQ(marti("run /nonexistent.toml").status, 2);
  EXPECT_EQ(marti("run / ").status, 2);
  EXPECT_EQ(marti("run x.toml -o ''").status, 2);
  EXPECT_EQ(marti("--help").status, 0);
  EXPECT_EQ(marti("").output, marti("--help").output);
  EXPECT_EQ(marti("").status, 0);
  EXPECT_EQ(marti("run --help").status, 0);
  EXPECT_EQ(marti("help run").output, marti("run --help").output);
  EXPECT_EQ(marti("help study error").output, marti("study error --help").output);
  EXPECT_EQ(marti("help").output, marti("--help").output);
  EXPECT_EQ(marti("help help").output, marti("help --help").output);
  expect_refused("help nonsense", "there is no command \"nonsense\"");
  expect_refused("help run paper", "there is no command \"paper\"");
  expect_refused("help --nonsense", "--nonsense");
  EXPECT_EQ(marti("-V").output, marti("--version").output);
  EXPECT_EQ(marti("--version").status, 0);
}

// Wrong values of options are refused as those of keys are.
TEST(Command, OptionsSayWhatTheyTake) {
  for (const auto& [arguments, words] : {
           std::pair{"sweep x.toml -o y --best end --budget cheap",
                     "--budget=cheap: must be a number, not the text"},
           {"sweep x.toml -o y --best end --budget -1", "--budget=-1: must be at least 0"},
           {"sweep x.toml -o y --best end --budget nan", "--budget=nan: must be a number"},
           {"sweep x.toml -o y --best end --budget 1e999", "--budget=1e999: must be a number"},
           {"sweep x.toml -o y --threads 1.5", "--threads=1.5: must be an integer, not the real 1.5"},
           {"sweep x.toml -o y --threads 5000", "--threads=5000: must be 0 to 4096, not 5000"},
           {"report y --budget 3EUR", "--budget=3EUR: must be a number, not the text"},
           {"explore x.toml --port many", "--port=many: must be an integer, not the text \"many\""},
           {"explore x.toml --for long", "--for=long: must be a number, not the text \"long\""},
           {"trace x.toml -o y --format dni",
            "--format=dni: must be din, csv, ramulator-loadstore, ramulator-readwrite, dramsim3, gem5 or "
            "champsim, not \"dni\" (did you mean \"din\"?)"},
       }) {
    expect_refused(arguments, words);
  }
}

TEST(Command, ConfigListsEveryKeyAndTheReferenceIsUpToDate) {
  const Outcome text = marti("config");
  EXPECT_EQ(text.status, 0);
  for (const char* key : {"cache.size", "machine.nodes", "scene.source", "host.assignment"}) {
    EXPECT_TRUE(says(text, key)) << key;
  }
  const std::string reference = read(fs::path(MARTI_SOURCE) / "docs" / "configuration.md");
  EXPECT_EQ(marti("config --markdown").output, reference)
      << "run: marti config --markdown > docs/configuration.md";
}

TEST(Command, FiguresListsEveryFigureAndTheReferenceIsUpToDate) {
  const Outcome text = marti("figures");
  EXPECT_EQ(text.status, 0);
  for (const char* figure : {"end", "speed_up", "hits", "node_misses", "camera_rays"}) {
    EXPECT_TRUE(says(text, "\n  " + std::string(figure) + " ")) << figure;
  }
  EXPECT_EQ(marti("figures --markdown").output, read(fs::path(MARTI_SOURCE) / "docs" / "figures.md"))
      << "run: marti figures --markdown > docs/figures.md";
}

TEST(Command, AnExportedSceneRendersLikeItsSource) {
  const TemporaryDirectory directory;
  const fs::path file = directory.path() / "teapot.glb";
  ASSERT_EQ(marti("scene export teapot:2 " + quoted(file)).status, 0);
  const Outcome info = marti("scene info " + quoted(file));
  EXPECT_EQ(info.status, 0) << info.output;
  const Outcome recipe = marti("scene info teapot:2");
  EXPECT_TRUE(says(recipe, "polygons"));
  const std::string size = " --set image.width=24 --set image.height=16 --set scene.source=";
  // The file holds single-precision positions, so a few rays at edges may differ, and no more.
  const auto camera_hits = [&](const std::string& source) {
    const nlohmann::json result = printed_json("run " + shipped("marti.toml") + size + source);
    return result["figures"]["frame"]["camera_hits"].get<int>();
  };
  EXPECT_NEAR(camera_hits(quoted(file)), camera_hits("teapot:2"), 3);
  EXPECT_EQ(marti("scene export teapot:2 " + quoted(directory.path() / "teapot.obj")).status, 2);
  EXPECT_EQ(marti("scene list").status, 0);
}

// Whatever is wrong with the image: the library that decodes it writes no line of its own.
TEST(Command, ABrokenTextureHasOneMessage) {
  const TemporaryDirectory directory;
  const fs::path folder = directory.path();
  ASSERT_EQ(marti("run " + small_run + " -o " + quoted(folder / "out")).status, 0);
  const std::string whole = read(folder / "out" / "image.png");
  constexpr std::size_t head = 33;  // the signature and the first chunk
  ASSERT_GT(whole.size(), 4 * head);
  write(folder / "a.mtl", "newmtl m\nmap_Kd a.png\n");
  write(folder / "a.obj",
        "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n");
  const auto outcome_with = [&](const std::string& image, const std::string& options) {
    write(folder / "a.png", image);
    return marti("run " + small_run + " --set scene.source=" + quoted(folder / "a.obj") + options);
  };
  std::string damaged_head = whole;
  damaged_head[head - 1] = static_cast<char>(damaged_head[head - 1] ^ 1);
  std::string damaged_data = whole;
  damaged_data[whole.size() / 2] = static_cast<char>(damaged_data[whole.size() / 2] ^ 1);
  for (const std::string& image :
       {whole.substr(0, head - 10), whole.substr(0, whole.size() / 2), damaged_head, damaged_data}) {
    const Outcome refused = outcome_with(image, " --set scene.strict=true");
    EXPECT_EQ(refused.status, 2);
    EXPECT_EQ(std::count(refused.output.begin(), refused.output.end(), '\n'), 1) << refused.output;
    EXPECT_TRUE(says(refused, "a.png"));
    const Outcome replaced = outcome_with(image, "");
    EXPECT_EQ(replaced.status, 0);
    EXPECT_TRUE(says(replaced, "Replaced: 1 textures that cannot be decoded, by "));
    EXPECT_EQ(replaced.output.find("libpng"), std::string::npos) << replaced.output;
  }
  // The smallest image of another format that glTF files may have, WebP.
  const std::string webp("RIFF\x1a\0\0\0WEBPVP8L\x0d\0\0\0\x2f\0\0\0\x10\x07\x10\x11\x11\x88\x88\xfe\x07\0",
                         34);
  EXPECT_EQ(outcome_with(webp, " --set scene.strict=true").status, 0);
  // It also warns of what does no harm: here a comment whose checksum is wrong.
  const std::string comment("\0\0\0\3tEXta\0bXXXX", 15);
  const Outcome warned =
      outcome_with(whole.substr(0, head) + comment + whole.substr(head), " --set scene.strict=true");
  EXPECT_EQ(warned.status, 0);
  EXPECT_EQ(warned.output.find("libpng"), std::string::npos) << warned.output;
}

TEST(Command, FramesOfAnAnimationDiffer) {
  const std::string options =
      " --set image.width=40 --set image.height=30 --set frames.count=1 --set structure.max_level=6";
  const auto hash = [&](const std::string& more) {
    const nlohmann::json result = printed_json("run " + shipped("animation.toml") + options + more);
    return result["figures"]["frame"]["image_hash"].get<std::string>();
  };
  const std::string begin = hash("");
  const std::string third = hash(" --set frames.first=3");
  EXPECT_NE(begin, third);
  EXPECT_EQ(third, hash(" --set frames.first=6 --set frames.rate=16")) << "the same time";
  EXPECT_EQ(hash(" --set frames.first=8"), hash(" --set frames.first=9")) << "it stands still after its end";

  expect_refused("run " + shipped("animation.toml"), "animation.toml:8: frames.count: 8 frames");
  for (const char* what : {"scene.source=tetra:2", "scene.animation=none"}) {
    expect_refused(
        "run " + shipped("animation.toml") + options + " --set frames.first=1 --set " + std::string(what),
        "no animation plays");
  }
}

TEST(Command, AnExportedPoseIsAStaticScene) {
  const TemporaryDirectory directory;
  const fs::path file = directory.path() / "pose.glb";
  const std::string scene = shipped("scenes/swing.glb");
  const Outcome info = marti("scene info " + scene + " --time 0.375");
  EXPECT_TRUE(says(info, "animation 0: 'swing', 1 s, 4 channels (plays)"));
  EXPECT_TRUE(says(info, "skins: 1\nmorph targets: 1\n"));
  ASSERT_EQ(marti("scene export " + scene + " " + quoted(file) + " --time 0.375").status, 0);
  const Outcome exported = marti("scene info " + quoted(file));
  EXPECT_TRUE(says(exported, "animations: 0\n"));
  const std::string bounds = info.output.substr(info.output.find("bounds:"), 20);
  EXPECT_TRUE(says(exported, bounds));
  EXPECT_EQ(marti("scene info " + scene + " --time nan").status, 2);
  EXPECT_EQ(marti("scene info " + quoted(file) + " --time 1").status, 2);
  EXPECT_EQ(marti("scene info " + scene + " --animation swim").status, 2);
}

TEST(Command, TheVoxelCutReportsWhatItSavedAndWhatItCost) {
  const TemporaryDirectory directory;
  const fs::path out = directory.path() / "out";
  const std::string run = "run " + shipped("marti.toml") +
                          " --set image.width=24 --set image.height=24 --set scene.source=teapot:6";
  const std::string cut = " --set image.voxel_cut=1";
  const nlohmann::json result =
      printed_json(run + cut + " --set image.voxel_cut_reference=true -o " + quoted(out));
  const nlohmann::json& report = result["voxel_cut"];
  EXPECT_GT(report["rays"]["camera"].get<int>(), 0);
  EXPECT_EQ(report["rays"]["shadow"], 0);
  EXPECT_GT(report["exact"]["rmse"].get<double>(), 0.0);
  EXPECT_LE(report["exact"]["visible_pixels"], report["exact"]["changed_pixels"]);
  EXPECT_LT(report["use"]["nodes"], report["exact"]["use"]["nodes"]);
  EXPECT_EQ(report["exact"]["use"]["voxels"], 0);
  const nlohmann::json& figures = result["figures"];
  EXPECT_EQ(figures["machine"]["steps_cuts"], figures["frame"]["log_cuts"]);
  EXPECT_EQ(figures["machine"]["steps_passes"], figures["frame"]["log_passes"]);

  nlohmann::json exact = printed_json(run + " -o " + quoted(directory.path() / "exact"));
  EXPECT_TRUE(exact["voxel_cut"].is_null());
  const nlohmann::json& whole = exact["figures"]["frame"];
  for (const auto& [name, count] : report["exact"]["work_log"].items()) {
    EXPECT_EQ(count, whole["log_" + name]) << name;
  }
  EXPECT_EQ(read(out / "exact.png"), read(directory.path() / "exact" / "image.png"));
  EXPECT_NE(read(out / "image.png"), read(out / "exact.png"));

  EXPECT_NE(marti(run + cut).output.find("voxel cut"), std::string::npos);
  expect_refused(run + " --set image.voxel_cut_reference=true", "image.voxel_cut_reference");
  expect_refused(run + cut + " --set structure.kind=bsp", "image.voxel_cut");
}

TEST(Command, AHyphenIsTheConfigurationOnStandardInput) {
  const TemporaryDirectory directory;
  const std::string file = shipped("marti.toml");
  nlohmann::json of_file = printed_json("run " + small_run);
  nlohmann::json piped = printed_json("run -" + small_teapot + " < " + file);
  EXPECT_EQ(piped["config"]["file"], "standard input");
  of_file["config"].erase("file");
  piped["config"].erase("file");
  EXPECT_EQ(piped, of_file);
  const fs::path out = directory.path() / "out";
  EXPECT_EQ(
      marti("sweep - --axis machine.nodes=1,2" + small_teapot + " -o " + quoted(out) + " < " + file).status,
      0);
  EXPECT_EQ(
      marti("trace -" + small_teapot + " -o " + quoted(directory.path() / "traces") + " < " + file).status,
      0);
  const Outcome wrong =
      shell("printf 'machine.nodes = 2\\nmachine.nods = 3\\n' | " + quoted(MARTI_PROGRAM) + " run -");
  EXPECT_EQ(wrong.status, 2);
  EXPECT_TRUE(says(wrong, "standard input:2: machine.nods: unknown key")) << "with its line";
  const Outcome endless = shell("yes '# long' | " + quoted(MARTI_PROGRAM) + " run -");
  EXPECT_EQ(endless.status, 2);
  EXPECT_TRUE(says(endless, "standard input: is longer than 1 MiB"));
  expect_refused("run - < /", "standard input: cannot be read");
}

TEST(Command, AnInterruptedRunLeavesNoFile) {
  const TemporaryDirectory directory;
  const Outcome outcome = shell(
      "timeout --preserve-status -s INT 0.3 " + quoted(MARTI_PROGRAM) + " run " + shipped("marti.toml") +
      " --set image.width=2000 --set image.height=2000 -o " + quoted(directory.path() / "out"));
  EXPECT_EQ(outcome.status, 130) << outcome.output;
  EXPECT_TRUE(!fs::exists(directory.path() / "out") || fs::is_empty(directory.path() / "out"));
}

}  // namespace
}  // namespace marti::test
