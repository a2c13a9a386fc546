// The answers of the reports of a sweep and of a run.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "studies/report/model/answer_text.h"
#include "studies/report/model/run_answer.h"
#include "studies/report/model/sweep_answer.h"
#include "tests/support/user_error.h"

namespace marti::studies {

using namespace report;
using namespace tables;

namespace {

using Json = nlohmann::ordered_json;
using test::user_error_of;

// Machines along one axis of numbers, with a price and a frame time each.
ReportPoints line_of(const std::vector<std::pair<double, double>>& offers) {
  ReportPoints sweep;
  ReportAxis axis;
  axis.name = "machine.nodes";
  axis.numeric = true;
  for (std::size_t i = 0; i < offers.size(); ++i) {
    axis.values.emplace_back(static_cast<std::int64_t>(i + 1));
    axis.texts.push_back(std::to_string(i + 1));
    ReportPoint point;
    point.ordinal = static_cast<std::int64_t>(i);
    point.place = {i};
    point.figures = {{"price", offers[i].first}, {"end", offers[i].second}};
    sweep.points.push_back(point);
  }
  sweep.axes.push_back(axis);
  sweep.planned = offers.size();
  return sweep;
}

std::string all_of(const ReportPoints& sweep) {
  std::string text;
  for (const std::string& sentence : answer_of(sweep, choose(sweep))) {
    text += sentence + "\n";
  }
  return text;
}

TEST(AnswerOfSweep, SaysWhatWouldHelpWhereThatIsKnown) {
  ReportPoints sweep = line_of({{1, 100}, {2, 50}});
  EXPECT_EQ(all_of(sweep).find("What would help"), std::string::npos);
  sweep.points[1].advice = "node.clock: some";
  EXPECT_NE(all_of(sweep).find("What would help it, measured: node.clock: some."), std::string::npos);
}

TEST(Choose, TakesTheFrontOfOneFrameOnly) {
  ReportPoints sweep = line_of({{1, 10}, {2, 100}, {3, 50}, {4, 45}});
  sweep.points[1].frame = sweep.points[2].frame = sweep.points[3].frame = 1;
  sweep.frames = 2;
  EXPECT_EQ(choose(sweep).front, std::vector<std::size_t>{0});
  sweep.points[0].figures["end"] = 60;
  EXPECT_EQ(choose(sweep).front, (std::vector<std::size_t>{1, 2, 3}));
  EXPECT_EQ(choose(sweep).fastest, 3U);
}

TEST(AnswerOfSweep, ComparesTheSameWorkOnly) {
  ReportPoints sweep = line_of({{4, 10}, {4, 40}});
  EXPECT_EQ(all_of(sweep).find("different frames"), std::string::npos);
  sweep.points[1].frame = 1;
  sweep.frames = 2;
  const std::string text = all_of(sweep);
  EXPECT_NE(text.find("The only machine compared takes"), std::string::npos) << text;
  EXPECT_NE(text.find("The sweep has 2 different frames"), std::string::npos) << text;
  EXPECT_NE(text.find("are compared here: machine.nodes = 1."), std::string::npos) << text;
  EXPECT_EQ(text.find("What to change"), std::string::npos) << "the next value is other work\n" << text;
}

// Beside a search through all machines.
TEST(Choose, TakesTheFastestWithinTheBudget) {
  const ReportPoints sweep = line_of({{5, 90}, {3, 70}, {3, 60}, {8, 20}, {6, 60}, {9, 20}});
  for (int budget = 0; budget <= 10; ++budget) {
    const Chosen chosen = choose(sweep, budget);
    double shortest = 1e9;
    for (const ReportPoint& point : sweep.points) {
      if (point.figure("price") <= budget) {
        shortest = std::min(shortest, point.figure("end"));
      }
    }
    ASSERT_EQ(chosen.within.has_value(), shortest < 1e9) << budget;
    if (chosen.within) {
      EXPECT_EQ(sweep.points[*chosen.within].figure("end"), shortest) << budget;
      EXPECT_LE(sweep.points[*chosen.within].figure("price"), budget);
    }
    EXPECT_EQ(choose(sweep).within, std::nullopt);
  }
}

TEST(AnswerOfSweep, AdvisesGainsUpAndDown) {
  // All prices are equal, so the best machine is the fastest, in the middle or at an end.
  EXPECT_NE(
      all_of(line_of({{1, 50}, {1, 40}, {1, 60}})).find("no single step of a numeric axis saves 0.05 %"),
      std::string::npos);
  // The knee is the second of three on the front.
  const std::string up = all_of(line_of({{1, 1600}, {2, 400}, {1600, 390}}));
  EXPECT_NE(up.find("machine.nodes from 2 to 3 makes the frame 2.5 % shorter"), std::string::npos) << up;
  // The knee is the second here too, but its better neighbour has fewer nodes.
  const std::string down = all_of(line_of({{1600, 390}, {2, 400}, {1, 1600}}));
  EXPECT_NE(down.find("machine.nodes from 2 to 1 makes the frame 2.5 % shorter"), std::string::npos) << down;
  EXPECT_EQ(down.find("longer"), std::string::npos) << down;
}

TEST(Choose, DrawsTheLineOfTheKneeFromFreeMachinesToo) {
  // With the logarithm of almost nothing for 0, a machine next to the fastest would lie deepest below the
  // line.
  ReportPoints sweep = line_of({{0, 1000}, {1, 300}, {2, 290}, {10, 250}});
  EXPECT_EQ(choose(sweep).knee, 1U);
  EXPECT_EQ(choose(line_of({{0, 1000}})).knee, 0U);
  const std::string text = all_of(line_of({{0, 1000}, {1, 1000}}));
  EXPECT_EQ(text.find("nan"), std::string::npos) << text;
}

const char* const whole_run =
    R"({"figures": {"machine": {"end": 2000000, "speed_up": 3, "efficiency": 0.75, "lost_contention": 1.0,
  "lost_extra_misses": 0, "lost_imbalance": 0, "lost_overhead": 0, "lost_idle": 0,
  "nodes": 4, "clusters": 1}},
  "machine": {"bounds": {"frame_time_at_least_ps": 1000000, "by": "computing",
  "prediction": {"saturation_nodes": 11.0, "mean_value_error": -0.125}}}})";

