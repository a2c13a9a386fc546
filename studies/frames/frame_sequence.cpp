#include "studies/frames/frame_sequence.h"

#include <chrono>
#include <utility>

#include "scenes/open.h"
#include "sim/error.h"
#include "studies/host/image_file.h"
#include "studies/run/functional_run.h"
#include "studies/run/open_frame.h"

namespace marti::studies::frames {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

}  // namespace

FrameTree make_frame_tree(const FrameTree* before, const scenes::Scene& scene,
                          const accel::OctreeOptions& options) {
  FrameTree tree;
  tree.triangles = std::make_shared<const accel::TriangleSet>(scene);
  const Clock::time_point begin = Clock::now();
  accel::Octree fresh = accel::Octree::build(tree.triangles, options);
  tree.build_seconds = seconds_since(begin);
  if (before == nullptr) {
    tree.octree = std::make_shared<const accel::StructureOf<accel::Octree>>(std::move(fresh));
    return tree;
  }
  const accel::Octree& old = before->octree->concrete();
  const Clock::time_point updating = Clock::now();
  tree.update = accel::update_octree(old, *tree.triangles);
  accel::Octree updated(tree.triangles, options, old.frame(), tree.update->build);
  tree.update_seconds = seconds_since(updating);
  sim::ensure(updated.topology() == fresh.topology(),
              "an updated octree differs from one built from nothing");
  tree.octree = std::make_shared<const accel::StructureOf<accel::Octree>>(std::move(updated));
  return tree;
}

using processors::walk::BranchStart;

std::vector<BranchStart> partial_starts(const accel::OctreeUpdate& update) {
  const auto& nodes = update.build.topology.nodes;
  std::vector<BranchStart> starts(nodes.size(), BranchStart::kept);
  for (std::uint32_t node = 0; node < nodes.size(); ++node) {
    if (!nodes[node].leaf && update.altered(node)) {
      starts[node] = BranchStart::eager;
    }
  }
  return starts;
}

std::vector<BranchStart> carried_starts(const accel::OctreeUpdate& update,
                                        std::span<const std::uint8_t> built) {
  const auto& nodes = update.build.topology.nodes;
  std::vector<BranchStart> starts(nodes.size(), BranchStart::kept);
  // Whether the node, or one below it, is a kept branch. Children have higher numbers than their parents.
  std::vector<std::uint8_t> holds(nodes.size());
  for (std::size_t left = nodes.size(); left-- > 0;) {
    const auto node = static_cast<std::uint32_t>(left);
    const accel::TopologyNode& branch = nodes[node];
    if (branch.leaf) {
      continue;
    }
    if (!update.altered(node)) {
      const std::uint32_t was = update.was[node];
      sim::ensure(was < built.size(), "a kept node was one of the old tree");
      holds[node] = built[was];
      starts[node] = built[was] != 0 ? BranchStart::kept : BranchStart::lazy;
      continue;
    }
    for (std::uint32_t child = branch.first; child < branch.first + branch.count; ++child) {
      holds[node] |= holds[child];
    }
    starts[node] = holds[node] != 0 ? BranchStart::eager : BranchStart::lazy;
  }
  return starts;
}

processors::program::Frame trace_pose(const keys::FrameConfig& config, const PosedFrame& pose,
                                      const accel::TriangleSet& triangles, const accel::Structure& structure,
                                      sim::WorkMeter& meter) {
  run::refuse_beyond_memory(config, pose.scene, triangles, structure);
  processors::program::RenderOptions options = config.render;
  options.record = true;
  options.meter = &meter;
  return processors::program::render(pose.scene, triangles, structure, options);
}

FrameSequence::FrameSequence(const keys::FrameConfig& config)
    : FrameSequence(run::with_scene_keys(
                        [&] { return scenes::open_animated(config.scene, config.open, host::decode_image); }),
                    config.frames) {}

FrameSequence::FrameSequence(scenes::AnimatedScene scene, const keys::FrameRange& range)
    : scene_(std::move(scene)), range_(range) {
  for (std::uint32_t i = 0; i < range_.count; ++i) {
    const scenes::Bounds frame = scenes::bounds_of(pose(i));
    if (!frame.empty()) {
      bounds_.include(frame.lo);
      bounds_.include(frame.hi);
    }
  }
}

scenes::Scene FrameSequence::pose(std::uint32_t i) const {
  return run::with_scene_keys([&] { return scene_.at(range_.time(i)); });
}

void FrameSequence::visit(const std::function<void(const PosedFrame&)>& visitor) const {
  PosedFrame before;
  for (std::uint32_t i = 0; i < range_.count; ++i) {
    PosedFrame frame;
    frame.number = range_.first + i;
    frame.seconds = range_.time(i);
    frame.scene = pose(i);
    if (i > 0) {
      frame.moved = scenes::moved_primitives(before.scene, frame.scene);
    }
    visitor(frame);
    before = std::move(frame);
  }
}

}  // namespace marti::studies::frames
