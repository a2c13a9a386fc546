// The study of frames with a bounding volume hierarchy.
#include "studies/frames/refit_frames.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "accel/bvh.h"
#include "processors/replay/replay.h"
#include "scenes/procedural.h"
#include "sim/config.h"
#include "studies/frames/frames.h"
#include "studies/frames/refit_tables.h"
#include "studies/frames/refit_work.h"
#include "studies/keys/machine_keys.h"
#include "studies/run/functional_run.h"
#include "studies/run/run_result.h"
#include "studies/tables/csv.h"
#include "tests/support/study_tables.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/wrong_configurations.h"
#include "tests/unit/scenes/gltf_file.h"

namespace marti::studies {

using namespace frames;
using namespace tables;

using test::table_of;

namespace {

const std::string swinging = "[scene]\nsource = \"" MARTI_SOURCE "/configs/scenes/swing.glb\"\n";
const std::string small_bvh =
    "[frames]\ncount = 3\nfirst = 2\nrate = 8\n[image]\nwidth = 32\nheight = 24\nmax_depth = 2\n"
    "[machine]\nnodes = 3\n[structure]\nkind = \"bvh\"\n";

StudyOutput study(const std::string& text) {
  sim::Config config = sim::Config::from_text(run::run_schema(), text, "frames.toml");
  return run_frames(config);
}

std::int64_t number(const Table& table, std::size_t row, const char* column) {
  return std::get<std::int64_t>(table.at(row, column));
}

TEST(RefitFrames, RebuiltFramesAreThoseOfRunsOfOneFrame) {
  const StudyOutput output = study(swinging + small_bvh);
  const Table& refits = table_of(output, "refits");
  ASSERT_EQ(refits.rows().size(), 6U);
  for (std::uint32_t i = 0; i < 3; ++i) {
    sim::Config config = sim::Config::from_text(
        run::run_schema(), swinging + small_bvh, "frames.toml",
        std::vector<std::string>{"frames.count=1", "frames.first=" + std::to_string(2 + i)});
    const run::FunctionalRun one = run::run_functional(keys::read_frame(config));
    EXPECT_EQ(output.images[i].image.pixels, one.frame.image.pixels);
    const auto machine = keys::read_machine(config);
    EXPECT_EQ(number(refits, 2 * i, "render"), processors::replay::replay(*one.frame.log, machine).end);
  }
}

TEST(RefitFrames, RefittingWritesLessAndWalksMore) {
  const StudyOutput output = study(swinging + small_bvh);
  const Table& frames = table_of(output, "frames");
  const Table& refits = table_of(output, "refits");
  const Table& totals = table_of(output, "totals");
  EXPECT_EQ(number(refits, 0, "records"), number(refits, 1, "records"));  // of a first tree all are written
  EXPECT_EQ(number(refits, 0, "render"), number(refits, 1, "render"));
  std::int64_t written = 0;
  for (std::size_t frame = 1; frame < 3; ++frame) {
    EXPECT_EQ(number(frames, frame, "moved"), 1432);
    EXPECT_EQ(number(refits, 2 * frame, "records"), number(frames, frame, "branches"));
    EXPECT_LT(number(refits, 2 * frame + 1, "records"), number(refits, 2 * frame, "records"));
    EXPECT_GT(number(refits, 2 * frame + 1, "records"), 1432 / 24);  // each has eight leaves of three at most
    written += number(refits, 2 * frame + 1, "written");
  }
  EXPECT_EQ(number(totals, 1, "written"), written);
  EXPECT_NE(output.report.find("\nRefitting writes "), std::string::npos);
}

TEST(RefitFrames, MakingTheTreeIsAPartOfTheCycle) {
  const StudyOutput output = study(swinging + small_bvh);
  const Table& refits = table_of(output, "refits");
  for (const char* column : {"compute", "transfer", "making", "cycle"}) {  // a first tree is built in any way
    EXPECT_EQ(number(refits, 0, column), number(refits, 1, column)) << column;
  }
  std::array<std::int64_t, 2> cycles{};
  for (std::size_t row = 0; row < 6; ++row) {
    const std::int64_t making = number(refits, row, "making");
    EXPECT_EQ(making, std::max(number(refits, row, "compute"), number(refits, row, "transfer")));
    EXPECT_EQ(number(refits, row, "cycle"), making + number(refits, row, "render"));
    cycles[row % 2] += row < 2 ? 0 : number(refits, row, "cycle");
  }
  for (std::size_t way = 0; way < 2; ++way) {
    EXPECT_EQ(number(table_of(output, "totals"), way, "cycle"), cycles[way]);
  }
  // All records are of 256 bytes. What is refitted is read and written, and the leaves' triangles are read
  // with their lists: those that moved, and others of their leaves, of three at most.
  for (const std::size_t row : {3U, 5U}) {
    EXPECT_EQ(number(refits, row, "written"), 256 * number(refits, row, "records"));
    const std::int64_t leaves = number(refits, row, "moves") - 2 * number(refits, row, "written");
    EXPECT_EQ(leaves % (48 + 4), 0);
    EXPECT_GE(leaves, 1432 * (48 + 4));
    EXPECT_LE(leaves, 3 * 1432 * (48 + 4));
    EXPECT_LT(number(refits, row, "making"), number(refits, row - 1, "making"));
  }
}

TEST(RefitFrames, ATreeIsMadeFasterByAFasterClock) {
  const std::string ideal = swinging + small_bvh + "[interconnect]\nkind = \"ideal\"\n";
  const Table slow = table_of(study(ideal + "[node]\nclock = \"10 MHz\"\n"), "refits");
  const Table fast = table_of(study(ideal + "[node]\nclock = \"20 MHz\"\n"), "refits");
  for (std::size_t row = 0; row < 6; ++row) {
    EXPECT_EQ(number(slow, row, "transfer"), 0);
    EXPECT_EQ(number(slow, row, "making"), 2 * number(fast, row, "making"));
  }
}

// What a naive walk down the tree finds to be refitted; visit() returns how many such branches lie one below
// another.
struct NaiveRefit {
  const accel::Topology& topology;
  const std::vector<bool>& moved;
  processors::cost::TreeWork work{};

