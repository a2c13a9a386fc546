#include "accel/bvh.h"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "accel/build_memory.h"
#include "accel/frame.h"
#include "accel/parallel.h"
#include "sim/avx2.h"

namespace marti::accel {

namespace {

// Nodes that a thread makes records of in one piece.
constexpr std::size_t nodes_of_a_piece = 4096;

// The nodes of the binary tree that become the children of one node: beginning with the two children of
// `node`, the one with the largest area that has children is replaced by these as long as there is room, on
// ties the first one (as in Wald, Benthin, Boulos, "Getting Rid of Packets", IEEE Symposium on Interactive
// Ray Tracing 2008, section 3). A binary node marked as a leaf may be divided too, because free places of a
// record cost nothing.
// Returns how many there are.
std::uint32_t merged_children(const BvhBinaryTree& binary, std::uint32_t node, std::uint32_t most,
                              std::array<std::uint32_t, 8>& children) {
  if (binary.nodes[node].count == 1) {  // the root of a tree of one primitive
    children[0] = node;
    return 1;
  }
  children[0] = binary.nodes[node].first;
  children[1] = children[0] + 1;
  std::uint32_t count = 2;
  while (count < most) {
    std::uint32_t largest = count;
    float area = -1.0F;
    for (std::uint32_t c = 0; c < count; ++c) {
      const BvhBinaryNode& child = binary.nodes[children[c]];
      if (child.count > 1 && child.box.half_area() > area) {
        largest = c;
        area = child.box.half_area();
      }
    }
    if (largest == count) {
      break;
    }
    const std::uint32_t first = binary.nodes[children[largest]].first;
    std::copy_backward(children.begin() + largest + 1, children.begin() + count,
                       children.begin() + count + 1);
    children[largest] = first;
    children[largest + 1] = first + 1;
    ++count;
  }
  return count;
}

// Adds to the numbers of nodes that records hold, or that are kept beside them, modulo 2^32.
template <class Records>
void shift_nodes(Records& records, std::vector<std::uint32_t>& beside, std::uint32_t by) {
  for (auto& record : records) {
    if constexpr (requires { record.first; }) {
      record.first += by;
    }
  }
  for (std::uint32_t& first : beside) {
    first += by;
  }
}

double half_area(const scenes::Bounds& box) {
  const glm::dvec3 extent = box.hi - box.lo;
  return extent.x * extent.y + extent.y * extent.z + extent.z * extent.x;
}

}  // namespace

Bvh Bvh::build(std::shared_ptr<const TriangleSet> triangles, const BvhOptions& options) {
  sim::ensure(triangles != nullptr, "a bvh needs a triangle set, even an empty one");
  const RootFrame frame = make_frame(*triangles);
  const std::uint32_t count = triangles->size();
  return build(std::move(triangles), {0, count}, frame, options);
}

Bvh Bvh::build(std::shared_ptr<const TriangleSet> triangles, PrimitiveRange range, const RootFrame& frame,
               const BvhOptions& options) {
  require_range(kind_name, "max_objects", options.max_objects, 1, bvh_largest_leaf(options.node));
  require_range(kind_name, "bins", options.bins, 2, bvh_most_bins);
  Bvh tree;
  tree.triangles_ = std::move(triangles);
  tree.options_ = options;
  tree.frame_ = frame;
  tree.topology_.nodes.push_back({});
  if (range.count == 0) {
    return tree;
  }
  tree.set_space();
  tree.number_nodes(build_binary_bvh(*tree.triangles_, range, tree.space_, options));
  tree.make_all_records();
  return tree;
}

void Bvh::set_space() {
  space_ = BvhSpace(frame_);
#ifdef MARTI_AVX2
  vectors_ = sim::has_avx2();
#endif
}

Bvh Bvh::refitted(std::shared_ptr<const TriangleSet> moved) const {
  if (moved->size() != triangles_->size() || moved->triangles() != triangles_->triangles()) {
    throw sim::UserError("a tree cannot be refitted to another number of primitives");
  }
  const RootFrame frame = make_frame(*moved);
  return refitted(std::move(moved), frame);
}

Bvh Bvh::refitted(std::shared_ptr<const TriangleSet> moved, const RootFrame& frame) const {
  Bvh tree;
  tree.triangles_ = std::move(moved);
  tree.options_ = options_;
  tree.topology_ = topology_;
  tree.frame_ = frame;
  if (topology_.nodes.front().leaf) {
    return tree;
  }
  tree.set_space();
  tree.fit_boxes();
  tree.make_all_records();
  return tree;
}

// Children have higher numbers than their parent.
void Bvh::fit_boxes() {
  boxes_.resize(topology_.nodes.size());
  for (std::size_t number = topology_.nodes.size(); number-- > 0;) {
    const TopologyNode& node = topology_.nodes[number];
    BvhBox box;
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      box.include(node.leaf ? bvh_box_of(space_, *triangles_, topology_.entries[i]) : boxes_[i]);
    }
    boxes_[number] = box;
  }
}

