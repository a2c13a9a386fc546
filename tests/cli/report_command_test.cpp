// `marti report` as its user runs it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "sim/sha256.h"
#include "studies/report/plots/vega_bundle.h"
#include "tests/cli/printed_json.h"
#include "tests/support/csv_records.h"
#include "tests/support/temporary_directory.h"

namespace marti::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::string sweep_text = R"([scene]
source = "teapot:2"
[image]
width = 20
height = 20
[costs]
preset = "unit"
[sweep.axes]
machine.nodes = [1, 2, 4, 8]
cache.size = ["1 KiB", "2 KiB", "4 KiB"]
"interconnect.kind" = ["bus", "crossbar"]
[prices]
node = 1
cache_kib = 0.25
[energy]
preset = "22nm"
l1_read = 2
l1_write = 3
l1_area = 0.01
)";

// The data that the page gives to its scripts.
json data_of(const fs::path& file) {
  const std::string page = read(file);
  const std::string begin = "id=\"data\">";
  const std::size_t from = page.find(begin) + begin.size();
  return json::parse(page.substr(from, page.find("</script>", from) - from), nullptr, false);
}

bool has_chart(const json& data, const std::string& name) {
  for (const json& chart : data["charts"]) {
    if (chart["name"] == name) {
      return true;
    }
  }
  return false;
}

class ReportCommand : public testing::Test {
 protected:
  void SetUp() override {
    if (!studies::report::have_vega_scripts()) {
      GTEST_SKIP() << "built without the scripts of the report";
    }
  }
  [[nodiscard]] fs::path place(const std::string& name) const { return directory_.path() / name; }

  [[nodiscard]] fs::path made_run(const std::string& more = "") const {
    return made("run", "run " + small_run + more);
  }
  [[nodiscard]] fs::path made_sweep() const {
    write(place("sweep.toml"), sweep_text);
    return made("sweep", "sweep " + quoted(place("sweep.toml")) + " --quiet");
  }
  [[nodiscard]] fs::path made_study() const {
    return made("study", "study paper " + shipped("paper.toml") +
                             " --set image.width=8 --set image.height=6 --set 'paper.scenes=[\"tetra:2\"]'"
                             " --set 'paper.run_scenes=[\"teapot:2:pot\"]' --set 'paper.run_depths=[2]'");
  }
  /// A copy of what the command writes; it runs once for all tests.
  [[nodiscard]] fs::path made(const std::string& name, const std::string& command) const {
    static const TemporaryDirectory originals;
    static std::map<std::string, fs::path> known;
    const std::string what =
        name == "sweep" ? name : command;  // the sweep's file has another place each time
    if (!known.contains(what)) {
      const fs::path out = originals.path() / std::to_string(known.size());
      const Outcome outcome = marti(command + " -o " + quoted(out));
      EXPECT_EQ(outcome.status, 0) << outcome.output;
      known[what] = out;
    }
    fs::copy(known[what], place(name), fs::copy_options::recursive);
    return place(name);
  }

  TemporaryDirectory directory_;
};

TEST_F(ReportCommand, ReportsARun) {
  const fs::path run = made_run(
      " --set count.attribution=true --set count.working_set=true --set record.heat_maps=true"
      " --set record.critical_path=true --set record.interval=100us --set energy.preset=45nm");
  const Outcome made = marti("report " + quoted(run));
  ASSERT_EQ(made.status, 0) << made.output;
  const json result = json::parse(read(run / "result.json"));
  const std::string page = read(run / "report.html");
  EXPECT_TRUE(says(made, "wrote " + (run / "report.html").string()));
  std::string helps = "What helps: " + result["machine"]["what_helps"]["sentence"].get<std::string>() + ".";
  helps.replace(helps.find("->"), 2, "-&gt;");
  EXPECT_NE(page.find(helps), std::string::npos) << helps;
  EXPECT_NE(page.find("What would make the frame shorter"), std::string::npos);
  const json data = data_of(run / "report.html");
  EXPECT_NE(page.find("<img alt=\"The image\" src=\"data:image/png;base64,"), std::string::npos);
  // Each heat map has the scale of its colours.
  for (const char* heat : {"cycles", "misses", "waits"}) {
    const double brightest = result["heat_maps"][heat]["brightest"];
    EXPECT_LE(brightest, result["heat_maps"][heat]["largest"].get<double>());
    const bool one = brightest == 1.0;
    const std::string unit = std::string(heat) == "misses" ? one ? " miss" : " misses"
                             : one                         ? " cycle"
                                                           : " cycles";
    EXPECT_NE(page.find(fmt::format("<span>{:g}{} or more</span>", brightest, unit)), std::string::npos)
        << heat;
  }
  EXPECT_NE(page.find("Heat map: misses"), std::string::npos);
  for (const char* name :
       {"run_cycles", "run_loss", "run_nodes", "run_references", "run_level_accesses", "run_level_hit_ratio",
        "run_waits", "run_tree", "run_level_memory", "run_memory", "run_path", "run_energy", "run_power",
        "run_intervals", "run_bandwidth", "working_set"}) {
    EXPECT_TRUE(has_chart(data, name)) << name;
    EXPECT_NE(page.find("id=\"chart-" + std::string(name) + "\""), std::string::npos) << name;
  }
  std::int64_t shown = 0;
  for (const json& row : data["charts"][0]["spec"]["data"]["values"]) {
    shown += row["ps"].get<std::int64_t>();
  }
  const json& figures = result["figures"]["machine"];
  EXPECT_EQ(shown, figures["end"].get<std::int64_t>() * figures["nodes"].get<std::int64_t>());
}

