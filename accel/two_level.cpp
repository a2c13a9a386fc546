#include "accel/two_level.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

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

}  // namespace

TwoLevelBvh TwoLevelBvh::build(std::shared_ptr<const TriangleSet> triangles, const BvhOptions& options) {
  TwoLevelBvh tree;
  tree.triangles_ = std::move(triangles);
  const std::vector<PrimitiveRange>& meshes = tree.triangles_->meshes();
  const std::vector<scenes::InstancePlace>& instances = tree.triangles_->instances();
  std::vector<scenes::Bounds> boxes;
  for (const PrimitiveRange& mesh : meshes) {
    sim::ensure(mesh.count > 0, "a mesh without primitives");
    boxes.push_back(tree.triangles_->bounds(mesh));
  }
  tree.instances_.reserve(instances.size());
  for (const scenes::InstancePlace& place : instances) {
    // Modulo 2^32, as ids are.
    tree.instances_.emplace_back(place, boxes[place.mesh], place.first - meshes[place.mesh].first);
    tree.far_rounding_ = std::max(tree.far_rounding_, tree.instances_.back().stretch());
  }

  const double margin = tree.far_rounding_ * 0x1p-42 * diagonal_of(box_of(tree.instances_));
  std::vector<TriangleCorners> corners;
  corners.reserve(instances.size());
  for (const Instance& instance : tree.instances_) {
    const glm::dvec3 lo = instance.box().lo - margin;
    const glm::dvec3 hi = instance.box().hi + margin;
    corners.push_back({lo.x, lo.y, lo.z, hi.x, hi.y, hi.z, lo.x, lo.y, lo.z});
  }
  BvhOptions of_top = options;
  of_top.max_objects = 1;
  tree.top_ = Bvh::build(std::make_shared<const TriangleSet>(std::move(corners)), of_top);
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    tree.meshes_.push_back(
        Bvh::build(tree.triangles_, meshes[m], make_frame(boxes[m], reach_of_meshes), options));
  }

  const Topology& top = tree.top_.topology();
  unsigned deepest = 1;
  for (const TopologyNode& node : top.nodes) {
    deepest = std::max<unsigned>(deepest, node.level);
  }
  tree.topology_.nodes = top.nodes;
  for (Bvh& mesh : tree.meshes_) {
    mesh.join(tree.topology_, deepest + 1);
  }
  tree.instance_of_.resize(top.nodes.size());
  for (std::size_t n = 0; n < top.nodes.size() && !instances.empty(); ++n) {
    if (const TopologyNode& node = top.nodes[n]; node.leaf) {
      const std::uint32_t instance = top.entries[node.first];
      tree.instance_of_[n] = instance;
      tree.topology_.nodes[n] = {tree.meshes_[instances[instance].mesh].root(), 1, node.level, false};
    }
  }
  return tree;
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