void Bvh::make_all_records() {
  order_records();
  with_records(*this, [this](auto& records) { make_records(records); });
  boxes_ = {};
  place_ = {};
}

// Puts the nodes behind those of `whole`, the root on `level`. Walks tell of them by their numbers there.
void Bvh::join(Topology& whole, unsigned level) {
  root_ = static_cast<std::uint32_t>(whole.nodes.size());
  const auto first_entry = static_cast<std::uint32_t>(whole.entries.size());
  const auto down = static_cast<std::uint8_t>(level - 1);
  for (const TopologyNode& node : topology_.nodes) {
    whole.nodes.push_back({node.first + (node.leaf ? first_entry : root_), node.count,
                           static_cast<std::uint8_t>(node.level + down), node.leaf});
  }
  whole.entries.insert(whole.entries.end(), topology_.entries.begin(), topology_.entries.end());
  topology_ = {};
  with_records(*this, [this](auto& records) { shift_nodes(records, first_, root_); });
}

// Undoes join(): the `nodes` nodes of `whole` from the root's on become the tree's own topology again.
void Bvh::leave(const Topology& whole, std::uint32_t nodes) {
  const auto begin = whole.nodes.begin() + root_;
  topology_.nodes.assign(begin, begin + nodes);
  const auto down = static_cast<std::uint8_t>(begin->level - 1);
  std::uint32_t first_entry = ~0U;
  std::uint32_t entries = 0;
  for (const TopologyNode& node : topology_.nodes) {
    first_entry = node.leaf ? std::min(first_entry, node.first) : first_entry;
    entries += node.leaf ? node.count : 0;
  }
  for (TopologyNode& node : topology_.nodes) {
    node.first -= node.leaf ? first_entry : root_;
    node.level = static_cast<std::uint8_t>(node.level - down);
  }
  const auto from = whole.entries.begin() + first_entry;
  topology_.entries.assign(from, from + entries);
  with_records(*this, [this](auto& records) { shift_nodes(records, first_, 0U - root_); });
  root_ = 0;
}

void Bvh::number_nodes(const BvhBinaryTree& binary) {
  work_ = binary.work;
  std::vector<std::uint32_t> of_binary = {0};
  boxes_.push_back(binary.nodes[0].box);
  std::array<std::uint32_t, 8> children{};
  for (std::size_t number = 0; number < topology_.nodes.size(); ++number) {
    if (number % nodes_between_checks == 0) {
      require_tree(options_.memory,
                   bytes_of_vector(binary.nodes) + growing_bytes(topology_.nodes, 8 * nodes_between_checks) +
                       growing_bytes(boxes_, 8 * nodes_between_checks) +
                       growing_bytes(of_binary, 8 * nodes_between_checks) +
                       growing_bytes(topology_.entries, binary.entries.size() - topology_.entries.size()) +
                       bytes_of_vector(binary.entries),
                   kind_name, "take a smaller scene");
    }
    const std::uint32_t node = of_binary[number];
    const BvhBinaryNode& from = binary.nodes[node];
    const std::uint8_t level = topology_.nodes[number].level;
    if (number != 0 && from.leaf) {
      const auto first = static_cast<std::ptrdiff_t>(topology_.entries.size());
      topology_.nodes[number] = {static_cast<std::uint32_t>(first), from.count, level, true};
      topology_.entries.insert(topology_.entries.end(), binary.entries.begin() + from.begin,
                               binary.entries.begin() + from.begin + from.count);
      std::sort(topology_.entries.begin() + first, topology_.entries.end());
      continue;
    }
    const std::uint32_t count = merged_children(binary, node, bvh_children(options_.node), children);
    topology_.nodes[number] = {static_cast<std::uint32_t>(topology_.nodes.size()), count, level, false};
    for (std::uint32_t c = 0; c < count; ++c) {
      topology_.nodes.push_back({0, 0, static_cast<std::uint8_t>(level + 1), true});
      of_binary.push_back(children[c]);
      boxes_.push_back(binary.nodes[children[c]].box);
    }
  }
}

