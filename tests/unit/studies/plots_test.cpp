// The charts of a report as files, drawn by node and rsvg-convert; programs that fail in every possible way.
#include "studies/report/plots/plots.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "sim/files.h"
#include "studies/report/model/chart_library.h"
#include "studies/report/plots/child_process.h"
#include "studies/report/plots/vega_bundle.h"
#include "tests/support/user_error.h"

namespace marti::studies {

using namespace report;

namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using namespace std::chrono_literals;
using test::user_error_of;

ChildProcess shell(const std::string& script, std::chrono::seconds limit = 20s) {
  return {{"sh", "-c", script}, "dash", {}, limit};
}

TEST(ChildProcess, GivesItsOutputForItsInput) {
  std::string much;
  for (int i = 0; i < 500'000; ++i) {
    much += std::to_string(i) + "\n";
  }
  EXPECT_EQ(run_child({{"cat"}, "coreutils", {}, 20s}, much), much);
  EXPECT_EQ(run_child({{"true"}, "coreutils", {}, 20s}, much), "");  // reads nothing of it
  EXPECT_EQ(run_child({{"cat"}, "coreutils", {}, 20s}, ""), "");
}

TEST(ChildProcess, HasTheEnvironmentWithWhatIsAdded) {
  ChildProcess child = shell("echo \"$MARTI_ADDED,${PATH:+path}\"");
  child.environment = {"MARTI_ADDED=new"};
  EXPECT_EQ(run_child(child, ""), "new,path\n");
}

TEST(ChildProcess, HearsSignals) {
  EXPECT_THAT(user_error_of([] { run_child(shell("kill -INT $$; sleep 20"), ""); }),
              HasSubstr("sh was ended by signal 2"));
}

TEST(ChildProcess, ThatFailsSaysWhy) {
  EXPECT_EQ(user_error_of([] { run_child(shell("echo out; echo bad luck >&2; exit 3"), ""); }),
            "sh failed with status 3: bad luck");
  EXPECT_THAT(user_error_of([] { run_child(shell("exit 3"), ""); }), HasSubstr("says nothing"));
  EXPECT_EQ(
      user_error_of([] {
        run_child({{"marti-no-such-program"}, "some-package", {}, 20s}, "");
      }),
      "marti-no-such-program is needed for this and cannot be started: No such file or directory (Debian "
      "package: some-package)");
}

TEST(ChildProcess, IsEndedWhenItTakesTooLongOrWritesTooMuch) {
  EXPECT_THAT(user_error_of([] { run_child(shell("exec sleep 60", 1s), ""); }),
              HasSubstr("longer than 1 seconds"));
  EXPECT_THAT(user_error_of([] { run_child(shell("exec >&- 2>&-; exec sleep 60", 1s), ""); }),
              HasSubstr("longer than 1 seconds"));
  EXPECT_THAT(user_error_of([] {
                run_child({{"yes"}, "coreutils", {}, 20s}, "", 1000);
              }),
              HasSubstr("wrote more than"));
}

ReportChart chart(const std::string& name) {
  ReportChart made;
  made.name = name;
  made.spec = {{"data", {{"values", {{{"nodes", 1}, {"speedup", 1.0}}, {{"nodes", 64}, {"speedup", 48.5}}}}}},
               {"width", "container"},
               {"mark", {{"type", "line"}, {"point", true}}},
               {"encoding",
                {{"x", {{"field", "nodes"}, {"type", "quantitative"}}},
                 {"y", {{"field", "speedup"}, {"type", "quantitative"}}}}}};
  return made;
}

ReportData report_of(const std::vector<ReportChart>& charts) {
  ReportData report;
  report.charts = charts;
  return report;
}

// Two sizes by two kinds of interconnect; one of the points has no frame time, and the page begins with it.
nlohmann::ordered_json four_points() {
  return nlohmann::ordered_json::parse(
      R"({"axis": 0, "start": 2, "fastest": 0, "ordinal": [0, 1, 2, 4], "place": [[0, 1, 0, 1], [0, 0, 1, 1]],
          "axes": [{"name": "size", "texts": ["1 KiB", "2 KiB"], "values": [1024, 2048], "numeric": true, "x": {}},
                   {"name": "kind", "texts": ["bus", "ideal"], "values": [], "numeric": false}],
          "fronts": {"price": [3]},
          "columns": {"end": [1.5, 2, null, 4], "bound": [1, 1, 1, 1], "price": [1, 2, 3, 4]}})");
}

