#include "tests/support/embree_bvh.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <new>
#include <vector>

#include "sim/error.h"

namespace marti::tests {

namespace {

float half_area(const RTCBounds& box) {
  const float x = box.upper_x - box.lower_x;
  const float y = box.upper_y - box.lower_y;
  const float z = box.upper_z - box.lower_z;
  return x * y + y * z + z * x;
}

// A node as Embree's builder makes it. A leaf has primitives, a branch children.
struct Node {
  std::array<const Node*, 8> child{};
  std::array<RTCBounds, 8> box{};
  unsigned children = 0;
  std::size_t primitives = 0;

  [[nodiscard]] double cost(float area) const {
    if (children == 0) {
      return static_cast<double>(area) * static_cast<double>(primitives);
    }
    double sum = static_cast<double>(area);
    for (unsigned c = 0; c < children; ++c) {
      sum += child[c]->cost(half_area(box[c]));
    }
    return sum;
  }
};

void* make_branch(RTCThreadLocalAllocator allocator, unsigned children, void* /*user*/) {
  Node* node = new (rtcThreadLocalAlloc(allocator, sizeof(Node), alignof(Node))) Node;
  node->children = children;
  return node;
}

void set_children(void* branch, void** children, unsigned count, void* /*user*/) {
  for (unsigned c = 0; c < count; ++c) {
    static_cast<Node*>(branch)->child[c] = static_cast<const Node*>(children[c]);
  }
}

void set_boxes(void* branch, const RTCBounds** boxes, unsigned count, void* /*user*/) {
  for (unsigned c = 0; c < count; ++c) {
    static_cast<Node*>(branch)->box[c] = *boxes[c];
  }
}

void* make_leaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* /*primitives*/, std::size_t count,
                void* /*user*/) {
  Node* node = new (rtcThreadLocalAlloc(allocator, sizeof(Node), alignof(Node))) Node;
  node->primitives = count;
  return node;
}

}  // namespace

double embree_sah_cost(const accel::TriangleSet& triangles, unsigned width, unsigned largest_leaf) {
  std::vector<RTCBuildPrimitive> primitives(triangles.triangles());
  constexpr float inf = std::numeric_limits<float>::infinity();
  RTCBounds root{inf, inf, inf, 0.0F, -inf, -inf, -inf, 0.0F};
  for (std::uint32_t id = 0; id < triangles.triangles(); ++id) {
    std::array<float, 3> lo{inf, inf, inf};
    std::array<float, 3> hi{-inf, -inf, -inf};
    for (std::size_t c = 0; c < 9; ++c) {
      lo[c % 3] = std::min(lo[c % 3], static_cast<float>(triangles[id][c]));
      hi[c % 3] = std::max(hi[c % 3], static_cast<float>(triangles[id][c]));
    }
    primitives[id] = {lo[0], lo[1], lo[2], 0, hi[0], hi[1], hi[2], id};
    root = {
        std::min(root.lower_x, lo[0]), std::min(root.lower_y, lo[1]), std::min(root.lower_z, lo[2]), 0.0F,
        std::max(root.upper_x, hi[0]), std::max(root.upper_y, hi[1]), std::max(root.upper_z, hi[2]), 0.0F};
  }
  const std::unique_ptr<RTCDeviceTy, void (*)(RTCDevice)> device(rtcNewDevice("threads=1"), rtcReleaseDevice);
  sim::ensure(device != nullptr, "Embree gives no device");
  const std::unique_ptr<RTCBVHTy, void (*)(RTCBVH)> bvh(rtcNewBVH(device.get()), rtcReleaseBVH);
  RTCBuildArguments arguments = rtcDefaultBuildArguments();
  arguments.buildQuality = RTC_BUILD_QUALITY_MEDIUM;
  arguments.maxBranchingFactor = width;
  arguments.maxDepth = 64;
  arguments.sahBlockSize = 1;
  arguments.minLeafSize = 1;
  arguments.maxLeafSize = largest_leaf;
  arguments.traversalCost = 1.0F;
  arguments.intersectionCost = 1.0F;
  arguments.bvh = bvh.get();
  arguments.primitives = primitives.data();
  arguments.primitiveCount = primitives.size();
  arguments.primitiveArrayCapacity = primitives.size();
  arguments.createNode = make_branch;
  arguments.setNodeChildren = set_children;
  arguments.setNodeBounds = set_boxes;
  arguments.createLeaf = make_leaf;
  const auto* tree = static_cast<const Node*>(rtcBuildBVH(&arguments));
  sim::ensure(tree != nullptr, "Embree built no hierarchy");
  return tree->cost(half_area(root)) / static_cast<double>(half_area(root));
}

}  // namespace marti::tests