  [[nodiscard]] bool holds_moved(std::uint32_t number) const {
    const accel::TopologyNode& node = topology.nodes[number];
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      if (node.leaf ? moved[topology.entries[i]] : holds_moved(i)) {
        return true;
      }
    }
    return false;
  }
  std::uint32_t visit(std::uint32_t number) {
    if (!holds_moved(number)) {
      return 0;
    }
    const accel::TopologyNode& node = topology.nodes[number];
    work.merged += number == 0 ? 0 : node.count - 1;
    if (node.leaf) {
      work.triangles += node.count;
      return 0;
    }
    ++work.branches;
    std::uint32_t deepest = 0;
    for (std::uint32_t child = node.first; child < node.first + node.count; ++child) {
      deepest = std::max(deepest, visit(child));
    }
    return deepest + 1;
  }
};

TEST(RefitFrames, TheWorkIsThatOfANaiveWalk) {
  const auto set = std::make_shared<const accel::TriangleSet>(scenes::make_procedural("teapot:3"));
  for (const accel::BvhNodeKind kind : {accel::BvhNodeKind::two, accel::BvhNodeKind::eight}) {
    const accel::Bvh tree = accel::Bvh::build(set, {.node = kind});
    for (const std::uint32_t every : {1U, 7U, 200U}) {
      Moved moved;
      for (std::uint32_t id = 0; id < set->size(); ++id) {
        moved.primitives.push_back(id % every == 0);
      }
      NaiveRefit naive{tree.topology(), moved.primitives};
      const std::uint32_t levels = naive.visit(0);
      const processors::cost::TreeWork work = work_of(tree, moved, RefitWay::refit);
      EXPECT_EQ(work.branches, naive.work.branches);
      EXPECT_EQ(work.merged, naive.work.merged);
      EXPECT_EQ(work.triangles, naive.work.triangles);
      EXPECT_EQ(work.levels, levels);
      EXPECT_GT(levels, 1U);
      const processors::cost::TreeWork all = work_of(tree, moved, RefitWay::rebuild);
      EXPECT_EQ(all.triangles, set->size());
      EXPECT_EQ(all.build, tree.work());
      EXPECT_GE(all.branches, work.branches);
    }
  }
}

RefitFrame frame_with(std::array<sim::Ticks, 3> making, std::array<sim::Ticks, 3> render) {
  RefitFrame frame;
  for (std::size_t way = 0; way < 3; ++way) {
    frame.ways[way].making.compute = making[way];
    frame.ways[way].render = render[way];
  }
  return frame;
}

TEST(RefitFrames, TheAnswerNamesTheShortestCycleAndHowSureItIs) {
  const RefitFrame first = frame_with({900, 900, 900}, {900, 900, 900});
  const auto line = [&](const RefitFrame& later, bool instances) {
    return refit_answer(std::vector{first, later, later}, instances).front();
  };
  EXPECT_EQ(
      line(frame_with({100, 0, 20}, {400, 0, 430}), false),
      "Refitting has the shortest cycles, 900 ps for 2 frames, 10.0 % less than rebuild, unless its trees "
      "take 3.50 times the least time");
  EXPECT_EQ(
      line(frame_with({100, 40, 20}, {400, 400, 480}), true),
      "Rebuilding the top level has the shortest cycles, 880 ps for 2 frames, 12.0 % less than rebuild, "
      "unless its trees take 2.50 times the least time");
  EXPECT_EQ(
      line(frame_with({100, 0, 20}, {400, 0, 500}), false),
      "Rebuilding has the shortest cycles, 0.001 us for 2 frames, 3.8 % less than refit, unless its trees "
      "take 1.20 times the least time");
  EXPECT_EQ(line(frame_with({100, 0, 0}, {400, 0, 400}), false),
            "Refitting has the shortest cycles, 800 ps for 2 frames, 20.0 % less than rebuild");
  EXPECT_EQ(line(frame_with({100, 0, 50}, {400, 0, 450}), false),
            "The cycles of rebuild and refit are equally long, 0.001 us at least");
  // Rebuilding becomes better in the third frame.
  RefitFrame last = frame_with({100, 0, 20}, {400, 0, 490});
  last.number = 2;
  EXPECT_EQ(refit_answer(std::vector{first, frame_with({100, 0, 20}, {400, 0, 430}), last}, false).back(),
            "Frame 2 is the first whose cycle is shorter with the rebuilt tree");
  EXPECT_EQ(refit_answer(std::vector{first}, false).front(), "One frame: there is nothing to refit");
}

TEST(RefitFrames, WhereNothingMovesNothingIsRefitted) {
  const StudyOutput output = study("[scene]\nsource = \"tetra:3\"\n" + small_bvh);
  const Table& refits = table_of(output, "refits");
  EXPECT_EQ(number(refits, 3, "records"), 0);
  EXPECT_EQ(number(refits, 3, "making"), 0);
  EXPECT_EQ(number(refits, 2, "making"), number(refits, 0, "making"));
  EXPECT_EQ(number(refits, 3, "render"), number(refits, 0, "render"));
}

// Four nodes share a mesh of two triangles; one moves, and one triangle of a mesh of its own as well.
TEST(RefitFrames, OfKeptInstancesTheTopLevelAloneIsMade) {
  const test::TemporaryDirectory directory;
  scenes::testing::GltfFile file = scenes::testing::GltfFile::square();
  file.json["nodes"] = {{{"mesh", 0}},
                        {{"mesh", 0}, {"translation", {2, 0, 0}}},
                        {{"mesh", 0}, {"translation", {0, 2, 0}}},
                        {{"mesh", 0}, {"translation", {2, 2, 0}}}};
  file.json["scenes"] = {{{"nodes", {0, 1, 2, 3}}}};
  file.json["animations"] = {
      {{"samplers",
        {{{"input", file.add_accessor<float>({0, 1}, 5126, "SCALAR", 1)},
          {"output", file.add_positions({2, 0, 0, 2, -1, 1})}}}},
       {"channels", {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "translation"}}}}}}}};
  const std::string text = "[scene]\nsource = \"" + file.write_glb(directory.path(), "a.glb").string() +
                           "\"\n" + small_bvh +
                           "instances = \"kept\"\nbvh_children = \"2\"\n[layout]\ntransform = \"48 B\"\n";
  const StudyOutput output = study(text);
  const Table& frames = table_of(output, "frames");
  const Table& refits = table_of(output, "refits");
  ASSERT_EQ(refits.rows().size(), 9U);
  EXPECT_EQ(number(frames, 1, "moved"), 2);
  // Three branches over four instances, and the root of their mesh.
  EXPECT_EQ(number(frames, 1, "branches"), 8);
  EXPECT_EQ(number(refits, 3, "records"), 8);
  EXPECT_EQ(number(refits, 4, "records"), 7);
  EXPECT_EQ(number(refits, 5, "records"), 3);  // the instance, and two branches above it
  // Node records of 64 bytes, and transforms of 48.
  EXPECT_EQ(number(refits, 3, "written"), 4 * 64 + 4 * 48);
  EXPECT_EQ(number(refits, 4, "written"), 3 * 64 + 4 * 48);
  EXPECT_EQ(number(refits, 5, "written"), 2 * 64 + 48);
  EXPECT_EQ(number(refits, 4, "render"), number(refits, 3, "render"));
  // The mesh's two triangles need not be read, nor its record and list be written.
  EXPECT_EQ(number(refits, 3, "moves") - number(refits, 4, "moves"), 2 * 48 + 64 + 2 * 4);
  EXPECT_LT(number(refits, 4, "compute"), number(refits, 3, "compute"));
  EXPECT_LT(number(refits, 5, "compute"), number(refits, 4, "compute"));
  EXPECT_EQ(csv_of(refits), csv_of(table_of(study(text), "refits")));
}

TEST(RefitFrames, WrongConfigurationsAreRefused) {
  const std::vector<test::WrongConfiguration> cases = {
      {"[structure]\nkind = \"grid\"\n", {"frames.toml:2", "structure.kind", "octree", "bvh"}},
      {"[structure]\nkind = \"bvh\"\n[build]\nsharing = \"shared\"\n", {"frames.toml:4", "build.sharing"}},
      {"[structure]\nkind = \"bvh\"\n[frames]\nverify = true\n",
       {"frames.toml:4", "frames.verify", "always"}},
      {"[structure]\nkind = \"bvh\"\n[machine]\nnodes = 65536\n[cache]\nsize = \"64 MiB\"\n",
       {"frames.toml:4", "machine.nodes"}},
  };
  test::expect_refusals(cases, [](const char* text) { study(text); });
}

}  // namespace
}  // namespace marti::studies