TEST_F(ReportCommand, ReportsASweepWithItsBounds) {
  const fs::path sweep = made_sweep();
  const Outcome made = marti("report " + quoted(sweep) + " -o " + quoted(place("page.html")));
  ASSERT_EQ(made.status, 0) << made.output;
  EXPECT_TRUE(says(made, "The fastest of 24 machines"));
  const json data = data_of(place("page.html"));
  for (const char* name : {"frame_time", "speed_up", "efficiency", "cycles", "utilisation",
                           "interconnect_waits", "bank_waits", "hit_ratio_cache_size", "price", "energy"}) {
    EXPECT_TRUE(has_chart(data, name)) << name;
  }
  const json& explorer = data["explorer"];
  ASSERT_EQ(explorer["axes"].size(), 3U);
  EXPECT_EQ(explorer["ordinal"].size(), 24U);
  EXPECT_EQ(explorer["axes"][explorer["axis"].get<std::size_t>()]["name"], "machine.nodes");
  // No frame is shorter than its bound.
  for (std::size_t point = 0; point < 24; ++point) {
    const double bound = explorer["columns"]["bound"][point];
    EXPECT_GT(bound, 0.0);
    EXPECT_LE(bound, explorer["columns"]["end"][point].get<double>() * (1.0 + 1e-6)) << point;
    EXPECT_GT(explorer["columns"]["saturation"][point].get<double>(), 0.0);
  }
}

TEST_F(ReportCommand, NamesTheBestMachineWithinABudget) {
  const std::string sweep = quoted(made_sweep());
  const std::string page = " -o " + quoted(place("page.html"));
  const Outcome all = marti("report " + sweep + page + " --budget 1000");
  ASSERT_EQ(all.status, 0) << all.output;
  EXPECT_TRUE(says(all, "The fastest within a budget of 1000: "));
  EXPECT_EQ(data_of(place("page.html"))["explorer"]["budget"], 1000);
  const Outcome none = marti("report " + sweep + page + " --budget 0");
  EXPECT_TRUE(says(none, "No machine is within a budget of 0; the cheapest is "));
  const std::string before = read(place("page.html"));
  for (const char* bad : {"-1", "nan", "inf"}) {
    EXPECT_EQ(marti("report " + sweep + page + " --budget=" + bad).status, 2) << bad;
  }
  const fs::path alike = made("alike", "sweep " + quoted(fs::path(MARTI_SOURCE) / "configs" / "marti.toml") +
                                           " --quiet --set image.width=8 --set image.height=8 --set "
                                           "scene.source=tetra:1 --axis cache.line=16B,32B");
  const Outcome unpriced = marti("report " + quoted(alike) + page + " --budget 1000");
  EXPECT_EQ(unpriced.status, 2);
  EXPECT_NE(unpriced.output.find("have the same cost by [prices]"), std::string::npos) << unpriced.output;
  const Outcome run = marti("report " + sweep + ":1" + page + " --budget 9");
  EXPECT_EQ(run.status, 2);
  EXPECT_TRUE(says(run, "--budget: chooses among the machines of a sweep"));
  EXPECT_EQ(read(place("page.html")), before);
}

