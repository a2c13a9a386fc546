// The plan of a sweep against naive expansions of the same axes.
#include "studies/sweep/plan/sweep_plan.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <set>

#include "processors/replay/replay.h"
#include "scenes/gltf_export.h"
#include "scenes/procedural.h"
#include "scenes/tessellate.h"
#include "sim/files.h"
#include "studies/host/image_file.h"
#include "studies/keys/machine_keys.h"
#include "studies/run/functional_run.h"
#include "studies/run/run_result.h"
#include "studies/sweep/plan/digest.h"
#include "studies/sweep/plan/read_point.h"
#include "tests/support/ray_file.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"
#include "tests/unit/studies/sweep_tables.h"

namespace marti::studies {

using namespace host;
using namespace keys;
using namespace run;
using namespace sweep;

namespace {

using test::plan_of;
using test::sweep_config;
using test::user_error_of;

// The values of the keys that a configuration with these assignments uses, read as `marti run` reads it.
struct Naive {
  std::string frame;
  std::string machine;
};

Naive naive(const std::vector<std::string>& assignments) {
  sim::Config config = sim::Config::from_text(run_schema(), "", "naive", assignments);
  (void)read_frame(config);
  Naive found;
  std::set<std::string> of_frame;
  for (const sim::EffectiveValue& value : config.effective_values()) {
    of_frame.insert(value.key);
    if (!value.key.starts_with("host_machine.")) {
      found.frame += value.key + " = " + value.value + "\n";
    }
  }
  (void)read_machine(config);
  for (const sim::EffectiveValue& value : config.effective_values()) {
    if (!of_frame.contains(value.key)) {
      found.machine += value.key + " = " + value.value + "\n";
    }
  }
  return found;
}

// A message without its file and line.
std::string reason_of(const std::string& message) { return message.substr(message.rfind(": ") + 2); }

std::string text_of(const std::vector<sim::EffectiveValue>& settings) {
  std::string text;
  for (const sim::EffectiveValue& value : settings) {
    text += value.key + " = " + value.value + "\n";
  }
  return text;
}

struct Axis {
  std::string key;
  std::vector<std::string> values;  // as TOML
};

// Keys of which some make others useless, and some belong to the frame.
const std::vector<Axis>& all_axes() {
  static const std::vector<Axis> axes = {{"machine.nodes", {"1", "3", "8"}},
                                         {"cache.organisation", {"'none'", "'unified'", "'split'"}},
                                         {"cache.size", {"1024", "'4 KiB'"}},
                                         {"cache.ways", {"1", "2"}},
                                         {"image.max_depth", {"1", "2"}},
                                         {"interconnect.kind", {"'ideal'", "'bus'", "'crossbar'"}},
                                         {"interconnect.mode", {"'held'", "'split'"}},
                                         {"memory.banks", {"1", "4"}},
                                         {"cache.node_size", {"64", "128"}},
                                         {"structure.kind", {"'octree'", "'none'"}},
                                         {"structure.max_level", {"5", "6"}},
                                         {"l2.sharing", {"'none'", "'private'"}},
                                         {"count.sharing", {"false", "true"}}};
  return axes;
}

std::vector<Axis> random_axes() {
  std::vector<Axis> axes;
  std::uint64_t points = 1;
  for (const Axis& axis : all_axes()) {
    if (points < 60 && *rc::gen::inRange(0, 3) == 0) {
      const auto count = *rc::gen::inRange<std::size_t>(1, axis.values.size() + 1);
      axes.push_back(
          {axis.key, {axis.values.begin(), axis.values.begin() + static_cast<std::ptrdiff_t>(count)}});
      points *= count;
    }
  }
  if (axes.empty()) {
    axes.push_back(all_axes().front());
  }
  return axes;
}

std::string toml_of(const std::vector<Axis>& axes) {
  std::string text = "[sweep.axes]\n";
  for (const Axis& axis : axes) {
    text += axis.key + " = [";
    for (const std::string& value : axis.values) {
      text += value + ", ";
    }
    text += "]\n";
  }
  return text;
}

// Calls visit(assignments) for each point, by nested loops.
template <class Visit>
void for_each_point(const std::vector<Axis>& axes, std::size_t depth, std::vector<std::string>& assignments,
                    const Visit& visit) {
  if (depth == axes.size()) {
    visit(assignments);
    return;
  }
  for (const std::string& value : axes[depth].values) {
    assignments.push_back(axes[depth].key + "=" + value);
    for_each_point(axes, depth + 1, assignments, visit);
    assignments.pop_back();
  }
}

RC_GTEST_PROP(SweepPlan, IsTheCrossProductWithEachMachineOnce, ()) {
  const std::vector<Axis> axes = random_axes();
  std::vector<Naive> points;
  std::vector<std::string> assignments;
  std::string wrong;  // the fault of the first point that cannot be built
  for_each_point(axes, 0, assignments, [&](const auto& given) {
    try {
      points.push_back(naive(given));
    } catch (const sim::UserError& error) {
      wrong = wrong.empty() ? reason_of(error.what()) : wrong;
    }
  });
  SweepPlan plan;
  try {
    plan = plan_of(toml_of(axes));
  } catch (const sim::UserError& error) {
    // An axis that no point uses is refused, too.
    const std::string expected = wrong.empty() ? "is not used by any point" : wrong;
    RC_ASSERT(std::string(error.what()).find(expected) != std::string::npos);
    return;
  }
  RC_ASSERT(wrong.empty());

  RC_ASSERT(plan.axes.size() == axes.size());
  RC_ASSERT(plan.points.size() == points.size());
  RC_ASSERT(plan.filtered_out == 0U);
  std::map<std::string, std::string> key_of_machine;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const SweepMachine& machine = plan.machines.at(plan.points[i].machine);
    RC_ASSERT(text_of(all_of(machine.settings)) == points[i].machine);
    RC_ASSERT(text_of(plan.frames.at(machine.frame).settings) == points[i].frame);
    // Equal keys, equal values, and the other way round.
    const auto [place, fresh] =
        key_of_machine.emplace(points[i].frame + "\n" + points[i].machine, machine.key);
    RC_ASSERT(place->second == machine.key);
  }
  std::set<std::string> keys;
  for (const auto& [values, key] : key_of_machine) {
    RC_ASSERT(keys.insert(key).second);
  }
  // Every machine once; by frame, then by its first point, then those of no point.
  keys.clear();
  std::vector<std::size_t> first(plan.machines.size(), plan.points.size());
  for (std::size_t i = plan.points.size(); i-- > 0;) {
    first[plan.points[i].machine] = i;
  }
  for (std::size_t i = 0; i < plan.machines.size(); ++i) {
    RC_ASSERT(keys.insert(plan.machines[i].key).second);
    RC_ASSERT(plan.machines[i].key.size() == 32U);
    if (i > 0) {
      RC_ASSERT(plan.machines[i - 1].frame <= plan.machines[i].frame);
      RC_ASSERT((plan.machines[i - 1].frame < plan.machines[i].frame || first[i - 1] <= first[i]));
    }
  }
  keys.clear();
  for (const SweepFrame& frame : plan.frames) {
    RC_ASSERT(keys.insert(frame.key).second);
  }
}

RC_GTEST_PROP(SweepPlan, MeasuresEachPointAgainstItsMachineOfOneNode, ()) {
  const std::vector<Axis> axes = random_axes();
  SweepPlan plan;
  try {
    plan = plan_of(toml_of(axes));
  } catch (const sim::UserError&) {
    return;
  }
  std::size_t i = 0;
  std::vector<std::string> assignments;
  for_each_point(axes, 0, assignments, [&](std::vector<std::string> given) {
    const SweepPoint& point = plan.points.at(i++);
    given.insert(given.end(), {"machine.nodes=1", "count.sharing=false"});
    const Naive base = naive(given);
    RC_ASSERT(text_of(all_of(plan.machines.at(point.base).settings)) == base.machine);
    RC_ASSERT(plan.machines[point.base].frame == plan.machines[point.machine].frame);
  });
}

TEST(SweepPlan, IsTheSameOnOneThread) {
  const std::string text =
      toml_of({all_axes()[0], all_axes()[1], all_axes()[2], all_axes()[5], all_axes()[7]});
  const SweepPlan many = plan_of(text);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const SweepPlan single = plan_of(text);
  ASSERT_EQ(many.machines.size(), single.machines.size());
  for (std::size_t i = 0; i < many.machines.size(); ++i) {
    EXPECT_EQ(many.machines[i].key, single.machines[i].key);
  }
  EXPECT_EQ(describe(many), describe(single));
}

// The machine that a speed-up is measured against is the one `marti run` takes, whatever the scheme.
TEST(SweepPlan, OneNodeIsThatOfARun) {
  const FunctionalRun run = [] {
    sim::Config config = sweep_config("scene.source = \"teapot:2\"\nimage = { width = 24, height = 24 }\n");
    return run_functional(read_frame(config));
  }();
  for (const std::string_view machine :
       {"machine.nodes = 5\n",
        "machine.scheme = \"pipeline\"\nmachine.nodes = 16\nhost.assignment = \"blocks\"\n",
        "machine.scheme = \"space\"\nmachine.nodes = 5\nnode.write_buffer = 1\nlocal.access_cycles = 9\n",
        "database.placement = \"distributed\"\nmachine.nodes = 4\n",
        "database.placement = \"replicated\"\nmachine.clusters = 2\nnode.contexts = 2\n",
        "build.sharing = \"shared\"\nl2.sharing = \"shared\"\nmachine.nodes = 3\n",
        "count.miss_classes = true\nmachine.nodes = 3\n"}) {
    const ReadPoint point = read_point(sweep_config(machine));
    const ReadPoint one = read_point(one_node_config(point));
    const processors::replay::MachineResult expected =
        processors::replay::replay(*run.frame.log, processors::machine::one_node_of(point.machine));
    const processors::replay::MachineResult found = processors::replay::replay(*run.frame.log, one.machine);
    EXPECT_EQ(found.end, expected.end) << machine;
    EXPECT_EQ(found.time(), expected.time()) << machine;
    EXPECT_EQ(found.references().hits, expected.references().hits) << machine;
    EXPECT_EQ(found.events, expected.events) << machine;
  }
}

TEST(SweepPlan, FilterDecidesWhichPointsStay) {
  const std::string axes =
      "[sweep.points.a]\nmemory.banks = 2\n[sweep.points.b]\n[sweep.axes]\nmachine.nodes = [1, 2, 4]\n"
      "cache.size = [\"1 KiB\", \"2 KiB\", \"4 KiB\"]\n[sweep]\n";
  const SweepPlan plan = plan_of(axes +
                                 "filter = \"machine.nodes * cache.size <= 4 KiB and cache.ways = 4 and not "
                                 "(point = 'b' and memory.banks = 4 and machine.nodes = 4)\"\n");
  std::vector<std::string> expected;
  for (const std::string_view point : {"a", "b"}) {
    for (const std::int64_t nodes : {1, 2, 4}) {
      for (const std::int64_t size : {1024, 2048, 4096}) {
        if (nodes * size <= 4096 && !(point == "b" && nodes == 4)) {
          expected.push_back(std::string(point) + std::to_string(nodes) + "/" + std::to_string(size));
        }
      }
    }
  }
  std::vector<std::string> found;
  ASSERT_EQ(plan.axes, (std::vector<std::string>{"point", "memory.banks", "machine.nodes", "cache.size"}));
  for (const SweepPoint& point : plan.points) {
    found.push_back(std::get<std::string>(point.values[0]) +
                    std::to_string(std::get<std::int64_t>(point.values[2])) + "/" +
                    std::to_string(std::get<std::int64_t>(point.values[3])));
    EXPECT_EQ(std::get<std::int64_t>(point.values[1]), found.back().front() == 'a' ? 2 : 4);
  }
  EXPECT_EQ(found, expected);
  EXPECT_EQ(plan.filtered_out, 18 - expected.size());
  EXPECT_EQ(user_error_of([&] { (void)plan_of(axes + "filter = \"machine.nodes > 4\"\n"); }),
            "s.toml:8: sweep.filter: no point of 18 passes");
  EXPECT_EQ(
      user_error_of([&] { (void)plan_of(axes, {"sweep.filter=machine.node > 4"}); }),
      "--set sweep.filter=machine.node > 4: unknown name \"machine.node\" (did you mean \"machine.nodes\"?); "
      "`marti config` lists all keys");
}

TEST(SweepPlan, KeysThatDifferBetweenFramesAreTheFramesAlone) {
  const SweepPlan plan = plan_of("[sweep.axes]\nimage.max_depth = [1, 2]\nmachine.nodes = [1, 2]\n");
  EXPECT_EQ(plan.frames.size(), 2U);
  EXPECT_EQ(plan.machines.size(), 4U);
  EXPECT_EQ(plan.frames[1].config.render.max_depth, 2U);
  // How much memory the host has changes nothing.
  const SweepPlan other = plan_of(
      "host_machine.memory_limit = \"4 GiB\"\n[sweep.axes]\nimage.max_depth = [1, 2]\nmachine.nodes = [1, "
      "2]\n");
  for (std::size_t i = 0; i < plan.machines.size(); ++i) {
    EXPECT_EQ(plan.machines[i].key, other.machines[i].key);
  }
}

TEST(SweepPlan, ASceneFileIsWhatIsInIt) {
  const test::TemporaryDirectory directory;
  const auto frame_of = [&](const std::string& folder, const std::string& scene) {
    const std::filesystem::path place = directory.path() / folder;
    std::filesystem::create_directories(place);
    scenes::Scene made = scenes::make_procedural(scene);
    scenes::tessellate(made);
    scenes::export_glb(made, place / "a.glb", encode_png);
    sim::write_file(place / "s.toml", "scene.source = \"a.glb\"\n[sweep.axes]\nmachine.nodes = [1, 2]\n");
    sim::Config config = sim::Config::from_file(sweep_schema(), place / "s.toml");
    const SweepPlan plan = plan_sweep(config);
    EXPECT_EQ(plan.frames.size(), 1U);
    return plan.frames.front().key + plan.machines.front().key;
  };
  const std::string first = frame_of("one", "teapot:2");
  EXPECT_EQ(frame_of("two", "teapot:2"), first);
  EXPECT_NE(frame_of("one", "teapot:3"), first);
}

// Files of rays, too, are what is in them: another array under the same name is another frame.
TEST(SweepPlan, AFileOfRaysIsWhatIsInIt) {
  const test::TemporaryDirectory directory;
  const auto frames_of = [&](double x) {
    sim::write_file(directory.path() / "a.npy", test::ray_file({x, 0.0, 3.0, 0.0, 0.0, 0.0, -1.0, 9.0}));
    sim::write_file(directory.path() / "b.npy", test::ray_file({2.0, 0.0, 3.0, 0.0, 0.0, 0.0, -1.0, 9.0}));
    sim::Config config = sim::Config::from_text(sweep_schema(),
                                                "scene.source = \"tetra:2\"\nimage.integrator = \"rays\"\n"
                                                "[sweep.axes]\nimage.rays = [\"a.npy\", \"b.npy\"]\n"
                                                "machine.nodes = [1, 2]\n",
                                                (directory.path() / "a.toml").string());
    const SweepPlan plan = plan_sweep(config);
    EXPECT_EQ(plan.frames.size(), 2U);
    EXPECT_EQ(plan.machines.size(), 4U);
    return std::pair(plan.frames.at(0).key, plan.frames.at(1).key);
  };
  const auto first = frames_of(0.0);
  const auto second = frames_of(1.0);
  EXPECT_NE(first.first, second.first);
  EXPECT_EQ(first.second, second.second);
}

TEST(SweepPlan, BaseAndComparisonAreOnesOwn) {
  const SweepPlan plan = plan_of(
      "[sweep.axes]\nmachine.nodes = [2, 4]\ncache.ways = [1, 2]\n"
      "[sweep.base]\ncache.organisation = \"none\"\n"
      "[sweep.compare]\nmachine.nodes = 4\ncache.ways = 1\n");
  ASSERT_EQ(plan.points.size(), 4U);
  for (const SweepPoint& point : plan.points) {
    const processors::machine::MachineConfig& base = plan.machines[point.base].config;
    EXPECT_EQ(base.cache.organisation, processors::machine::CacheOrganisation::none);
    EXPECT_EQ(base.nodes, plan.machines[point.machine].config.nodes);
  }
  EXPECT_EQ(plan.points[0].base, plan.points[1].base);
  EXPECT_EQ(plan.compare, plan.points[2].machine);
  EXPECT_EQ(plan.machines.size(), 6U);
}

TEST(SweepPlan, PricesAreThoseOfTheMachines) {
  const SweepPlan plan = plan_of(
      "interconnect.width = 4\nmemory.banks = 1\n[prices]\nnode = 10\ncache_kib = 2\ninterconnect_byte = "
      "3\nbank = 1\n"
      "[sweep.axes]\nmachine.nodes = [1, 2]\ncache.size = [\"1 KiB\", \"2 KiB\"]\n");
  std::vector<double> costs;
  for (const SweepPoint& point : plan.points) {
    costs.push_back(point.cost);
  }
  EXPECT_EQ(costs, (std::vector<double>{25, 27, 37, 41}));
}

TEST(SweepPlan, WrongPointsAreNamed) {
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"[sweep.axes]\nmachine.nodes = [1, 2]\ncache.ways = [4,\n 3]\ncache.size = [\"4 KiB\"]\n",
       "s.toml:5: cache.size: "},
      {"[sweep.axes]\nmachine.nodes = [2]\ncache.line = [\"32 B\", \"33 B\"]\n",
       "s.toml:3: cache.line: must be a power of two, not 33 bytes (the point machine.nodes = 2, "
       "cache.line = \"33 "
       "B\"; sweep.skip_invalid = true leaves out such points)"},
      {"[cache]\norganisation = \"none\"\n[sweep.axes]\nmachine.nodes = [1]\ncache.size = [1024]\n",
       "s.toml:5: cache.size: is not used by any point of the sweep: it has no effect with "
       "cache.organisation = \"none\""},
      {"[cache]\norganisation = \"none\"\nsize = 1024\n[sweep.axes]\nmachine.nodes = [1]\n",
       "s.toml:3: cache.size: is not used: it has no effect with cache.organisation = \"none\""},
      {"[sweep.axes]\nmachine.nodes = [1]\n[sweep.compare]\ncache.organisation = \"none\"\ncache.size = "
       "3\n",
       "s.toml:5: cache.size: is not used by the machine of [sweep.compare]: it has no effect"},
      {"[sweep.axes]\nmachine.nodes = [1]\n[sweep.base]\ncache.seed = 3\n",
       "s.toml:4: cache.seed: is not used by any machine of the sweep: only"},
      {"[sweep.axes]\nframes.count = [2]\n", "s.toml:2: frames.count: 2 frames are asked for"},
      {"[sweep.axes]\nmachine.nodes = [1]\n[sweep.compare]\ncache.line = 33\n",
       "s.toml:4: cache.line: must be a power of two, not 33 bytes (the machine of [sweep.compare])"},
      {"[sweep.axes]\nmachine.nodes = [1]\n[sweep.base]\ncache.line = 33\n",
       "s.toml:4: cache.line: must be a power of two, not 33 bytes (the base of the point "
       "machine.nodes = 1; sweep.skip_invalid = true leaves out such points)"},
      {"[sweep.axes]\nscene.source = [\"no.glb\"]\n", "s.toml:2: scene.source: there is no file no.glb"},
  };
  test::expect_messages(wrong,
                        [](const std::string& text) { return user_error_of([&] { (void)plan_of(text); }); });
}