class Plots : public testing::Test {
 protected:
  void SetUp() override {
    if (!have_vega_scripts()) {
      GTEST_SKIP() << "built without the scripts that draw";
    }
    directory_ = fs::path(testing::TempDir()) /
                 ("plots_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(directory_);
  }
  void TearDown() override { fs::remove_all(directory_); }

  [[nodiscard]] std::string drawing(const std::vector<ReportChart>& charts) const {
    return user_error_of(
        [&] { static_cast<void>(draw_plots(report_of(charts), directory_, /*pdf=*/false)); });
  }

  fs::path directory_;
};

TEST_F(Plots, AreDrawnWithTheirData) {
  const std::vector<Plot> plots =
      draw_plots(report_of({chart("speedup"), chart("other")}), directory_, /*pdf=*/true);
  std::vector<std::string> files;
  for (const Plot& plot : plots) {
    files.push_back(plot.file);
  }
  ASSERT_THAT(files, testing::ElementsAre("speedup.svg", "speedup.csv", "speedup.pdf", "other.svg",
                                          "other.csv", "other.pdf"));
  EXPECT_THAT(plots[0].content, testing::StartsWith("<svg "));
  EXPECT_THAT(plots[0].content, HasSubstr("nodes: 64; speedup: 48.5"));  // the mark's accessible name
  EXPECT_EQ(plots[1].content, "nodes,speedup\r\n1,1.0\r\n64,48.5\r\n");
  EXPECT_THAT(plots[2].content, testing::StartsWith("%PDF-"));
  EXPECT_FALSE(fs::exists(directory_));
}

// Of points on one axis those of the line through the point that the explorer starts at.
TEST_F(Plots, HaveTheRowsOfTheExplorer) {
  ReportChart prices = chart("prices");
  prices.spec["data"]["values"] = nlohmann::ordered_json::array();
  prices.live = {{"rows", "all"}, {"by", "price"}};
  ReportChart slice = prices;
  slice.name = "slice";
  slice.live = {{"rows", "slice"}, {"axis", 0}, {"fields", {"end"}}};
  ReportData report = report_of({prices, slice});
  report.explorer = four_points();
  const std::vector<Plot> plots = draw_plots(report, directory_, /*pdf=*/false);
  ASSERT_EQ(plots.size(), 4U);
  EXPECT_EQ(plots[1].content,
            "ordinal,machine,price,ms,front\r\n"
            "0,\"size = 1 KiB, kind = bus\",1,1.5,0\r\n1,\"size = 2 KiB, kind = bus\",2,2,0\r\n"
            "2,\"size = 1 KiB, kind = ideal\",3,,0\r\n4,\"size = 2 KiB, kind = ideal\",4,4,1\r\n");
  EXPECT_EQ(plots[3].content, "ordinal,value,end\r\n2,1 KiB,\r\n4,2 KiB,4\r\n");
}

// Over sizes exact points are joined, over names they are bars; the colours of the other axis show its other
// points.
TEST_F(Plots, HaveBarsForNamesAndColoursForAnotherAxis) {
  const auto drawn = [&](int axis, const nlohmann::ordered_json& colour) {
    const ReportChart curve = live_chart("over_axis", "curve", "T", {{"rows", "explorer"}, {"title", "Time"}},
                                         {{"FIGURE", "ms"}, {"TITLE", "frame time, ms"}});
    ReportData report = report_of({curve});
    report.explorer = four_points();
    report.explorer["axis"] = axis;
    report.explorer["colour"] = colour;
    return draw_plots(report, directory_, /*pdf=*/false);
  };
  const std::vector<Plot> sizes = drawn(0, nullptr);
  EXPECT_THAT(sizes[0].content, HasSubstr("Time over size"));
  EXPECT_THAT(sizes[0].content, testing::Not(HasSubstr("ordinal: 4; colour")));
  EXPECT_EQ(sizes[1].content,
            "kind,ordinal,value,ms,ms_bound,x\r\nexact,2,1 KiB,,1,1024\r\nexact,4,2 KiB,4,1,2048\r\n");
  const std::vector<Plot> coloured = drawn(0, 1);
  EXPECT_THAT(coloured[1].content, HasSubstr("other,0,bus,1 KiB,1.5,1,1024\r\n"));
  EXPECT_THAT(coloured[1].content, HasSubstr("exact,4,ideal,2 KiB,4,1,2048\r\n"));
  EXPECT_THAT(coloured[0].content, HasSubstr("mark-line"));
  const std::vector<Plot> names = drawn(1, 0);
  EXPECT_THAT(names[0].content, HasSubstr("Time over kind"));
  EXPECT_THAT(names[0].content, HasSubstr("roledescription=\"bar\""));
  EXPECT_THAT(names[0].content, testing::Not(HasSubstr("mark-line")));
  EXPECT_THAT(names[1].content, HasSubstr("exact,0,1 KiB,bus,1.5,1\r\n"));
  EXPECT_THAT(names[1].content, HasSubstr("other,4,2 KiB,ideal,4,1\r\n"));
}

// Simulated points with bounds, the ideal and the saturation of the last point.
TEST_F(Plots, HaveBoundAndSaturationOfThePoints) {
  const ReportChart curve = live_chart("over_axis", "curve", "T", {{"rows", "explorer"}},
                                       {{"FIGURE", "ms"}, {"TITLE", "frame time, ms"}});
  ReportData report = report_of({curve});
  report.explorer = nlohmann::ordered_json::parse(
      R"({"axis": 0, "start": 0, "place": [[0, 1, 2]], "ordinal": [0, 1, 2],
          "axes": [{"name": "machine.nodes", "texts": ["1", "2", "4"], "values": [1, 2, 4], "numeric": true}],
          "columns": {"end": [8, 4, 2], "speed_up": [1, 2, 4], "efficiency": [1, 1, 1],
                      "bound": [8, 2, 1], "saturation": [5, 4, 3]}})");
  const std::vector<Plot> plots = draw_plots(report, directory_, /*pdf=*/false);
  ASSERT_EQ(plots.size(), 2U);
  EXPECT_EQ(plots[1].content,
            "kind,ordinal,value,ms,ms_bound,x,speed_up,speed_up_bound,ideal\r\n"
            "exact,0,1,8,8,1,1,1,1\r\n"
            "exact,1,2,4,2,2,2,4,2\r\n"
            "exact,2,4,2,1,4,4,8,4\r\n"
            "saturation,,,,,3,,,\r\n");
}