TEST_F(ReportCommand, ReportsAStudy) {
  const std::string study = quoted(made_study());
  const Outcome made = marti("report " + study);
  ASSERT_EQ(made.status, 0) << made.output;
  const json data = data_of(place("study") / "report.html");
  EXPECT_EQ(data["kind"], "study");
  EXPECT_TRUE(has_chart(data, "figure3"));
  // Charts are made of the tables: nothing that stands in their files gets into the page.
  const std::string page = read(place("study") / "report.html");
  write(place("study") / "figure3.vl.json",
        R"({"$schema": "vega-lite", "data": {"url": "http://example.org"}})");
  write(place("study") / "more.vl.json", "{");
  EXPECT_EQ(marti("report " + study).status, 0);
  EXPECT_EQ(read(place("study") / "report.html"), page);
}

TEST_F(ReportCommand, AStudysPageBeginsWithItsVerdict) {
  const fs::path cases = made("cases",
                              "study stability --set scene.source=tetra:3 --set stability.rays=100 --set "
                              "'stability.only=[\"cracks\",\"no-time\"]'");
  ASSERT_EQ(marti("report " + quoted(cases)).status, 0);
  const auto says = [&](const std::string& sentence) {
    return read(cases / "report.html").find(sentence) != std::string::npos;
  };
  EXPECT_TRUE(says("2 of 2 cases pass."));
  const std::string change =
      "import sqlite3, sys; c = sqlite3.connect(sys.argv[1]); c.execute('UPDATE stability "
      "SET verdict = ?, figure = ? WHERE rowid = 1', ('FAIL', '3 cracks')); c.commit()";
  ASSERT_EQ(shell("python3 -c \"" + change + "\" " + quoted(cases / "results.sqlite")).status, 0);
  ASSERT_EQ(marti("report " + quoted(cases)).status, 0);
  EXPECT_TRUE(says("1 of 2 cases passes; the other:"));
  EXPECT_TRUE(says("cracks: 3 cracks (FAIL)."));
  // What was not measured is no claim that failed.
  const std::string unmeasured =
      change.substr(0, change.find("('FAIL'")) + "('not measured', None)); c.commit()";
  ASSERT_EQ(shell("python3 -c \"" + unmeasured + "\" " + quoted(cases / "results.sqlite")).status, 0);
  ASSERT_EQ(marti("report " + quoted(cases)).status, 0);
  EXPECT_TRUE(says("1 of 1 case passes."));
  EXPECT_TRUE(says("Not measured here: cracks."));
}

TEST_F(ReportCommand, GivesTheSameBytesTwice) {
  const fs::path sweep = made_sweep();
  ASSERT_EQ(marti("report " + quoted(sweep) + " -o " + quoted(place("a.html"))).status, 0);
  ASSERT_EQ(marti("report " + quoted(sweep) + " -o " + quoted(place("b.html"))).status, 0);
  EXPECT_EQ(read(place("a.html")), read(place("b.html")));
}

TEST_F(ReportCommand, ReportsWhereNothingMayBeWritten) {
  const fs::path sweep = made_sweep();
  const std::string page = quoted(place("page.html"));
  const Outcome made =
      shell("chmod a-w " + quoted(sweep) + " && " + quoted(MARTI_PROGRAM) + " report " + quoted(sweep) +
            " -o " + page + "; status=$?; chmod u+w " + quoted(sweep) + "; exit $status");
  EXPECT_EQ(made.status, 0) << made.output;
  EXPECT_GT(fs::file_size(place("page.html")), 500'000U);
}

TEST_F(ReportCommand, RefusesWhatIsNoResultAndLeavesThePageAlone) {
  const fs::path run = made_run();
  ASSERT_EQ(marti("report " + quoted(run)).status, 0);
  const std::string before = read(run / "report.html");
  const std::string result = read(run / "result.json");
  const auto refused = [&](const std::string& text, const std::string& complaint) {
    write(run / "result.json", text);
    const Outcome outcome = marti("report " + quoted(run));
    EXPECT_EQ(outcome.status, 2) << outcome.output;
    EXPECT_TRUE(says(outcome, complaint));
    EXPECT_TRUE(says(outcome, "result.json"));
    EXPECT_EQ(read(run / "report.html"), before);
  };
  refused(result.substr(0, result.size() / 2), "is not JSON");
  refused("{\"marti\": {\"schema\": 9}}", "schema 9");
  refused("{\"marti\": {\"schema\": 4}}", "has no object");
}

TEST_F(ReportCommand, TakesOnlyWhatTheRunHasWritten) {
  const fs::path run = made_run(" --set record.heat_maps=true --set count.working_set=true");
  const Outcome whole = marti("report " + quoted(run));
  ASSERT_EQ(whole.status, 0) << whole.output;
  EXPECT_FALSE(says(whole, "left out"));
  // Another run's files, a link to a file of this run, and one that is gone.
  fs::copy_file(run / "heat-waits.png", run / "exact.png");
  fs::copy_file(run / "heat-waits.png", run / "image.png", fs::copy_options::overwrite_existing);
  fs::rename(run / "heat-cycles.png", run / "other.png");
  fs::create_symlink("other.png", run / "heat-cycles.png");
  fs::remove(run / "heat-misses.png");
  const std::string chart = read(run / "working_set.vl.json");
  write(run / "working_set.vl.json", chart + " ");
  const Outcome changed = marti("report " + quoted(run));
  ASSERT_EQ(changed.status, 0) << changed.output;
  for (const char* note :
       {"exact.png is left out of this page: result.json does not name it.",
        "image.png is left out of this page: it is not the file that this run has written.",
        "heat-cycles.png is left out of this page: it cannot be read, or is no regular file.",
        "heat-misses.png is left out of this page: it is not there",
        "working_set.vl.json is left out of this page: it is not the file"}) {
    EXPECT_TRUE(says(changed, note)) << note;
  }
  const std::string page = read(run / "report.html");
  for (const char* title : {"The image", "The exact image", "Heat map: cycles", "Heat map: misses"}) {
    EXPECT_EQ(page.find("<img alt=\"" + std::string(title)), std::string::npos) << title;
  }
  EXPECT_NE(page.find("<img alt=\"Heat map: waits"), std::string::npos);
  EXPECT_FALSE(has_chart(data_of(run / "report.html"), "working_set"));
}

TEST_F(ReportCommand, RefusesDirectoriesThatHoldNoResults) {
  const auto refused = [&](const fs::path& what, const std::string& complaint) {
    const Outcome outcome = marti("report " + quoted(what));
    EXPECT_EQ(outcome.status, 2) << outcome.output;
    EXPECT_TRUE(says(outcome, complaint));
    EXPECT_FALSE(says(outcome, "internal"));
  };
  refused(place("none"), "there is no such directory");
  write(place("file"), "");
  refused(place("file"), "is no directory");
  fs::create_directory(place("empty"));
  refused(place("empty"), "holds neither");
  write(place("empty") / "results.sqlite", "SQLite format 4");
  refused(place("empty"), "results.sqlite");
  write(place("empty") / "results.sqlite", "");
  refused(place("empty"), "results.sqlite");
  write(place("empty") / "result.json", "{}");
  refused(place("empty"), "holds both");
}

TEST_F(ReportCommand, ReportsAPointOfASweepAsARun) {
  const fs::path sweep = made_sweep();
  const Outcome made = marti("report " + quoted(fs::path(sweep.string() + ":3")));
  ASSERT_EQ(made.status, 0) << made.output;
  EXPECT_TRUE(says(made, "times as fast as its base machine"));
  const json data = data_of(sweep / "point-3.html");
  for (const char* name : {"run_cycles", "run_references", "run_waits"}) {
    EXPECT_TRUE(has_chart(data, name)) << name;
  }
  std::int64_t shown = 0;
  for (const json& row : data["charts"][0]["spec"]["data"]["values"]) {
    shown += row["ps"].get<std::int64_t>();
  }
  const json point = printed_json("sweep " + quoted(place("sweep.toml")) + " -o " + quoted(sweep) +
                                  " 2> /dev/null")["rows"][3];
  EXPECT_EQ(shown, point["end"].get<std::int64_t>() * point["nodes"].get<std::int64_t>());
  expect_refused("report " + quoted(fs::path(sweep.string() + ":99")),
                 "there is no such point; the sweep has 24");
}

// Many nodes for weeks: sums over them exceed 2^63 ps, and are the same reals in all that is written.
TEST_F(ReportCommand, ReadsSumsThatDoNotFit) {
  write(place("slow.toml"),
        "[scene]\nsource = \"teapot:2\"\n[image]\nwidth = 20\nheight = 20\n[machine]\nnodes = 32\n"
        "[host]\nclock = \"1 Hz\"\nlatency_cycles = 1_000_000\n");
  const std::string file = quoted(place("slow.toml"));
  ASSERT_EQ(marti("run " + file + " --no-what-helps -o " + quoted(place("run"))).status, 0);
  ASSERT_EQ(marti("sweep " + file + " --axis cache.line=32B --quiet -o " + quoted(place("sweep"))).status, 0);
  for (const char* what : {"run", "sweep", "sweep:0"}) {
    const Outcome made = marti("report " + quoted(place(what)));
    EXPECT_EQ(made.status, 0) << made.output;
  }
  const json run = json::parse(read(place("run") / "result.json"))["figures"]["machine"];
  EXPECT_GT(run["time_idle"].get<double>(), 0x1p63);
  const std::vector<CsvRecord> csv = read_csv(read(place("sweep") / "points.csv")).value();
  for (std::size_t i = 0; i < csv.at(0).size(); ++i) {
    if (run.contains(csv[0][i])) {
      EXPECT_EQ(std::stod(csv.at(1).at(i)), run[csv[0][i]].get<double>()) << csv[0][i];
    }
  }
  const json compared = printed_json("compare " + quoted(place("run")) + " " + quoted(place("sweep:0")));
  EXPECT_EQ(compared["numbers"], json::array());
}

TEST_F(ReportCommand, ReplacesNothingButPages) {
  const fs::path run = made_run();
  const auto refused = [&](const fs::path& file, const std::string& complaint) {
    const Outcome outcome = marti("report " + quoted(run) + " -o " + quoted(file));
    EXPECT_EQ(outcome.status, 2) << outcome.output;
    EXPECT_TRUE(says(outcome, file.string() + ": "));
    EXPECT_TRUE(says(outcome, complaint));
  };
  const std::string result = read(run / "result.json");
  refused(run / "result.json", "not an HTML page");
  EXPECT_EQ(read(run / "result.json"), result);
  write(place("empty"), "");
  refused(place("empty"), "not an HTML page");
  refused(run, "is no regular file");
  fs::create_symlink("none", place("link"));
  refused(place("link"), "is no regular file");
  write(place("old.html"), "<!doctype HTML>old");
  EXPECT_EQ(marti("report " + quoted(run) + " -o " + quoted(place("old.html"))).status, 0);
  EXPECT_GT(fs::file_size(place("old.html")), 500'000U);
}

TEST_F(ReportCommand, WritesPageAndPlotsTogetherOrNothing) {
  const fs::path run = made_run();
  const std::string plots = " --plots " + quoted(place("plots"));
  expect_refused("report " + quoted(run) + plots + " -o " + quoted(place("none/page.html")),
                 "page.html: cannot be written: ");
  EXPECT_FALSE(fs::exists(place("plots")));
  fs::create_directory(place("plots"));
  expect_refused("report " + quoted(run) + plots + " -o " + quoted(place("run/../plots/run_cycles.svg")),
                 "is also the name of a plot");
  EXPECT_TRUE(fs::is_empty(place("plots")));
  fs::create_directory(place("plots") / "run_tree.svg");
  EXPECT_EQ(marti("report " + quoted(run) + plots).status, 2);
  EXPECT_FALSE(fs::exists(run / "report.html"));
  EXPECT_FALSE(fs::exists(place("plots") / "run_cycles.svg"));
  fs::remove(place("plots") / "run_tree.svg");
  const Outcome made = marti("report " + quoted(run) + plots);
  ASSERT_EQ(made.status, 0) << made.output;
  EXPECT_TRUE(fs::exists(run / "report.html"));
  EXPECT_TRUE(read(place("plots") / "run_cycles.svg").starts_with("<svg "));
  EXPECT_TRUE(fs::exists(place("plots") / "run_cycles.csv"));
}

TEST_F(ReportCommand, TakesNoSavingThatIsNoWholeNumber) {
  const fs::path run = made_run();
  json result = json::parse(read(run / "result.json"));
  result["plan"].front()["counted"]["operations"] = 1e300;
  write(run / "result.json", result.dump());
  const Outcome outcome = marti("report " + quoted(run));
  EXPECT_EQ(outcome.status, 0) << outcome.output;
}

TEST_F(ReportCommand, SaysThatDirIsEmpty) { expect_refused("report ''", "DIR is empty"); }

TEST_F(ReportCommand, SaysWhatPdfNeeds) {
  expect_refused("report " + quoted(made_run()) + " --pdf", "--plots");
}

TEST(ReportWithoutScripts, SaysHowToBuildWithThem) {
  if (studies::report::have_vega_scripts()) {
    GTEST_SKIP() << "built with the scripts of the report";
  }
  const TemporaryDirectory directory;
  const std::string run = quoted(directory.path() / "run");
  ASSERT_EQ(marti("run " + small_run + " -o " + run).status, 0);
  expect_refused("report " + run, "-DMARTI_REPORT=ON");
}

}  // namespace
}  // namespace marti::test
