#include "accel/two_level.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "accel/moved_primitives.h"
#include "sim/error.h"

namespace marti::accel {

namespace {

// In diagonals of a mesh: from so far away rays are not far.
constexpr double reach_of_meshes = 0x1p14;

scenes::Bounds box_of(const std::vector<Instance>& instances) {
  scenes::Bounds all;
  for (const Instance& instance : instances) {
    all.include(instance.box().lo);
    all.include(instance.box().hi);
  }
  return all;
}

double diagonal_of(const scenes::Bounds& box) {
  const glm::dvec3 extent = box.hi - box.lo;
  return box.empty() ? 0.0 : std::hypot(extent.x, extent.y, extent.z);
}

// A leaf of the top level is one instance.
BvhOptions of_top(BvhOptions options) {
  options.max_objects = 1;
  return options;
}

std::vector<scenes::Bounds> mesh_boxes(const TriangleSet& triangles) {
  std::vector<scenes::Bounds> boxes;
  for (const PrimitiveRange& mesh : triangles.meshes()) {
    sim::ensure(mesh.count > 0, "a mesh without primitives");
    boxes.push_back(triangles.bounds(mesh));
  }
  return boxes;
}

}  // namespace

std::shared_ptr<const TriangleSet> TwoLevelBvh::place_instances(const std::vector<scenes::Bounds>& boxes) {
  const std::vector<PrimitiveRange>& meshes = triangles_->meshes();
  instances_.reserve(triangles_->instances().size());
  for (const scenes::InstancePlace& place : triangles_->instances()) {
    // Modulo 2^32, as ids are.
    instances_.emplace_back(place, boxes[place.mesh], place.first - meshes[place.mesh].first);
    far_rounding_ = std::max(far_rounding_, instances_.back().stretch());
  }
  const double margin = far_rounding_ * 0x1p-42 * diagonal_of(box_of(instances_));
  std::vector<TriangleCorners> corners;
  corners.reserve(instances_.size());
  for (const Instance& instance : instances_) {
    const glm::dvec3 lo = instance.box().lo - margin;
    const glm::dvec3 hi = instance.box().hi + margin;
    corners.push_back({lo.x, lo.y, lo.z, hi.x, hi.y, hi.z, lo.x, lo.y, lo.z});
  }
  return std::make_shared<const TriangleSet>(std::move(corners));
}

TwoLevelBvh TwoLevelBvh::build(std::shared_ptr<const TriangleSet> triangles, const BvhOptions& options) {
  TwoLevelBvh tree;
  tree.triangles_ = std::move(triangles);
  tree.options_ = options;
  const std::vector<scenes::Bounds> boxes = mesh_boxes(*tree.triangles_);
  tree.top_ = Bvh::build(tree.place_instances(boxes), of_top(options));
  for (std::size_t m = 0; m < boxes.size(); ++m) {
    tree.meshes_.push_back(Bvh::build(tree.triangles_, tree.triangles_->meshes()[m],
                                      make_frame(boxes[m], reach_of_meshes), options));
  }
  tree.join_trees();
  return tree;
}

TwoLevelBvh TwoLevelBvh::moved(std::shared_ptr<const TriangleSet> after, Update update) const {
  const std::vector<PrimitiveRange>& meshes = triangles_->meshes();
  const auto same_range = [](const PrimitiveRange& a, const PrimitiveRange& b) {
    return a.first == b.first && a.count == b.count;
  };
  const auto same_mesh = [](const scenes::InstancePlace& a, const scenes::InstancePlace& b) {
    return a.mesh == b.mesh;
  };
  if (!std::ranges::equal(meshes, after->meshes(), same_range) ||
      !std::ranges::equal(triangles_->instances(), after->instances(), same_mesh)) {
    throw sim::UserError("a tree of instances cannot be moved to other meshes or instances");
  }
  TwoLevelBvh tree;
  tree.triangles_ = std::move(after);
  tree.options_ = options_;
  const std::vector<std::uint32_t> primitives = moved_primitives(*triangles_, *tree.triangles_);
  const std::vector<scenes::Bounds> boxes = mesh_boxes(*tree.triangles_);
  const std::shared_ptr<const TriangleSet> instances = tree.place_instances(boxes);
  tree.top_ = update == Update::refit ? top_.refitted(instances) : Bvh::build(instances, of_top(options_));
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    const std::uint32_t end =
        m + 1 < meshes.size() ? meshes_[m + 1].root() : static_cast<std::uint32_t>(topology_.nodes.size());
    const RootFrame frame = make_frame(boxes[m], reach_of_meshes);
    const auto next = std::ranges::lower_bound(primitives, meshes[m].first);
    const bool stays = next == primitives.end() || *next >= meshes[m].first + meshes[m].count;
    if (!stays && update == Update::rebuild) {
      tree.meshes_.push_back(Bvh::build(tree.triangles_, meshes[m], frame, options_));
      continue;
    }
    Bvh mesh = meshes_[m];
    mesh.leave(topology_, end - mesh.root());
    mesh.triangles_ = tree.triangles_;
    tree.meshes_.push_back(stays ? std::move(mesh) : mesh.refitted(tree.triangles_, frame));
  }
  tree.join_trees();
  return tree;
}

void TwoLevelBvh::join_trees() {
  const Topology& top = top_.topology();
  unsigned deepest = 1;
  for (const TopologyNode& node : top.nodes) {
    deepest = std::max<unsigned>(deepest, node.level);
  }
  topology_.nodes = top.nodes;
  work_ = top_.work();
  for (Bvh& mesh : meshes_) {
    work_ += std::exchange(mesh.work_, {});
    mesh.join(topology_, deepest + 1);
  }
  instance_of_.resize(top.nodes.size());
  for (std::size_t n = 0; n < top.nodes.size() && !instances_.empty(); ++n) {
    if (const TopologyNode& node = top.nodes[n]; node.leaf) {
      const std::uint32_t instance = top.entries[node.first];
      instance_of_[n] = instance;
      topology_.nodes[n] = {meshes_[instances_[instance].mesh()].root(), 1, node.level, false, true};
    }
  }
}

std::uint64_t TwoLevelBvh::walk_bytes() const {
  std::uint64_t bytes = top_.walk_bytes() + bytes_of(top_.topology()) + instances_.size() * sizeof(Instance) +
                        instance_of_.size() * sizeof(std::uint32_t);
  for (const Bvh& mesh : meshes_) {
    bytes += sizeof(Bvh) + mesh.walk_bytes();
  }
  return bytes;
}

}  // namespace marti::accel