TEST(SweepPlan, AnAxisMaySwitchOffWhatTheFileDescribes) {
  const SweepPlan plan = plan_of("[cache]\nsize = 1024\n[sweep.axes]\ncache.organisation = [\"none\"]\n");
  EXPECT_EQ(plan.points.size(), 1U);
}

TEST(SweepPlan, PointsThatCannotBeBuiltMayBeLeftOut) {
  const std::string axes = "[sweep.axes]\ncache.line = [\"33 B\", \"32 B\"]\nmachine.nodes = [1, 2]\n";
  const SweepPlan plan = plan_of(axes, {"sweep.skip_invalid=true"});
  EXPECT_EQ(plan.points.size(), 2U);
  ASSERT_EQ(plan.skipped.size(), 2U);
  EXPECT_EQ(plan.skipped[1].point, "cache.line = \"33 B\", machine.nodes = 2");
  EXPECT_EQ(plan.skipped[1].reason, "s.toml:2: cache.line: must be a power of two, not 33 bytes");
  EXPECT_NE(describe(plan).find("2, 2 more cannot be built"), std::string::npos);
  EXPECT_EQ(
      user_error_of(
          [] { (void)plan_of("[sweep]\nskip_invalid = true\n[sweep.axes]\ncache.line = [\"33 B\"]\n"); }),
      "s.toml:1: sweep: no point of the sweep can be built; the first: s.toml:4: cache.line: must be a power "
      "of two, not 33 bytes");
}