TEST_F(Plots, AreTheSameBytesAgain) {
  const std::vector<Plot> plots = draw_plots(report_of({chart("speedup")}), directory_, /*pdf=*/true);
  const std::vector<Plot> again = draw_plots(report_of({chart("speedup")}), directory_, /*pdf=*/true);
  ASSERT_EQ(plots.size(), again.size());
  for (std::size_t i = 0; i < plots.size(); ++i) {
    EXPECT_EQ(plots[i].content, again[i].content) << plots[i].file;
  }
}

TEST_F(Plots, OfAChartThatCannotBeDrawnAreRefused) {
  ReportChart bad = chart("bad");
  bad.spec["mark"] = "no such mark";
  EXPECT_THAT(drawing({chart("speedup"), bad}), HasSubstr("chart bad cannot be drawn: "));
}

TEST_F(Plots, OfOneNameAreRefused) {
  EXPECT_THAT(drawing({chart("speedup"), chart("other"), chart("speedup")}),
              HasSubstr("chart \"speedup\": there are two of this name"));
}

TEST_F(Plots, HoldNothingFromElsewhere) {
  const std::string secret = (fs::path(testing::TempDir()) / "secret.json").string();
  sim::write_file(secret, "[{\"nodes\": 77, \"speedup\": 1}]");
  for (const std::string& url : {secret, "file://" + secret, std::string("http://127.0.0.1:9/x.json")}) {
    ReportChart bad = chart("bad");
    bad.spec["data"] = {{"url", url}};
    EXPECT_THAT(drawing({bad}), HasSubstr("it refers to " + url)) << url;
  }
  ReportChart image = chart("image");
  image.spec["mark"] = {{"type", "image"}, {"url", "http://127.0.0.1:9/x.png"}};
  EXPECT_THAT(drawing({image}), HasSubstr("it refers to http://127.0.0.1:9/x.png"));
  fs::remove(secret);
}

TEST_F(Plots, NeverReplaceResults) {
  fs::create_directories(directory_);
  sim::write_file(directory_ / "results.sqlite", "");
  EXPECT_THAT(drawing({chart("speedup")}), HasSubstr("holds results (results.sqlite)"));
}

TEST_F(Plots, RefuseNamesThatAreNoFiles) {
  for (const char* const name : {"", ".", "..", "a/b", "../x", ".hidden", "new\nline"}) {
    EXPECT_THAT(drawing({chart(name)}), HasSubstr("cannot be the name of a file")) << name;
  }
  EXPECT_FALSE(fs::exists(directory_));
}

}  // namespace
}  // namespace marti::studies
