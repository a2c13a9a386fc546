#include "studies/frames/frame_tree.h"

#include <chrono>
#include <utility>

#include "sim/error.h"

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

}  // namespace marti::studies::frames