TEST(AnswerOfRun, BoundsThisMachineOnly) {
  const std::vector<std::string> answer = answer_of(RunJson(Json::parse(whole_run), "f"), "one node");
  ASSERT_EQ(answer.size(), 4U);
  EXPECT_EQ(answer[0],
            "A frame takes 2.000 us on 4 nodes: 3.00 times as fast as one node, an efficiency of 75.0 %.");
  EXPECT_EQ(
      answer[2],
      "With the work shared out as it is, this machine needs at least 1.000 us (computing): less waiting "
      "could gain 50.0 % at most.");
  EXPECT_NE(answer[3].find("-12.5 % off"), std::string::npos);
}

TEST(AnswerOfRun, SaysThatAFrameTakesNoTime) {
  Json run = Json::parse(whole_run);
  run["figures"]["machine"]["end"] = 0;
  EXPECT_EQ(user_error_of([&] { (void)answer_of(RunJson(run, "f"), "one node"); }),
            "f: the frame takes no time on this machine, so there is nothing to report");
}

TEST(AnswerOfRun, NamesTheFieldThatIsWrong) {
  const std::string figures = "/figures/machine";
  const std::string bounds = "/machine/bounds";
  const std::vector<std::string> required = {figures + "/end", figures + "/nodes", figures + "/clusters",
                                             figures + "/efficiency"};
  const std::vector<std::string> optional = {
      figures + "/speed_up", bounds + "/frame_time_at_least_ps", bounds + "/prediction/saturation_nodes",
      bounds + "/prediction/mean_value_error", figures + "/lost_contention"};
  const auto error = [&](const std::string& field, const Json& value) {
    Json run = Json::parse(whole_run);
    run[Json::json_pointer(field)] = value;
    return user_error_of([&] { (void)answer_of(RunJson(run, "some/result.json"), "one node"); });
  };
  const auto expect_refused = [&](const std::string& field) {
    for (const Json& value : {Json("4"), Json(true), Json(-1e300), Json(1e300), Json(Json::array())}) {
      const std::string message = error(field, value);
      EXPECT_NE(message.find("some/result.json: has no number \""), std::string::npos)
          << field << value << message;
      EXPECT_NE(message.find(field.substr(field.rfind('/') + 1)), std::string::npos) << message;
    }
  };
  for (const std::string& field : required) {
    expect_refused(field);
    EXPECT_NE(error(field, nullptr), "no UserError") << field;
  }
  for (const std::string& field : optional) {
    expect_refused(field);
    EXPECT_EQ(error(field, nullptr), "no UserError") << field;
  }
  EXPECT_NE(error(figures + "/end", 0), "no UserError");
  EXPECT_NE(error(figures + "/nodes", 0), "no UserError");
}

}  // namespace
}  // namespace marti::studies
