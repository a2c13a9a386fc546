// What is kept from frame to frame, and what the four ways spend on building the rest.
#include "studies/frames/frame_ways.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "processors/program/render.h"
#include "processors/walk/build_start.h"
#include "scenes/animated.h"
#include "scenes/procedural.h"
#include "studies/frames/frame_sequence.h"
#include "studies/frames/frame_tables.h"
#include "studies/paper/level_counts.h"
#include "tests/support/random_machine.h"

namespace marti::studies {

using namespace frames;
using namespace paper;

namespace {

using processors::walk::BranchStart;

/// A heap of tetrahedra; at every whole second the vertices that `moves` chooses are somewhere else.
class Shaken : public scenes::PoseSource {
 public:
  explicit Shaken(std::function<bool(std::size_t)> moves, std::string scene = "tetra:3")
      : base_(scenes::make_procedural(scene)), moves_(std::move(moves)) {}
  [[nodiscard]] scenes::Scene at(double seconds) const override {
    scenes::Scene scene = base_;
    for (std::size_t v = 0; v < scene.positions.size(); ++v) {
      if (moves_(v)) {
        const double far = 0.02 * seconds * (1.0 + static_cast<double>(v % 7));
        scene.positions[v][static_cast<int>(v % 3)] += far;
      }
    }
    return scene;
  }
  [[nodiscard]] bool moves() const override { return true; }
  [[nodiscard]] double duration() const override { return 100.0; }
  [[nodiscard]] scenes::MotionFacts facts() const override { return {}; }

