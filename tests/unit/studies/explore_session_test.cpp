// Answers of an exploration: those of `marti run` with the same settings, byte for byte.
#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <future>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "studies/explore/session.h"
#include "studies/explore/turns.h"
#include "studies/keys/price_keys.h"
#include "studies/keys/setting_value.h"
#include "studies/report/plots/vega_bundle.h"
#include "studies/report/read/read_report.h"
#include "studies/run/run_result.h"
#include "studies/show/result_json.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"

namespace marti::studies {

using namespace explore;
using namespace helps;
using namespace keys;
using namespace run;

namespace {

constexpr const char* text = R"([scene]
source = "tetra:3"
[image]
width = 24
height = 20
[machine]
nodes = 3
[cache]
size = "1 KiB"
ways = 2
[interconnect]
kind = "bus"
clock = "33 MHz"
)";

class Explored : public testing::Test {
 protected:
  Explored() { std::ofstream(file_) << text; }

  [[nodiscard]] std::string run_with(const Settings& settings, Measuring what_helps = Measuring::none) const {
    std::vector<std::string> assignments;
    for (const auto& [key, value] : settings) {
      assignments.push_back(key + "=" + value);
    }
    sim::Schema schema = run_schema();
    declare_price_keys(schema);
    sim::Config config = sim::Config::from_file(schema, file_, assignments);
    RunOptions options;
    options.what_helps = what_helps;
    options.prices = read_given_prices(config);
    return show::json_of(run::run(config, std::move(options)));
  }

  // The refusal's key, or "accepted".
  static std::string refused_key(const std::string& answer) {
    const auto json = nlohmann::json::parse(answer);
    return !json.contains("error") ? "accepted"
           : json["key"].is_null() ? "none"
                                   : json["key"].get<std::string>();
  }

