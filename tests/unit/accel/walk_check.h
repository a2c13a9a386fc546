// What the leaves and the walks of every structure are checked for.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "accel/box_overlap.h"
#include "accel/counted.h"
#include "accel/ray.h"
#include "accel/topology.h"
#include "accel/triangles.h"
#include "accel/visitor.h"
#include "scenes/scene.h"
#include "tests/contract/hostile.h"
#include "tests/support/long_tests.h"
#include "tests/support/same_bits.h"

namespace marti::tests {

inline std::shared_ptr<const accel::TriangleSet> set_of(std::vector<accel::TriangleCorners> triangles) {
  return std::make_shared<const accel::TriangleSet>(std::move(triangles));
}

/// Nodes are numbered level by level, leaves list their entries one after the other and in ascending order,
/// and the tree's own statistics count them.
template <class Tree>
void check_numbering(const Tree& tree, std::uint32_t children, std::uint32_t max_objects) {
  const accel::Topology& topology = tree.topology();
  std::uint32_t next_child = 1;
  std::uint32_t next_entry = 0;
  auto levels = tree.levels();
  for (auto& level : levels) {
    level = {};
  }
  for (const accel::TopologyNode& node : topology.nodes) {
    auto& level = levels.at(node.level - 1U);
    if (!node.leaf) {
      ++level.branches;
      ASSERT_EQ(node.first, next_child);
      ASSERT_EQ(node.count, children);
      for (std::uint32_t child = 0; child < children; ++child) {
        ASSERT_EQ(topology.nodes.at(node.first + child).level, node.level + 1);
      }
      next_child += children;
      continue;
    }
    ++level.leaves;
    level.empty_leaves += node.count == 0 ? 1U : 0U;
    level.entries += node.count;
    level.overfull_leaves += node.count > max_objects ? 1U : 0U;
    ASSERT_EQ(node.first, next_entry);
    next_entry += node.count;
    ASSERT_TRUE(std::is_sorted(topology.entries.begin() + node.first, topology.entries.begin() + next_entry,
                               std::less_equal<>()));
  }
  EXPECT_EQ(next_child, topology.nodes.size());
  EXPECT_EQ(next_entry, topology.entries.size());
  EXPECT_EQ(levels, tree.levels());
}

/// Writes down every visit.
struct Recorder {
  struct Visit {
    std::uint32_t node;
    std::uint32_t tests;
    std::uint32_t entries;
    bool leaf;
    std::vector<std::uint32_t> entered{};  // children of a branch of a bvh, by their numbers among these
    bool operator==(const Visit&) const = default;
  };
  std::vector<Visit> visits;
  void branch(std::uint32_t node) { visits.push_back({node, 0, 0, false}); }
  void transform(std::uint32_t node) { branch(node); }
  void leaf(std::uint32_t node, std::uint32_t tests, std::uint32_t entries) {
    visits.push_back({node, tests, entries, true});
  }
  void entered(accel::EnteredChildren children) {
    for (std::uint32_t place = 0; place < children.count(); ++place) {
      visits.back().entered.push_back(children[place]);
    }
  }
  void mailed_leaf(std::uint32_t node, std::uint32_t read, std::uint32_t entries,
                   const std::uint32_t* /*tested*/) {
    visits.push_back({node, read, entries, true});
  }
};

/// Where a ray is inside a box enlarged by `margin`, in long double; empty when in > out.
struct Inside {
  long double in;
  long double out;
};
inline Inside inside(const accel::Ray& ray, const scenes::Bounds& box, double margin) {
  Inside span{ray.t_min, ray.t_max};
  for (int a = 0; a < 3; ++a) {
    const long double lo = static_cast<long double>(box.lo[a]) - margin - ray.origin[a];
    const long double hi = static_cast<long double>(box.hi[a]) + margin - ray.origin[a];
    if (ray.direction[a] == 0.0) {
      if (lo > 0 || hi < 0) {
        return {1, 0};
      }
      continue;
    }
    const long double t0 = lo / ray.direction[a];
    const long double t1 = hi / ray.direction[a];
    span.in = std::max(span.in, std::min(t0, t1));
    span.out = std::min(span.out, std::max(t0, t1));
  }
  return span;
}

/// Every leaf lists every triangle that meets it, and none that stays more than 2 delta away from it.
template <class Structure>
void check_lists(const Structure& structure, const std::vector<scenes::Bounds>& boxes) {
  const accel::TriangleSet& triangles = structure.triangles();
  for (std::size_t n = 0; n < boxes.size(); ++n) {
    const accel::TopologyNode& node = structure.topology().nodes[n];
    if (!node.leaf) {
      continue;
    }
    const auto begin = structure.topology().entries.begin() + node.first;
    ASSERT_TRUE(std::is_sorted(begin, begin + node.count));
    const std::set<std::uint32_t> listed(begin, begin + node.count);
    ASSERT_EQ(listed.size(), node.count);
    const glm::dvec3 center = 0.5 * (boxes[n].lo + boxes[n].hi);
    const glm::dvec3 half = 0.5 * (boxes[n].hi - boxes[n].lo);
    for (std::uint32_t id = 0; id < triangles.size(); ++id) {
      if (listed.contains(id)) {
        ASSERT_TRUE(accel::overlaps(triangles[id], center, half + 2.0 * structure.delta()));
      } else {
        ASSERT_FALSE(accel::overlaps(triangles[id], center, half + 0.5 * structure.delta()));
      }
    }
  }
}

/// The parent of each node; 0 of the root.
inline std::vector<std::uint32_t> parents_of(const std::vector<accel::TopologyNode>& nodes) {
  std::vector<std::uint32_t> parent(nodes.size(), 0);
  for (std::uint32_t n = 0; n < nodes.size(); ++n) {
    for (std::uint32_t child = 0; !nodes[n].leaf && child < nodes[n].count; ++child) {
      parent[nodes[n].first + child] = n;
    }
  }
  return parent;
}

/// Calls use(node, inside) for each node whose box, larger by `margin` on all sides, the ray is in for a
/// while. A box holds those of the node's children, so what is below a box that the ray misses need not be
/// looked at.
template <class Use>
void each_crossed(const accel::Topology& topology, const std::vector<scenes::Bounds>& boxes,
                  const accel::Ray& ray, double margin, const Use& use) {
  std::vector<std::uint32_t> left = {0};
  while (!left.empty()) {
    const std::uint32_t number = left.back();
    left.pop_back();
    const Inside on = inside(ray, boxes[number], margin);
    if (!(on.in < on.out)) {
      continue;
    }
    use(number, on);
    const accel::TopologyNode& node = topology.nodes[number];
    for (std::uint32_t child = 0; !node.leaf && child < node.count; ++child) {
      left.push_back(node.first + child);
    }
  }
}

/// Front to back, at most `most_children` children of a branch, no leaf that the ray does not meet, none left
/// out. Returns how many leaves were visited.
template <class Structure>
std::uint64_t check_walks(const Structure& structure, const std::vector<scenes::Bounds>& boxes,
                          int most_children) {
  const std::vector<accel::TopologyNode>& nodes = structure.topology().nodes;
  const std::vector<std::uint32_t> parent = parents_of(nodes);
  RayMaker maker(structure.triangles(), structure.bounds(), 6);
  // Twice the largest error a parameter may have, as a distance.
  const double margin = 8.0 * structure.delta();
  std::uint64_t leaves = 0;
  const auto check = [&](const accel::Ray& ray) {
    Recorder recorder;
    const accel::Hit hit = structure.closest(ray, recorder);
    std::map<std::uint32_t, int> children;
    std::set<std::uint32_t> visited;
    long double last_in = -std::numeric_limits<long double>::infinity();
    const long double slack =
        margin / std::sqrt(static_cast<long double>(glm::dot(ray.direction, ray.direction)));
    for (const Recorder::Visit& visit : recorder.visits) {
      ASSERT_TRUE(visited.insert(visit.node).second) << "visited twice";
      ASSERT_EQ(visit.leaf, nodes[visit.node].leaf);
      if (visit.node != 0) {
        ASSERT_TRUE(visited.contains(parent[visit.node]));
        ASSERT_LE(++children[parent[visit.node]], most_children);
      }
      const Inside on = inside(ray, boxes[visit.node], margin);
      ASSERT_LE(on.in, on.out + 2 * slack) << "a node the ray does not meet";
      if (visit.leaf) {
        ++leaves;
        ASSERT_EQ(visit.tests, visit.entries);
        ASSERT_EQ(visit.entries, nodes[visit.node].count);
        const Inside exact = inside(ray, boxes[visit.node], -margin);
        if (exact.in < exact.out) {  // thick enough to have an order
          ASSERT_GE(exact.in, last_in) << "not front to back";
          last_in = exact.in;
        }
      }
    }
    each_crossed(structure.topology(), boxes, ray, -margin, [&](std::uint32_t n, const Inside& on) {
      if (nodes[n].leaf && (!hit.found() || on.in < hit.t)) {
        ASSERT_TRUE(visited.contains(n)) << "a leaf on the ray was left out";
      }
    });
  };
  for (int k = 0; k < test::cases(6000) && !::testing::Test::HasFatalFailure(); ++k) {
    check(maker.make(tests::all_aims[static_cast<std::size_t>(k) % 6]));
  }
  return leaves;
}

/// A scalar that counts takes the same steps and finds the same hits.
template <class Structure>
void check_counting(const Structure& structure) {
  RayMaker maker(structure.triangles(), structure.bounds(), 9);
  for (int k = 0; k < test::cases(60000); ++k) {
    const accel::Ray ray = maker.make(tests::all_aims[static_cast<std::size_t>(k) % tests::all_aims.size()]);
    Recorder plain;
    Recorder counted;
    const accel::Hit expected = structure.closest(ray, plain);
    ASSERT_TRUE(test::same_bits(expected, structure.template closest<accel::Counted>(ray, counted)));
    ASSERT_EQ(plain.visits, counted.visits);

    Recorder plain_shadow;
    Recorder counted_shadow;
    ASSERT_EQ(structure.occluded(ray, plain_shadow),
              structure.template occluded<accel::Counted>(ray, counted_shadow));
    ASSERT_EQ(plain_shadow.visits, counted_shadow.visits);
  }
}

}  // namespace marti::tests
