// Time lines and heat maps against the machine's own accounts.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "processors/path/path_recorder.h"
#include "processors/replay/replay.h"
#include "sim/error.h"
#include "studies/run/record/colour_scale.h"
#include "studies/run/record/heat_files.h"
#include "studies/run/record/heat_map.h"
#include "studies/run/record/observers.h"
#include "studies/run/record/timeline.h"
#include "tests/support/files.h"
#include "tests/support/random_machine.h"
#include "tests/support/temporary_directory.h"

namespace marti::studies {

using namespace run;
using namespace tables;

namespace {

using processors::cost::Activity;
using processors::machine::MachineConfig;
using processors::replay::MachineResult;
using processors::walk::NodeState;

MachineResult watched(const processors::program::WorkLog& log, const MachineConfig& machine,
                      processors::walk::Observer& observer, processors::path::PathRecorder* path = nullptr) {
  Observers all;
  if (path != nullptr) {
    all.add(*path);
  }
  all.add(observer);
  processors::replay::ReplayOptions options;
  options.observer = &all;
  options.path = path;
  return processors::replay::replay(log, machine, options);
}

// "12.000345" microseconds are 12,000,345 ticks.
sim::Ticks ticks_of(const nlohmann::json& microseconds) {
  return std::llround(microseconds.get<double>() * 1e6);
}

struct Slices {
  std::map<std::pair<int, std::string>, sim::Ticks> time;  // by track and name
  std::map<int, std::vector<std::pair<sim::Ticks, sim::Ticks>>> tracks;
  std::set<std::string> names;  // of tracks and processes
  std::int64_t events = 0;
  bool note = false;
};

Slices read_timeline(const std::filesystem::path& file) {
  const nlohmann::json trace = nlohmann::json::parse(test::read(file));
  Slices slices;
  slices.note = trace.contains("otherData");
  for (const nlohmann::json& event : trace.at("traceEvents")) {
    if (event.at("ph") == "M") {
      if (event.at("args").contains("name")) {
        slices.names.insert(event.at("args").at("name"));
      }
      continue;
    }
    EXPECT_EQ(event.at("ph"), "X");
    ++slices.events;
    const sim::Ticks from = ticks_of(event.at("ts"));
    const sim::Ticks length = ticks_of(event.at("dur"));
    EXPECT_GT(length, 0);
    slices.time[{event.at("tid"), event.at("name")}] += length;
    slices.tracks[event.at("tid")].emplace_back(from, from + length);
    if (event.contains("args")) {
      EXPECT_TRUE(event.at("args").contains("x") && event.at("args").contains("y") &&
                  event.at("args").contains("packet"));
    }
  }
  return slices;
}

struct Machine {
  explicit Machine(std::uint64_t seed) {
    test::Random random(seed);
    log = test::random_tree_log(random, 12, 10);
    config = test::random_machine(random);
    config.placement = processors::machine::Placement::shared;
    if (seed % 2 == 0) {
      config.build = test::random_build(random);
    }
  }
  processors::program::WorkLog log;
  MachineConfig config;
};

TEST(Timelines, HoldTheWholeFrameNodeByNode) {
  const test::TemporaryDirectory directory;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const Machine machine(seed);
    const std::filesystem::path file = directory.path() / "timeline.json";
    Timeline timeline(file, {});
    const MachineResult result = watched(machine.log, machine.config, timeline);
    EXPECT_EQ(timeline.cut_at(), std::nullopt);
    timeline.commit();
    Slices slices = read_timeline(file);
    EXPECT_EQ(slices.events, timeline.events());
    EXPECT_FALSE(slices.note);
    for (std::size_t node = 0; node < result.nodes.size(); ++node) {
      const int track = static_cast<int>(node) + 1;
      const processors::cost::TimeDivision& time = result.nodes[node].time;
      const bool own_memory = machine.config.build.sharing == processors::machine::Sharing::private_trees;
      for (const Activity activity :
           {Activity::interconnect_wait, Activity::transfer, Activity::bank_wait, Activity::bank_access,
            Activity::lock_wait, Activity::queue_full_wait, Activity::dispatch_wait, Activity::idle}) {
        if (own_memory && (activity == Activity::transfer || activity == Activity::bank_access)) {
          continue;
        }
        const auto index = static_cast<std::size_t>(activity);
        const std::pair key(track, std::string(processors::cost::activity_names[index]));
        EXPECT_EQ(slices.time[key], time[index])
            << "seed " << seed << ", node " << node << ", " << key.second;
      }
      sim::Ticks at = 0;
      for (const auto& [from, to] : slices.tracks[track]) {
        EXPECT_EQ(from, at);
        at = to;
      }
      EXPECT_EQ(at, result.end);
      EXPECT_TRUE(result.end == 0 || slices.names.contains("node " + std::to_string(node)));
    }
  }
}

// The critical path has a track of its own, which ends where its limit is reached.
TEST(Timelines, CutNodesAndCriticalPathEachForItself) {
  const test::TemporaryDirectory directory;
  const Machine machine(7);
  const std::filesystem::path file = directory.path() / "timeline.json";
  const int path_track = static_cast<int>(machine.config.all_nodes()) + 1;
  const auto record = [&](std::int64_t limit) {
    auto timeline = std::make_unique<Timeline>(file, TimelineOptions{.most_events = limit});
    processors::path::PathRecorder path({}, processors::path::PathPieces::no_fold);
    timeline->mark(&path);
    sim::Ticks at = watched(machine.log, machine.config, *timeline, &path).end;
    timeline->commit();
    Slices slices = read_timeline(file);
    EXPECT_TRUE(slices.names.contains("critical path"));
    for (const auto& [from, to] : slices.tracks[path_track]) {
      EXPECT_EQ(to, at) << "from the end on without gaps";
      at = from;
    }
    EXPECT_EQ(at == 0, path.path().pieces <= limit);
    return std::pair(std::move(timeline), std::move(slices));
  };
  const Slices whole = record(1'000'000).second;
  EXPECT_FALSE(whole.note);
  const auto& path = whole.tracks.at(path_track);
  const auto length = static_cast<std::int64_t>(path.size());
  const std::int64_t of_nodes = whole.events - length;
  ASSERT_GT(length, 10);
  ASSERT_GT(of_nodes, length);
  for (const std::int64_t limit :
       {std::int64_t{1}, std::int64_t{10}, length - 1, length, of_nodes - 1, of_nodes}) {
    const auto& [timeline, slices] = record(limit);
    const std::int64_t shown = std::min(limit, length);
    EXPECT_EQ(slices.events, timeline->events());
    EXPECT_EQ(slices.events, std::min(limit, of_nodes) + shown);
    EXPECT_TRUE(std::equal(path.begin(), path.begin() + shown, slices.tracks.at(path_track).begin(),
                           slices.tracks.at(path_track).end()));
    EXPECT_EQ(timeline->cut_at().has_value(), limit < of_nodes);
    EXPECT_EQ(timeline->path_cut_at(),
              limit < length ? std::optional(path[static_cast<std::size_t>(shown) - 1].first) : std::nullopt);
    EXPECT_EQ(slices.note, limit < of_nodes);
    Timeline nodes_only(directory.path() / "nodes.json", {.most_events = limit});
    (void)watched(machine.log, machine.config, nodes_only);
    EXPECT_EQ(timeline->cut_at(), nodes_only.cut_at());
    EXPECT_EQ(nodes_only.events(), std::min(limit, of_nodes));
  }
}

TEST(Timelines, KeepToTheirWindow) {
  const test::TemporaryDirectory directory;
  const Machine machine(7);
  const sim::Ticks end = processors::replay::replay(machine.log, machine.config).end;
  const std::filesystem::path file = directory.path() / "timeline.json";
  Timeline timeline(file, {.from = end / 3, .to = end / 2});
  const MachineResult result = watched(machine.log, machine.config, timeline);
  timeline.commit();
  const Slices slices = read_timeline(file);
  EXPECT_EQ(slices.tracks.size(), result.nodes.size());
  for (const auto& [track, pieces] : slices.tracks) {
    EXPECT_EQ(pieces.front().first, end / 3);
    EXPECT_EQ(pieces.back().second, end / 2);
  }
}

TEST(Timelines, LeaveNothingBehindUnlessCommitted) {
  const test::TemporaryDirectory directory;
  const Machine machine(3);
  {
    Timeline timeline(directory.path() / "timeline.json", {});
    (void)watched(machine.log, machine.config, timeline);
  }
  EXPECT_TRUE(std::filesystem::is_empty(directory.path()));
  EXPECT_THROW(Timeline(directory.path() / "none" / "timeline.json", {}), sim::UserError);
}

TEST(HeatMaps, AddUpToTheMachinesAccounts) {
  for (std::uint64_t seed = 1; seed <= 19; seed += 2) {
    const Machine machine(seed);
    HeatMap map;
    const MachineResult result = watched(machine.log, machine.config, map);
    const auto sum = [&](Heat heat) {
      std::int64_t total = 0;
      for (const std::int64_t value : map.values(heat)) {
        total += value;
      }
      return total;
    };
    const processors::cost::TimeSums time = result.time();
    const auto part = [&](Activity activity) { return time[static_cast<std::size_t>(activity)]; };
    const auto nodes = static_cast<sim::Sum>(result.nodes.size());
    EXPECT_EQ(sum(Heat::cycles), nodes * result.end - part(Activity::dispatch_wait) - part(Activity::idle));
    EXPECT_EQ(sum(Heat::misses), result.references().all_misses());
    EXPECT_EQ(sum(Heat::waits), part(Activity::interconnect_wait) + part(Activity::transfer) +
                                    part(Activity::bank_wait) + part(Activity::bank_access) +
                                    part(Activity::queue_full_wait));
  }
}

TEST(HeatMaps, AreWrittenAllOrNone) {
  const test::TemporaryDirectory directory;
  const Machine machine(1);
  HeatMap map;
  (void)watched(machine.log, machine.config, map);
  {
    PendingFiles dropped(directory.path());
    add_heat_files(map, dropped);
  }
  EXPECT_TRUE(std::filesystem::is_empty(directory.path()));
  PendingFiles files(directory.path());
  add_heat_files(map, files);
  EXPECT_EQ(files.commit().size(), 4U);
  for (const char* name : {"heat.exr", "heat-cycles.png", "heat-misses.png", "heat-waits.png"}) {
    EXPECT_GT(std::filesystem::file_size(directory.path() / name), 50U) << name;
  }
}

TEST(HeatMaps, LegendLeavesOutTheTopHundredth) {
  std::vector<float> figures;
  for (int i = 1; i <= 200; ++i) {
    figures.push_back(static_cast<float>(i));
  }
  const Legend legend = legend_of(figures);
  EXPECT_EQ(legend.brightest, 198.0);
  EXPECT_EQ(legend.largest, 200.0);
  EXPECT_EQ(legend.mean, 100.5);
  EXPECT_EQ(legend_of({0.0F, 0.0F}).brightest, 0.0);
  std::vector<float> rare(1000, 0.0F);
  rare[3] = 5.0F;
  EXPECT_EQ(legend_of(rare).brightest, 5.0) << "a scale without length shows nothing";
}

// CIE 1976 lightness, which orders the colours for every kind of vision.
TEST(HeatMaps, ColoursGetLighterAllTheWay) {
  double last = -1.0;
  for (int i = 0; i <= 1000; ++i) {
    const glm::vec3 colour = colour_of(i / 1000.0);
    const double luminance = 0.2126 * static_cast<double>(colour.x) + 0.7152 * static_cast<double>(colour.y) +
                             0.0722 * static_cast<double>(colour.z);
    const double lightness = luminance > 0.008856 ? 116.0 * std::cbrt(luminance) - 16.0 : 903.3 * luminance;
    EXPECT_GT(lightness, last) << i;
    last = lightness;
  }
  EXPECT_GT(last, 85.0);
  EXPECT_EQ(colour_of(-1.0), colour_of(0.0));
  EXPECT_EQ(colour_of(7.0), colour_of(1.0));
}

/// Ignores idling.
class Forgetful final : public processors::walk::Observer {
 public:
  explicit Forgetful(processors::walk::Observer& next) : next_(next) {}
  void begin(const processors::walk::ReplayInput& input) override { next_.begin(input); }
  void spent(std::uint32_t node, NodeState state, sim::Ticks from, sim::Ticks to,
             processors::walk::PixelPlace pixel) override {
    if (state != NodeState::idle) {
      next_.spent(node, state, from, to, pixel);
    }
  }
  void end(sim::Ticks time) override { next_.end(time); }

 private:
  processors::walk::Observer& next_;
};

TEST(Observing, ATimeLineThatEndsTooEarlyIsAFault) {
  const Machine machine(1);
  ASSERT_GT(processors::replay::replay(machine.log, machine.config)
                .time()[static_cast<std::size_t>(Activity::idle)],
            0);
  Observers all;
  Forgetful forgetful(all);
  processors::replay::ReplayOptions options;
  options.observer = &forgetful;
  EXPECT_THROW((void)processors::replay::replay(machine.log, machine.config, options), sim::InternalError);
}

}  // namespace
}  // namespace marti::studies