  test::TemporaryDirectory directory_;
  std::filesystem::path file_ = directory_.path() / "explored.toml";
};

TEST_F(Explored, EveryAnswerIsThatOfARun) {
  const Session session(file_, {});
  for (const Settings& settings : std::vector<Settings>{
           {},
           {{"machine.nodes", "7"}},
           {{"machine.nodes", "1"}, {"cache.size", "64 KiB"}},
           {{"cache.ways", "1"}, {"cache.replacement", "random"}, {"packets.width", "4"}},
           {{"interconnect.kind", "crossbar"}, {"memory.banks", "2"}},
           {{"interconnect.kind", "ideal"}},
           {{"machine.clusters", "2"}, {"node.contexts", "2"}},
           {{"build.sharing", "none"}},
           {{"machine.scheme", "pipeline"}, {"machine.nodes", "6"}},
           {{"node.clock", "\"80 MHz\""}, {"energy.preset", "45nm"}},
       }) {
    const std::string expected = [&] {
      try {
        return run_with(settings);
      } catch (const sim::UserError& error) {
        return std::string(error.what());
      }
    }();
    const std::string answer = session.answer(settings, Measuring::none);
    if (expected.starts_with("{")) {
      EXPECT_EQ(answer, expected);
    } else {
      EXPECT_EQ(nlohmann::json::parse(answer)["error"], expected);
    }
  }
}

// What the page shows of it is the report of the result.
TEST_F(Explored, TheAnswerIsShownAsItsReport) {
  const Session session(file_, {});
  const Settings settings = {{"machine.nodes", "7"}};
  for (const Measuring what_helps : {Measuring::none, Measuring::within_budget}) {
    const std::string answer = session.answer(settings, what_helps);
    const auto shown = nlohmann::ordered_json::parse(session.shown(settings, what_helps));
    EXPECT_EQ(shown["result"], nlohmann::ordered_json::parse(answer));
    const report::ReportData report =
        report::report_of_run(tables::RunJson(nlohmann::ordered_json::parse(answer), "answer"));
    EXPECT_EQ(shown["page"]["answer"], report.answer);
    std::vector<std::string> charts;
    for (const report::ReportChart& chart : report.charts) {
      charts.push_back(chart.name);
      EXPECT_NE(shown["page"]["sections"]["charts"].get<std::string>().find("\"chart-" + chart.name + "\""),
                std::string::npos);
    }
    std::vector<std::string> names;
    for (const auto& chart : shown["page"]["charts"]) {
      names.push_back(chart["name"]);
    }
    EXPECT_EQ(names, report::have_vega_scripts() ? charts : std::vector<std::string>());
    const std::string tables = shown["page"]["sections"]["tables"];
    EXPECT_NE(tables.find("Figures of the run"), std::string::npos) << tables.substr(0, 500);
  }
  EXPECT_EQ(refused_key(session.shown({{"machine.nodes", "0"}}, Measuring::none)), "machine.nodes");
}

// A later machine walks the log that was stripped for one before it.
TEST_F(Explored, AnswersDoNotDependOnThoseBefore) {
  const Session session(file_, {});
  for (const char* ways : {"2", "1", "4", "2", "1", "2"}) {
    for (const char* size : {"1 KiB", "2 KiB"}) {
      const Settings settings = {{"cache.ways", ways}, {"cache.size", size}};
      EXPECT_EQ(session.answer(settings, Measuring::within_budget),
                run_with(settings, Measuring::within_budget));
    }
  }
}

// This small frame's packets are all timed, so one node's frame is exact; others are as near as the model is.
TEST_F(Explored, AModelStandsForAnAnswer) {
  const Session session(file_, {"image.width=64", "image.height=64", "scene.source=teapot:2"});
  const auto exact = [&](const Settings& settings) {
    return nlohmann::json::parse(session.answer(settings, Measuring::none));
  };
  for (const Settings& machine :
       {Settings{}, Settings{{"cache.replacement", "fifo"}}, Settings{{"cache.size", "256 B"}},
        Settings{{"interconnect.kind", "crossbar"}}}) {
    for (const char* nodes : {"1", "2", "6", "30"}) {
      Settings settings = machine;
      settings.emplace_back("machine.nodes", nodes);
      const auto model = nlohmann::json::parse(session.modelled(settings));
      const auto run = exact(settings);
      const double end = run["figures"]["machine"]["end"];
      EXPECT_EQ(model["packets"], 64);
      EXPECT_EQ(model["of_packets"], 64);
      EXPECT_EQ(model["end_of_one"].get<double>(), run["machine"]["one_node_time_ps"].get<double>()) << nodes;
      EXPECT_NEAR(model["end"].get<double>() / end, 1.0, std::string(nodes) == "1" ? 0.0 : 0.15) << nodes;
    }
  }
  EXPECT_EQ(session.modelled({{"machine.scheme", "pipeline"}}), "null");
  EXPECT_EQ(session.modelled({{"machine.clusters", "2"}}), "null");
  EXPECT_EQ(refused_key(session.modelled({{"machine.nodes", "0"}})), "machine.nodes");
  EXPECT_EQ(session.modelled({{"machine.nodes", "6"}}), session.modelled({{"machine.nodes", "6"}}));
}

TEST_F(Explored, AnAnswerForNobodyIsGivenUp) {
  const Session session(file_, {});
  sim::WorkMeter stop;
  stop.stop();
  EXPECT_THROW(static_cast<void>(session.answer({{"machine.nodes", "5"}}, Measuring::none, &stop)),
               sim::Stopped);
  sim::WorkMeter go_on;
  EXPECT_EQ(session.answer({{"machine.nodes", "5"}}, Measuring::none, &go_on),
            run_with({{"machine.nodes", "5"}}));
}

// A replay that has begun ends when somebody moves on, and the next answer is as exact as any.
TEST_F(Explored, AReplayThatHasBegunIsGivenUp) {
  const Session session(file_,
                        {"image.width=256", "image.height=256", "packets.width=1", "packets.height=1"});
  const Settings settings = {{"machine.nodes", "5"}, {"cache.size", "128 B"}};
  for (const char* const part : {"taking known references out", "timing the machine and one node"}) {
    // On a busy computer the thread that moves may get no time until the part is over: then once more.
    bool was_given_up = false;
    for (int attempt = 0; attempt < 50 && !was_given_up; ++attempt) {
      sim::WorkMeter meter;
      std::atomic<bool> over = false;
      const std::jthread mover([&] {
        while (!over && (meter.state().part != part || meter.state().done == 0)) {
        }
        meter.stop();
      });
      try {
        static_cast<void>(session.answer(settings, Measuring::none, &meter));
      } catch (const sim::Stopped&) {
        const sim::WorkMeter::State at_end = meter.state();
        was_given_up = at_end.part == part && at_end.done < at_end.of;
      }
      over = true;
    }
    EXPECT_TRUE(was_given_up) << part;
  }
  EXPECT_EQ(session.answer(settings, Measuring::none), run_with({{"image.width", "256"},
                                                                 {"image.height", "256"},
                                                                 {"packets.width", "1"},
                                                                 {"packets.height", "1"},
                                                                 {"machine.nodes", "5"},
                                                                 {"cache.size", "128 B"}}));
}

TEST_F(Explored, SettingsComeBehindThoseOfTheCommand) {
  const Session session(file_, {"machine.nodes=6", "image.width=16"});
  EXPECT_EQ(session.answer({{"machine.nodes", "2"}}, Measuring::none),
            run_with({{"machine.nodes", "6"}, {"image.width", "16"}, {"machine.nodes", "2"}}));
  EXPECT_EQ(session.answer({}, Measuring::none), run_with({{"machine.nodes", "6"}, {"image.width", "16"}}));
}

TEST_F(Explored, ARefusalNamesTheKeyAndTheNextAnswerIsRightAgain) {
  const Session session(file_, {});
  const auto key = [&](const char* name, const char* value) {
    return refused_key(session.answer({{name, value}}, Measuring::none));
  };
  EXPECT_EQ(key("machine.nodes", "0"), "machine.nodes");
  EXPECT_EQ(key("machine.nodes", "many"), "machine.nodes");
  EXPECT_EQ(key("cache.size", "-4 KiB"), "cache.size");
  EXPECT_EQ(key("cache.replacement", "\"newest\""), "cache.replacement");
  EXPECT_NE(key("pipeline.queue", "4"), "accepted");
  EXPECT_NE(key("no.such.key", "1"), "accepted");
  EXPECT_NE(key("machine.nodes", "4\nimage.width = 9"), "accepted");
  EXPECT_EQ(session.answer({}, Measuring::none), run_with({}));
}

TEST_F(Explored, WhatIsNoKeyDoesNotBecomeOne) {
  const Session session(file_, {});
  for (const Settings& settings : std::vector<Settings>{
           {{" image.width", "64"}}, {{"scene.source=a", "b"}}, {{"machine.nodes ", "8"}}, {{"", "1"}}}) {
    const std::string answer = session.answer(settings, Measuring::none);
    EXPECT_NE(answer.find("unknown key"), std::string::npos) << answer;
  }
}

TEST_F(Explored, KeysOfTheFrameAreNoSettings) {
  const Session session(file_, {});
  for (const Settings& settings : std::vector<Settings>{{{"image.width", "8"}},
                                                        {{"scene.source", "/etc/passwd"}},
                                                        {{"structure.kind", "grid"}},
                                                        {{"host_machine.memory_limit", "0 B"}},
                                                        {{"record.timeline", "true"}},
                                                        {{"frames.count", "2"}}}) {
    EXPECT_EQ(refused_key(session.answer(settings, Measuring::none)), settings[0].first);
  }
}

TEST_F(Explored, EveryOtherKeyIsAControlWithItsValue) {
  const Session session(file_, {"machine.nodes=5"});
  const auto keys = nlohmann::json::parse(session.keys());
  sim::Schema schema = run_schema();
  std::size_t controls = 0;
  for (const sim::Key& key : schema.keys()) {
    controls += is_control(key) ? 1 : 0;
  }
  ASSERT_EQ(keys["controls"].size(), controls);
  std::map<std::string, std::string> values;
  for (const auto& key : keys["controls"]) {
    values[key["name"]] = setting_toml(key["name"].get<std::string>(), key["value"]);
  }
  EXPECT_EQ(values["machine.nodes"], "5");
  EXPECT_EQ(values["cache.size"], "\"1 KiB\"");
  EXPECT_EQ(values.count("image.width"), 0U);
  EXPECT_EQ(keys["given"]["image.width"], "24");
  // Each value as a setting changes nothing of the figures, unless the machine has no use for the key.
  const auto plain = nlohmann::json::parse(session.answer({}, Measuring::none));
  for (const auto& [key, effective] : plain["config"]["keys"].items()) {
    if (values.count(key) == 1) {
      const auto same = nlohmann::json::parse(session.answer({{key, values[key]}}, Measuring::none));
      EXPECT_EQ(same["figures"], plain["figures"]) << key;
    }
  }
}

TEST_F(Explored, AWrongConfigurationIsRefusedBeforeAnythingElse) {
  EXPECT_NE(test::user_error_of([&] { Session(file_, {"cache.size=1 B"}); }).find("cache.size"),
            std::string::npos);
  EXPECT_NE(test::user_error_of([&] { Session(directory_.path() / "none.toml", {}); }).find("none.toml"),
            std::string::npos);
}

TEST(Turns, TheNewestOfAReaderComesNextAndOthersGiveUp) {
  Turns turns;
  std::optional<Turns::Turn> running = turns.take(Asker::background);
  ASSERT_TRUE(running);
  const auto taken = [&](Asker asker) {
    return std::async(std::launch::async, [&turns, asker] { return turns.take(asker).has_value(); });
  };
  // Whichever of the two came last has the turn, the other none, however the threads are scheduled.
  auto one = taken(Asker::reader);
  auto two = taken(Asker::reader);
  while (one.wait_for(std::chrono::milliseconds(1)) != std::future_status::ready &&
         two.wait_for(std::chrono::milliseconds(1)) != std::future_status::ready) {
  }
  EXPECT_TRUE(running->meter().is_stopped());
  running.reset();
  EXPECT_NE(one.get(), two.get());
}

TEST(Turns, TellHowFarTheWorkIs) {
  Turns turns;
  EXPECT_EQ(turns.state().part, "");
  {
    const std::optional<Turns::Turn> turn = turns.take(Asker::reader);
    ASSERT_TRUE(turn);
    turn->meter().begin("timing", "packets", 3);
    turn->meter().count();
    EXPECT_EQ(turns.state().part, "timing");
    EXPECT_EQ(turns.state().done, 1U);
    turns.stop();
    EXPECT_TRUE(turn->meter().is_stopped());
  }
  EXPECT_EQ(turns.state().part, "");
  EXPECT_FALSE(turns.take(Asker::reader)) << "after the end nothing begins";
}

TEST(Turns, AReaderIsNotKeptByTheBackground) {
  Turns turns;
  for (int i = 0; i < 100; ++i) {
    std::optional<Turns::Turn> running = turns.take(Asker::background);
    ASSERT_TRUE(running);
    auto background =
        std::async(std::launch::async, [&] { return turns.take(Asker::background).has_value(); });
    auto reader = std::async(std::launch::async, [&] { return turns.take(Asker::reader).has_value(); });
    running.reset();
    EXPECT_TRUE(reader.get());
    // It waited before the reader, who took its place, or came later and has its turn.
    static_cast<void>(background.get());
  }
}

}  // namespace
}  // namespace marti::studies