// Records of siblings follow one another, and then those below them, child by child; so do the primitives of
// leaves.
void Bvh::order_records() {
  place_.resize(topology_.nodes.size());
  std::vector<std::uint32_t> pending = {0};
  std::uint32_t records = 1;  // the root is record 0
  std::uint32_t primitives = 0;
  while (!pending.empty()) {
    const TopologyNode node = topology_.nodes[pending.back()];
    pending.pop_back();
    for (std::uint32_t number = node.first; number < node.first + node.count; ++number) {
      const TopologyNode& child = topology_.nodes[number];
      place_[number] = child.leaf ? primitives : records;
      (child.leaf ? primitives : records) += child.leaf ? child.count : 1;
    }
    for (std::uint32_t number = node.first + node.count; number-- > node.first;) {
      if (!topology_.nodes[number].leaf) {
        pending.push_back(number);
      }
    }
  }
  branches_ = records;
  require_tree(options_.memory,
               bytes_of(topology_) + bytes_of_vector(boxes_) + bytes_of_vector(place_) +
                   primitives * sizeof(BvhPrimitive) +
                   std::uint64_t{records} * (bvh_record_bytes(options_.node) + sizeof(std::uint32_t)),
               kind_name, "take a smaller scene");
  primitives_.resize(primitives);
}

template <class Node>
void Bvh::make_records(sim::LargeVector<Node>& records) {
  records.resize(branches_);
  if constexpr (!requires { Node::first; }) {
    first_.resize(branches_);
  }
  const std::size_t count = topology_.nodes.size();
  parallel_pieces(count, nodes_of_a_piece, options_.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const TopologyNode& node = topology_.nodes[n];
      if (node.leaf) {
        for (std::uint32_t k = 0; k < node.count; ++k) {
          const std::uint32_t id = topology_.entries[node.first + k];
          primitives_[place_[n] + k] = {id < triangles_->triangles() ? (*triangles_)[id] : TriangleCorners{},
                                        id};
        }
        continue;
      }
      std::array<BvhChild, 8> children{};
      for (std::uint32_t c = 0; c < node.count; ++c) {
        const TopologyNode& child = topology_.nodes[node.first + c];
        children[c] = {place_[node.first + c], child.leaf ? child.count : 0};
      }
      records[place_[n]] = Node::make(node.first, std::span(boxes_).subspan(node.first, node.count),
                                      std::span(children).first(node.count));
      if constexpr (!requires { Node::first; }) {
        first_[place_[n]] = node.first;
      }
    }
  });
}

std::uint64_t Bvh::walk_bytes() const {
  return two_.size() * sizeof(BvhNode<2>) + four_.size() * sizeof(BvhNode<4>) +
         six_.size() * sizeof(BvhSixNode) + eight_.size() * sizeof(BvhNode<8>) +
         quantised_.size() * sizeof(BvhQuantisedNode) + bytes_of_vector(first_) +
         bytes_of_vector(primitives_);
}

double Bvh::sah_cost() const {
  if (triangles_->size() == 0) {
    return 0.0;
  }
  return with_view([&](const auto& view) {
    scenes::Bounds root;
    double sum = 0.0;
    for (std::size_t record = 0; record < branches_; ++record) {
      for (std::size_t c = 0; c < view.nodes[record].children(); ++c) {
        const scenes::Bounds box = view.nodes[record].box(c);
        const std::uint32_t entries = view.nodes[record].child(c).entries;
        sum += half_area(box) * (entries == 0 ? 1.0 : static_cast<double>(entries));
        if (record == 0) {
          root.include(box.lo);
          root.include(box.hi);
        }
      }
    }
    return half_area(root) > 0.0 ? 1.0 + sum / half_area(root) : 0.0;
  });
}

}  // namespace marti::accel