 private:
  scenes::Scene base_;
  std::function<bool(std::size_t)> moves_;
};

processors::machine::MachineConfig machine_of(std::uint32_t nodes, processors::machine::InitialTree initial,
                                              std::uint32_t level = 1) {
  processors::machine::MachineConfig machine;
  machine.nodes = nodes;
  machine.build.sharing = processors::machine::Sharing::shared;
  machine.build.initial = initial;
  machine.build.level = level;
  machine.build.rule_k = 10.0;
  return machine;
}

struct Timed {
  FrameTree tree;
  std::shared_ptr<const processors::program::WorkLog> log;
  WayOutcomes ways;
};

const WayOutcome& way(const Timed& frame, FrameWay which) {
  return frame.ways[static_cast<std::size_t>(which)];
}

std::vector<Timed> time_frames(std::shared_ptr<const scenes::PoseSource> source, std::uint32_t count,
                               const processors::machine::MachineConfig& machine) {
  const FrameSequence sequence(scenes::AnimatedScene(std::move(source)), {count, 0, 1.0});
  accel::OctreeOptions options;
  options.max_objects = 4;
  options.max_level = 6;
  options.enclose = sequence.bounds();
  FrameWays ways(machine);
  std::vector<Timed> frames;
  frames.reserve(count);
  sequence.visit([&](const PosedFrame& pose) {
    const FrameTree* before = frames.empty() ? nullptr : &frames.back().tree;
    Timed frame{make_frame_tree(before, pose.scene, options), nullptr, {}};
    const processors::program::RenderOptions render{.width = 12, .height = 8, .max_depth = 2, .record = true};
    frame.log =
        processors::program::render(pose.scene, *frame.tree.triangles, *frame.tree.octree, render).log;
    frame.ways = ways.time(*frame.log, frame.tree.update ? &*frame.tree.update : nullptr);
    frames.push_back(std::move(frame));
  });
  return frames;
}

void expect_equal(const WayOutcome& a, const WayOutcome& b) {
  EXPECT_EQ(a.build, b.build);
  EXPECT_EQ(a.render, b.render);
  EXPECT_EQ(a.building, b.building);
  EXPECT_EQ(a.start_up_splits, b.start_up_splits);
  EXPECT_EQ(a.splits, b.splits);
  EXPECT_EQ(a.branches, b.branches);
  EXPECT_EQ(a.partial, b.partial);
  EXPECT_EQ(a.bytes, b.bytes);
}

std::int64_t branches_of(const accel::Topology& topology) {
  std::int64_t branches = 0;
  for (const accel::TopologyNode& node : topology.nodes) {
    branches += node.leaf ? 0 : 1;
  }
  return branches;
}

TEST(FrameWays, WhereNothingMovesNothingIsBuiltAgain) {
  const auto frames = time_frames(std::make_shared<Shaken>([](std::size_t) { return false; }), 3,
                                  machine_of(3, processors::machine::InitialTree::rule));
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const TreeChange change = change_of(frames[i].tree);
    EXPECT_EQ(change.moved, 0U);
    EXPECT_EQ(change.altered, 0U);
    EXPECT_EQ(change.sorted, 0U);
    for (const FrameWay kept : {FrameWay::partial, FrameWay::partial_dynamic}) {
      EXPECT_EQ(way(frames[i], kept).build, 0);
      EXPECT_EQ(way(frames[i], kept).all_splits(), 0);
      EXPECT_EQ(way(frames[i], kept).building, 0);
      EXPECT_EQ(way(frames[i], kept).branches, way(frames[0], kept).branches);
      EXPECT_EQ(way(frames[i], kept).bytes, way(frames[0], kept).bytes);
    }
    // Ways that keep nothing do the same work again.
    expect_equal(way(frames[i], FrameWay::rebuild_all), way(frames[0], FrameWay::rebuild_all));
    expect_equal(way(frames[i], FrameWay::dynamic), way(frames[0], FrameWay::dynamic));
    EXPECT_GT(way(frames[i], FrameWay::rebuild_all).build, 0);
  }
}

TEST(FrameWays, WhereEverythingMovesNothingIsKept) {
  const auto frames = time_frames(std::make_shared<Shaken>([](std::size_t) { return true; }), 3,
                                  machine_of(3, processors::machine::InitialTree::level, 1));
  const TreeChange first = change_of(frames[0].tree);
  EXPECT_EQ(first.altered, first.nodes) << "there was none before";
  EXPECT_EQ(first.sorted, first.all_sorted);
  for (const Timed& frame : frames) {
    EXPECT_EQ(way(frame, FrameWay::partial).all_splits(), branches_of(frame.tree.topology()));
    expect_equal(way(frame, FrameWay::partial), way(frame, FrameWay::rebuild_all));
    // All nodes are P nodes again: as with nothing built beforehand.
    expect_equal(way(frame, FrameWay::partial_dynamic), way(frame, FrameWay::dynamic));
  }
}

/// The result of carried_starts, computed from kept branches upwards instead of from the leaves.
std::vector<BranchStart> carried_upwards(const accel::OctreeUpdate& update,
                                         const std::vector<std::uint8_t>& built) {
  const auto& nodes = update.build.topology.nodes;
  std::vector<std::uint32_t> parent(nodes.size());
  std::vector<BranchStart> starts(nodes.size(), BranchStart::kept);
  for (std::uint32_t node = 0; node < nodes.size(); ++node) {
    for (std::uint32_t child = 0; !nodes[node].leaf && child < nodes[node].count; ++child) {
      parent[nodes[node].first + child] = node;
    }
    if (!nodes[node].leaf) {
      starts[node] = BranchStart::lazy;
    }
  }
  for (std::uint32_t node = 0; node < nodes.size(); ++node) {
    if (nodes[node].leaf || update.altered(node) || built[update.was[node]] == 0) {
      continue;
    }
    starts[node] = BranchStart::kept;
    for (std::uint32_t up = node; up != 0; up = parent[up]) {
      if (update.altered(parent[up])) {
        starts[parent[up]] = BranchStart::eager;
      }
    }
  }
  return starts;
}

// Some vertices move; the machine has one tree, so that every count is known beforehand.
RC_GTEST_PROP(FrameWays, EveryBranchIsKeptOrSplitOrLeft, (std::uint64_t seed)) {
  test::Random random(seed);
  // Mostly a few neighbours, so that large parts of the tree stay.
  const std::size_t vertices = scenes::make_procedural("teapot:2:pot").positions.size();
  const auto from = static_cast<std::size_t>(test::pick(random, 0, static_cast<std::int64_t>(vertices)));
  const std::size_t to = from + static_cast<std::size_t>(test::pick(random, 1, 20));
  const auto initial = static_cast<processors::machine::InitialTree>(test::pick(random, 0, 2));
  const auto level = static_cast<std::uint32_t>(test::pick(random, 1, 5));
  const auto frames = time_frames(
      std::make_shared<Shaken>([=](std::size_t v) { return v >= from && v < to; }, "teapot:2:pot"), 3,
      machine_of(static_cast<std::uint32_t>(test::pick(random, 1, 4)), initial, level));
  std::vector<std::uint8_t> built;  // by the log alone
  for (const Timed& frame : frames) {
    const accel::Topology& topology = frame.tree.topology();
    const std::int64_t branches = branches_of(topology);
    const WayOutcome& rebuild = way(frame, FrameWay::rebuild_all);
    const WayOutcome& partial = way(frame, FrameWay::partial);
    const WayOutcome& both = way(frame, FrameWay::partial_dynamic);
    RC_ASSERT(rebuild.start_up_splits == branches && rebuild.splits == 0);
    RC_ASSERT(partial.splits == 0 && partial.branches == branches && partial.bytes == rebuild.bytes);

    std::vector<BranchStart> starts;
    if (frame.tree.update) {
      const accel::OctreeUpdate& update = *frame.tree.update;
      std::int64_t kept = 0;
      for (std::uint32_t node = 0; node < topology.nodes.size(); ++node) {
        kept += !topology.nodes[node].leaf && !update.altered(node) ? 1 : 0;
      }
      RC_ASSERT(partial.start_up_splits == branches - kept);
      starts = carried_upwards(update, built);
      RC_ASSERT(carried_starts(update, built) == starts);
    } else {
      starts = processors::walk::branch_starts(topology, machine_of(1, initial, level).build);
    }
    const NodeVisits visits = count_visits(*frame.log);
    built.assign(topology.nodes.size(), 0);
    std::int64_t eager = 0;
    std::int64_t demanded = 0;
    std::int64_t there = 0;
    for (std::size_t node = 0; node < topology.nodes.size(); ++node) {
      if (topology.nodes[node].leaf) {
        continue;
      }
      const bool lazy = starts[node] == BranchStart::lazy;
      built[node] = !lazy || visits.touched[node] != 0 ? 1 : 0;
      eager += starts[node] == BranchStart::eager ? 1 : 0;
      demanded += lazy && built[node] != 0 ? 1 : 0;
      there += built[node];
    }
    RC_CLASSIFY(frame.tree.update && eager > 0, "re-sorted above kept branches");
    RC_CLASSIFY(frame.tree.update && demanded > 0, "split on demand again");
    RC_ASSERT(both.start_up_splits == eager);
    RC_ASSERT(both.splits == demanded);
    RC_ASSERT(both.branches == there);
    RC_ASSERT(both.all_splits() <= rebuild.start_up_splits);
  }
}

// Several trees: a branch counts as built where all of them have it. There is work for one node only, so the
// others have nothing below the initial tree.
TEST(FrameWays, OfPrivateTreesThatIsKeptWhichAllHave) {
  const scenes::Scene scene = scenes::make_procedural("teapot:2:pot");
  const FrameTree tree = make_frame_tree(nullptr, scene, {});
  const processors::program::RenderOptions render{.width = 8, .height = 8, .record = true};
  const auto log = processors::program::render(scene, *tree.triangles, *tree.octree, render).log;
  const NodeVisits visits = count_visits(*log);
  processors::machine::MachineConfig machine = machine_of(1, processors::machine::InitialTree::level, 2);
  machine.build.sharing = processors::machine::Sharing::private_trees;
  machine.packets.width = 8;
  machine.packets.height = 8;
  processors::replay::ReplayOptions options;
  EXPECT_TRUE(processors::replay::replay(*log, machine, options).build.built.empty()) << "nobody has asked";
  options.report_built = true;
  const std::vector<std::uint8_t> alone = processors::replay::replay(*log, machine, options).build.built;
  machine.nodes = 4;
  const std::vector<std::uint8_t> four = processors::replay::replay(*log, machine, options).build.built;
  const auto& nodes = tree.topology().nodes;
  ASSERT_EQ(alone.size(), nodes.size());
  ASSERT_EQ(four.size(), nodes.size());
  int more = 0;
  for (std::size_t node = 0; node < nodes.size(); ++node) {
    const bool initial = !nodes[node].leaf && nodes[node].level < 2;
    EXPECT_EQ(alone[node] != 0, !nodes[node].leaf && (initial || visits.touched[node] != 0)) << node;
    EXPECT_EQ(four[node] != 0, initial) << node;
    more += alone[node] - four[node];
  }
  EXPECT_GT(more, 0);
}

}  // namespace
}  // namespace marti::studies
