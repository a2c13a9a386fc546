#include "accel/bvh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "accel/bvh_order.h"
#include "accel/record_order.h"
#include "scenes/procedural.h"
#include "sim/error.h"
#include "tests/contract/hostile.h"
#include "tests/contract/hostile_quadrics.h"
#include "tests/unit/accel/walk_check.h"

namespace marti::tests {
namespace {

using accel::Bvh;
using accel::BvhNodeKind;
using accel::BvhOptions;
using accel::TopologyNode;

class BvhOfEachNode : public ::testing::TestWithParam<BvhNodeKind> {
 protected:
  [[nodiscard]] static Bvh build(std::shared_ptr<const accel::TriangleSet> triangles,
                                 std::uint32_t max_objects = 3, unsigned threads = 1) {
    return Bvh::build(std::move(triangles),
                      {.node = GetParam(), .max_objects = max_objects, .threads = threads});
  }
};

std::string name_of(const ::testing::TestParamInfo<BvhNodeKind>& tested) {
  return "children_" + std::string(accel::bvh_node_names[static_cast<std::size_t>(tested.param)]);
}
INSTANTIATE_TEST_SUITE_P(Bvh, BvhOfEachNode,
                         ::testing::Values(BvhNodeKind::two, BvhNodeKind::four, BvhNodeKind::six,
                                           BvhNodeKind::eight, BvhNodeKind::eight_quantised),
                         name_of);

bool in_bytes(BvhNodeKind kind) { return kind == BvhNodeKind::six || kind == BvhNodeKind::eight_quantised; }

std::shared_ptr<const accel::TriangleSet> mixed_set() {
  return std::make_shared<const accel::TriangleSet>(tests::hostile_soup(0.0, 1), hostile_quadrics(0.0, 1));
}

/// Numbering, sizes of nodes and leaves, and each primitive in exactly one leaf.
void check_tree(const Bvh& bvh) {
  const accel::Topology& topology = bvh.topology();
  const std::uint32_t most = accel::bvh_children(bvh.options().node);
  std::uint32_t next_child = 1;
  std::uint32_t next_entry = 0;
  ASSERT_FALSE(topology.nodes[0].leaf);
  for (const TopologyNode& node : topology.nodes) {
    ASSERT_LE(node.level, 61);
    if (!node.leaf) {
      ASSERT_EQ(node.first, next_child);
      ASSERT_GE(node.count, bvh.triangles().size() == 1 ? 1U : 2U);
      ASSERT_LE(node.count, most);
      for (std::uint32_t child = node.first; child < node.first + node.count; ++child) {
        ASSERT_EQ(topology.nodes.at(child).level, node.level + 1);
      }
      next_child += node.count;
      continue;
    }
    ASSERT_EQ(node.first, next_entry);
    ASSERT_GE(node.count, 1U);
    ASSERT_LE(node.count, bvh.options().max_objects);
    next_entry += node.count;
    ASSERT_TRUE(std::is_sorted(topology.entries.begin() + node.first, topology.entries.begin() + next_entry));
  }
  ASSERT_EQ(next_child, topology.nodes.size());
  std::vector<std::uint32_t> all = topology.entries;
  std::sort(all.begin(), all.end());
  ASSERT_EQ(all.size(), bvh.triangles().size());
  for (std::uint32_t id = 0; id < all.size(); ++id) {
    ASSERT_EQ(all[id], id);
  }
}

TEST_P(BvhOfEachNode, EachPrimitiveIsInOneLeafAndNodesAreBreadthFirst) {
  check_tree(build(mixed_set()));
  check_tree(build(mixed_set(), 1));
  check_tree(build(set_of(tests::hostile_soup(1e6, 4, true))));
  check_tree(build(set_of({tests::corners({0, 0, 0}, {1, 0, 0}, {0, 1, 0})})));
}

// Triangles each half as large and half as far as the one before: every split cuts off one of them, unless
// the depth is bounded.
TEST_P(BvhOfEachNode, AHostileSceneIsNoDeeperThanLogsCanSay) {
  std::vector<accel::TriangleCorners> all;
  for (int k = 0; k < 120; ++k) {
    const double s = std::ldexp(1.0, -k);
    all.push_back(tests::corners({s, 0, 0}, {1.1 * s, 0, 0}, {s, 0.1 * s, 0.1 * s}));
  }
  check_tree(build(set_of(all), 1));
  all.assign(500, tests::corners({0, 0, 0}, {1, 0, 0}, {0, 1, 0}));
  check_tree(build(set_of(all), 1));
}

// With more than 65,536 primitives the largest nodes are split by all threads together.
TEST_P(BvhOfEachNode, TheTreeIsTheSameWithAnyNumberOfThreads) {
  const auto triangles = std::make_shared<const accel::TriangleSet>(scenes::make_procedural("teapot:34"));
  ASSERT_GT(triangles->size(), 70000U);
  const Bvh one = build(triangles, 3, 1);
  for (const unsigned threads : {2U, 5U}) {
    const Bvh other = build(triangles, 3, threads);
    EXPECT_EQ(one.topology(), other.topology());
    EXPECT_EQ(one.sah_cost(), other.sah_cost());
  }
}

// The counting walk is written without vectors, so this compares the two.
TEST_P(BvhOfEachNode, CountingChangesNothing) {
  check_counting(build(mixed_set()));
  check_counting(build(set_of(tests::hostile_soup(1e3, 8, true)), 1));
}

/// The tight box of what a node lists, from the primitives alone.
std::vector<scenes::Bounds> tight_boxes(const Bvh& bvh) {
  const accel::Topology& topology = bvh.topology();
  std::vector<scenes::Bounds> boxes(topology.nodes.size());
  for (std::size_t n = topology.nodes.size(); n-- > 0;) {
    const TopologyNode& node = topology.nodes[n];
    for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
      if (node.leaf) {
        for (unsigned corner = 0; corner < 3; ++corner) {
          boxes[n].include(bvh.triangles().corner(topology.entries[k], corner));
        }
      } else {
        boxes[n].include(boxes[k].lo);
        boxes[n].include(boxes[k].hi);
      }
    }
  }
  return boxes;
}

double area(const scenes::Bounds& box) {
  const glm::dvec3 e = box.hi - box.lo;
  return e.x * e.y + e.y * e.z + e.z * e.x;
}

// Against tight boxes made from the topology. Floats widen them by some 2^-23 of the scene; bytes by up to a
// 255th of a node on each side.
TEST_P(BvhOfEachNode, TheCostIsThatOfTheBoxes) {
  const Bvh bvh = build(std::make_shared<const accel::TriangleSet>(scenes::make_procedural("teapot:8:pot")));
  const std::vector<scenes::Bounds> boxes = tight_boxes(bvh);
  double cost = 0.0;
  for (std::size_t n = 0; n < boxes.size(); ++n) {
    const TopologyNode& node = bvh.topology().nodes[n];
    cost += area(boxes[n]) / area(boxes[0]) * (node.leaf ? node.count : 1);
  }
  EXPECT_GE(bvh.sah_cost(), cost * (1.0 - 1e-9));
  EXPECT_LE(bvh.sah_cost(), cost * (in_bytes(GetParam()) ? 1.06 : 1.0 + 1e-5));
}

TEST_P(BvhOfEachNode, RefittingKeepsTheNodesAndFitsTheBoxes) {
  const auto before = std::make_shared<const accel::TriangleSet>(scenes::make_procedural("teapot:8:pot"));
  const Bvh built = build(before);
  const Bvh at_rest = built.refitted(before);
  EXPECT_TRUE(at_rest.topology() == built.topology());
  EXPECT_EQ(at_rest.sah_cost(), built.sah_cost());
  EXPECT_EQ(at_rest.walk_bytes(), built.walk_bytes());
  scenes::Scene scene = scenes::make_procedural("teapot:8:pot");
  for (glm::dvec3& position : scene.positions) {
    const double angle = 2.0 * position.z;  // twisted
    position = {std::cos(angle) * position.x - std::sin(angle) * position.y,
                std::sin(angle) * position.x + std::cos(angle) * position.y, position.z};
  }
  const auto after = std::make_shared<const accel::TriangleSet>(scene);
  const Bvh twisted = built.refitted(after);
  const std::vector<scenes::Bounds> boxes = tight_boxes(twisted);
  double cost = 0.0;
  for (std::size_t n = 0; n < boxes.size(); ++n) {
    const TopologyNode& node = twisted.topology().nodes[n];
    cost += area(boxes[n]) / area(boxes[0]) * (node.leaf ? node.count : 1);
  }
  EXPECT_NEAR(twisted.sah_cost(), cost, cost * (in_bytes(GetParam()) ? 0.06 : 1e-5));
  EXPECT_GT(twisted.sah_cost(), build(after).sah_cost());
  EXPECT_THROW(static_cast<void>(built.refitted(mixed_set())), sim::UserError);
}

// A node is left out only if the ray misses its box, or the hit is nearer: what is visited is exactly what a
// naive walk over tight boxes would visit, up to boxes that are missed or entered behind the hit by a hair.
TEST_P(BvhOfEachNode, VisitsWhatTheRayMeetsInOrderOfEntry) {
  const Bvh bvh = build(std::make_shared<const accel::TriangleSet>(scenes::make_procedural("teapot:4:pot")));
  const std::vector<scenes::Bounds> boxes = tight_boxes(bvh);
  const double size = glm::length(boxes[0].hi - boxes[0].lo);
  // A quantised box may reach a 255th of its parent farther.
  const bool wide = in_bytes(GetParam());
  const std::vector<std::uint32_t> parent = parents_of(bvh.topology().nodes);
  RayMaker maker(bvh.triangles(), bvh.bounds(), 6);
  std::uint64_t leaves = 0;
  for (int k = 0; k < 3000; ++k) {
    accel::Ray ray = maker.make(tests::all_aims[static_cast<std::size_t>(k) % 6]);
    ray.direction /= glm::length(ray.direction);
    Recorder recorder;
    const accel::Hit hit = bvh.closest(ray, recorder);
    std::map<std::uint32_t, bool> visited;
    for (const Recorder::Visit& visit : recorder.visits) {
      ASSERT_TRUE(visited.emplace(visit.node, true).second) << "visited twice";
      ASSERT_TRUE(visit.node == 0 || visited.contains(parent[visit.node]));
      ASSERT_EQ(visit.leaf, bvh.topology().nodes[visit.node].leaf);
      const glm::dvec3 extent = boxes[parent[visit.node]].hi - boxes[parent[visit.node]].lo;
      const double margin = 1e-4 * size + (wide ? std::max({extent.x, extent.y, extent.z}) / 127.0 : 0.0);
      const Inside on = inside(ray, boxes[visit.node], margin);
      ASSERT_LE(on.in, on.out) << "a node the ray does not meet";
      leaves += visit.leaf ? 1 : 0;
    }
    each_crossed(bvh.topology(), boxes, ray, 0.0, [&](std::uint32_t n, const Inside& on) {
      if (n != 0 && (!hit.found() || on.in < hit.t - 1e-4 * size)) {
        ASSERT_TRUE(visited.contains(n)) << "a node on the ray was left out";
      }
    });
  }
  EXPECT_GT(leaves, 2000U);
}

// With the hit as far as nothing, entered children are all that are visited. With hits, children that were
// entered wait on a stack, in the order told, for a visit or until a hit is nearer.
TEST_P(BvhOfEachNode, EnteredChildrenAreVisitedOrBehindTheHit) {
  const Bvh bvh = build(std::make_shared<const accel::TriangleSet>(scenes::make_procedural("teapot:4:pot")));
  const std::vector<TopologyNode>& nodes = bvh.topology().nodes;
  RayMaker maker(bvh.triangles(), bvh.bounds(), 7);
  std::uint64_t dropped = 0;
  for (int k = 0; k < 3000; ++k) {
    const accel::Ray ray = maker.make(tests::all_aims[static_cast<std::size_t>(k) % 6]);
    for (const bool shadow : {false, true}) {
      Recorder recorder;
      const bool found = shadow ? bvh.occluded(ray, recorder) : bvh.closest(ray, recorder).found();
      std::vector<std::uint32_t> waiting = {0};
      bool hit_possible = false;  // a leaf was visited: without one nothing is dropped
      for (const Recorder::Visit& visit : recorder.visits) {
        for (; !waiting.empty() && waiting.back() != visit.node; waiting.pop_back()) {
          ASSERT_TRUE(found && hit_possible) << "dropped without a hit";
          ++dropped;
        }
        ASSERT_FALSE(waiting.empty()) << "visited without being entered";
        waiting.pop_back();
        hit_possible = hit_possible || visit.leaf;
        ASSERT_TRUE(!visit.leaf || visit.entered.empty());
        for (std::size_t place = visit.entered.size(); place-- > 0;) {
          ASSERT_LT(visit.entered[place], nodes[visit.node].count);
          waiting.push_back(nodes[visit.node].first + visit.entered[place]);
        }
      }
      ASSERT_TRUE(found || waiting.empty() || recorder.visits.empty());
    }
  }
  EXPECT_GT(dropped, 100U);
}

/// The entry that a ray takes next; `entries` in the order in which they were entered, the children of a
/// branch with the nearest first for breadth_first, else last.
std::size_t next_entry(const std::vector<std::uint32_t>& entries, accel::WalkOrder order,
                       const std::vector<std::uint32_t>& treelet, std::uint32_t visited) {
  if (order == accel::WalkOrder::breadth_first) {
    return 0;
  }
  for (std::size_t i = entries.size(); order == accel::WalkOrder::treelet_first && i-- > 0;) {
    if (treelet[entries[i]] == treelet[visited]) {
      return i;
    }
  }
  return entries.size() - 1;
}

// In every order the hits are those of the usual walk, bit for bit, and each visit is to the entry that is
// next, but for those that the hit is nearer than.
TEST_P(BvhOfEachNode, OrdersGiveTheSameHits) {
  for (const bool hostile : {false, true}) {
    const Bvh bvh = build(hostile ? set_of(tests::hostile_soup(1e3, 8, true)) : mixed_set(), 1);
    for (const accel::WalkOrder order :
         {accel::WalkOrder::depth_first, accel::WalkOrder::breadth_first, accel::WalkOrder::treelet_first}) {
      const std::vector<std::uint32_t> treelet = accel::treelets_of(bvh.topology(), false, 3).of_node;
      const accel::OrderedBvh ordered(bvh, order, 3);
      RayMaker maker(bvh.triangles(), bvh.bounds(), 8);
      for (int k = 0; k < 4000; ++k) {
        const accel::Ray ray =
            maker.make(tests::all_aims[static_cast<std::size_t>(k) % tests::all_aims.size()]);
        Recorder usual;
        Recorder recorder;
        Recorder shadow;
        const accel::Hit hit = bvh.closest(ray, usual);
        ASSERT_TRUE(test::same_bits(hit, ordered.closest(ray, recorder)));
        if (k % static_cast<int>(tests::all_aims.size()) < 6) {  // others do not all fit floats
          ASSERT_TRUE(test::same_bits(bvh.closest<float>(ray, shadow), ordered.closest<float>(ray, shadow)));
        }
        ASSERT_EQ(bvh.occluded(ray, shadow), ordered.occluded(ray, shadow));
        if (order == accel::WalkOrder::depth_first) {
          ASSERT_EQ(usual.visits, recorder.visits);
        }
        std::vector<std::uint32_t> entries = {0};
        std::uint32_t visited = 0;
        for (const Recorder::Visit& visit : recorder.visits) {
          for (;;) {
            ASSERT_FALSE(entries.empty());
            const std::size_t next = next_entry(entries, order, treelet, visited);
            const std::uint32_t taken = entries[next];
            entries.erase(entries.begin() + static_cast<std::ptrdiff_t>(next));
            if (taken == visit.node) {
              break;
            }
            ASSERT_TRUE(hit.found()) << "dropped without a hit";
          }
          visited = visit.node;
          std::vector<std::uint32_t> entered = visit.entered;
          if (order != accel::WalkOrder::breadth_first) {
            std::reverse(entered.begin(), entered.end());
          }
          for (const std::uint32_t child : entered) {
            entries.push_back(bvh.topology().nodes[visited].first + child);
          }
        }
        ASSERT_TRUE(hit.found() || entries.empty() || recorder.visits.empty());
      }
    }
  }
}

// The records' layout is documented, so a machine's addresses rest on these sizes.
TEST(BvhNodes, RecordsHaveTheDocumentedSizes) {
  EXPECT_EQ(sizeof(accel::BvhNode<2>), accel::bvh_record_bytes(BvhNodeKind::two));
  EXPECT_EQ(sizeof(accel::BvhNode<4>), accel::bvh_record_bytes(BvhNodeKind::four));
  EXPECT_EQ(sizeof(accel::BvhSixNode), accel::bvh_record_bytes(BvhNodeKind::six));
  EXPECT_EQ(sizeof(accel::BvhNode<8>), accel::bvh_record_bytes(BvhNodeKind::eight));
  EXPECT_EQ(sizeof(accel::BvhQuantisedNode), accel::bvh_record_bytes(BvhNodeKind::eight_quantised));
}

// Boxes of all sizes and places: each quantised box holds the box itself, and is wider by at most a step.
template <class Node>
void check_boxes_in_bytes(std::uint32_t largest_leaf) {
  Random random(3);
  for (int k = 0; k < 4000; ++k) {
    const double spread = std::pow(2.0, random.between(-20.0, 0.0));
    std::vector<accel::BvhBox> boxes(1 + random.below(Node::width));
    std::vector<accel::BvhChild> children(boxes.size());
    std::uint32_t branches = 7;
    std::uint32_t primitives = 100;
    const glm::dvec3 at = random.in_box(glm::dvec3(-0.9), glm::dvec3(0.9));
    for (std::size_t c = 0; c < boxes.size(); ++c) {
      for (std::size_t a = 0; a < 3; ++a) {
        const auto axis = static_cast<glm::length_t>(a);
        const auto lo = static_cast<float>(at[axis] + spread * random.between(-0.1, 0.1));
        boxes[c].lo[a] = lo;
        boxes[c].hi[a] = random.below(4) == 0 ? lo : lo + static_cast<float>(spread * random.unit() * 0.1);
      }
      const std::uint32_t entries = random.below(largest_leaf + 1);
      children[c] = {entries == 0 ? branches++ : primitives, entries};
      primitives += entries;
    }
    const Node node = Node::make(0, boxes, children);
    ASSERT_EQ(node.children(), boxes.size());
    for (std::size_t c = 0; c < boxes.size(); ++c) {
      ASSERT_EQ(node.child(c).record, children[c].record);
      ASSERT_EQ(node.child(c).entries, children[c].entries);
      const scenes::Bounds box = node.box(c);
      for (std::size_t a = 0; a < 3; ++a) {
        const auto axis = static_cast<glm::length_t>(a);
        const double step = node.step(a);
        ASSERT_LE(box.lo[axis], boxes[c].lo[a]);
        ASSERT_GE(box.hi[axis], boxes[c].hi[a]);
        ASSERT_GE(box.lo[axis], boxes[c].lo[a] - 1.001 * step);
        ASSERT_LE(box.hi[axis], boxes[c].hi[a] + 1.001 * step);
      }
    }
  }
}

TEST(BvhNodes, BoxesInBytesHoldTheirBoxes) {
  check_boxes_in_bytes<accel::BvhSixNode>(accel::bvh_largest_leaf(BvhNodeKind::six));
  check_boxes_in_bytes<accel::BvhQuantisedNode>(accel::bvh_largest_leaf(BvhNodeKind::eight_quantised));
}

TEST(Bvh, RefusesOptionsOutOfRange) {
  const auto set = set_of(tests::hostile_soup(0.0, 1));
  for (const BvhOptions& options :
       {BvhOptions{.max_objects = 0}, BvhOptions{.max_objects = 65}, BvhOptions{.bins = 1},
        BvhOptions{.bins = 65}, BvhOptions{.node = BvhNodeKind::six, .max_objects = 16},
        BvhOptions{.node = BvhNodeKind::eight_quantised, .max_objects = 4}}) {
    EXPECT_THROW((void)Bvh::build(set, options), sim::UserError);
  }
  EXPECT_THROW((void)Bvh::build(set, {.memory = sim::MemoryBudget(1000)}), sim::UserError);
}

}  // namespace
}  // namespace marti::tests