TEST(SweepPlan, PointsWhoseBaseCannotBeBuiltMayBeLeftOut) {
  // 128 B are four lines: enough for the point's four ways, not for the base's eight.
  const SweepPlan plan = plan_of(
      "[sweep]\nskip_invalid = true\n[sweep.axes]\ncache.size = [\"16 KiB\", \"128 B\"]\n[sweep.base]\n"
      "cache.ways = 8\n");
  EXPECT_EQ(plan.points.size(), 1U);
  ASSERT_EQ(plan.skipped.size(), 1U);
  EXPECT_EQ(plan.skipped[0].point, "cache.size = \"128 B\"");
  EXPECT_TRUE(plan.skipped[0].reason.ends_with("(its base)")) << plan.skipped[0].reason;
}

// Parts of a file in any combination make a plan or one message that names the file.
RC_GTEST_PROP(SweepPlan, SurvivesAnyParts, ()) {
  static const std::array<std::vector<std::string>, 9> blocks = {{
      {"", "[sweep]\n", "[sweep]\nskip_invalid = true\n", "[sweep]\nfilter = \"machine.nodes > 1\"\n",
       "[sweep]\nfilter = \"point = 'a' or cache.size < 4 KiB\"\n", "[sweep]\naxes = 3\n",
       "[sweep]\nzip = []\n", "[sweep]\npoints = []\n", "[sweep]\naxes = {}\n"},
      {"", "[sweep.axes]\n"},
      {"", "machine.nodes = [1, 2]\n", "machine.nodes = []\n", "machine.nodes = 3\n",
       "machine.nodes = \"-9223372036854775808..9223372036854775807*3\"\n",
       "machine.nodes = \"1..16777216*1.5\"\n"},
      {"", "cache.size = \"1 KiB..64 KiB*2\"\n", "cache = { ways = [1], size = [64] }\n", "cache = {}\n",
       "cache.ways = [[1]]\n", "cache.organisation = [\"none\", \"unified\"]\n"},
      {"", "[sweep.axes.node]\nclock = [\"33 MHz\"]\n", "[sweep.axes.node]\nclock = [\"33 mHz\"]\n",
       "[sweep.axes.count]\nsharing = [true, false]\n"},
      {"", "[[sweep.zip]]\n", "[[sweep.zip]]\ncache.line = [16, 32]\nmemory.banks = [1, 2]\n",
       "[[sweep.zip]]\nmachine.nodes = [1, 1]\n", "[sweep.zip]\ncache.line = [16]\n"},
      {"", "[sweep.points.a]\nmemory.banks = 2\n",
       "[sweep.points.a]\n[sweep.points.\"b c\"]\nimage.width = 8\n", "[sweep.points.'\"']\n"},
      {"", "[sweep.base]\ncache.organisation = \"none\"\n", "[sweep.base]\n",
       "[sweep.base]\nmachine.nodes = [1]\n"},
      {"", "[sweep.compare]\n", "[sweep.compare]\nmachine.scheme = \"space\"\n",
       "[sweep.compare.cache]\nsize = 3\n"},
  }};
  std::string text;
  for (const std::vector<std::string>& block : blocks) {
    text += *rc::gen::elementOf(block);
  }
  try {
    const SweepPlan plan = plan_of(text);
    RC_ASSERT(!plan.points.empty());
    RC_ASSERT(describe(plan).starts_with("axes"));
    for (const SweepPoint& point : plan.points) {
      RC_ASSERT(point.values.size() == plan.axes.size());
      RC_ASSERT(point.machine < plan.machines.size());
      RC_ASSERT(point.base < plan.machines.size());
    }
  } catch (const sim::UserError& error) {
    RC_ASSERT(std::string(error.what()).starts_with("s.toml:"));
  }
}

TEST(SweepPlan, IsDescribed) {
  const SweepPlan plan = plan_of(
      "[sweep.axes]\nmachine.nodes = \"2..20+2\"\n[[sweep.zip]]\ncache.ways = [1, 2]\n"
      "cache.size = [\"1 KiB\", \"2 KiB\"]\n[sweep]\nfilter = \"machine.nodes <> 6\"\n");
  SweepOutlook outlook;
  outlook.machines_done = 3;
  outlook.machine_bytes = 1024;
  EXPECT_EQ(describe(plan, outlook),
            "axes          machine.nodes: 2, 4, 6, 8, 10, 12, ..., 20 (10 values)\n"
            "              cache.ways and cache.size: 1 and 1 KiB, 2 and 2 KiB\n"
            "points        18, 2 more do not pass the filter\n"
            "frames        1 functional run, 0 done\n"
            "machines      20 (18 of points, 2 to measure them against), 3 done\n"
            "price         6.0625 to 25.25 a machine\n"
            "memory        about 1.0 KiB for the machines that are timed at once\n");
}

TEST(SweepPlan, ShippedSweepsAreWhatTheySay) {
  const auto load = [](const std::string& name) {
    sim::Config config =
        sim::Config::from_file(sweep_schema(), std::string(MARTI_SOURCE) + "/configs/" + name);
    return plan_sweep(config);
  };
  const SweepPlan thousand = load("sweep.toml");
  EXPECT_EQ(thousand.points.size(), 1000U);
  EXPECT_EQ(thousand.machines.size(), 1000U);
  EXPECT_EQ(thousand.frames.size(), 1U);
  EXPECT_TRUE(thousand.compare.has_value());
  const SweepPlan small = load("sweep-small.toml");
  EXPECT_EQ(small.points.size(), 32U);
  EXPECT_EQ(small.filtered_out, 8U);
}

TEST(Digest, IsFnv1aOf128Bits) {
  // Test vectors of draft-eastlake-fnv.
  const auto digest = [](std::string_view text) {
    Digest made;
    for (const char c : text) {
      made.add({&c, 1});
    }
    return made.hex();
  };
  EXPECT_EQ(digest(""), "6c62272e07bb014262b821756295c58d");
  EXPECT_EQ(digest("a"), "d228cb696f1a8caf78912b704e4a8964");
  EXPECT_EQ(digest("foobar"), "343e1662793c64bf6f0d3597ba446f18");
}

}  // namespace
}  // namespace marti::studies
