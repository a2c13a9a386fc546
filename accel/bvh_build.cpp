#include "accel/bvh_build.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <memory>
#include <utility>

#include "accel/build_memory.h"
#include "accel/bvh_bins.h"
#include "accel/parallel.h"

namespace marti::accel {

namespace {

// A primitive while the tree is built.
struct Reference {
  BvhBox box;
  std::uint32_t id = 0;
};

// Levels of the tree at most: work logs and their readers count levels so far.
constexpr std::uint32_t most_binary_levels = 61;
// A node with more primitives is split by all threads together.
constexpr std::uint32_t large_node = 1U << 16;
constexpr std::size_t references_at_once = 1U << 14;
constexpr std::size_t nodes_in_a_piece = 64;

using Binning = BvhBinning<float>;
using Bins = BvhBins<float>;

struct Split {
  bool leaf = false;       ///< see BvhBinaryNode
  std::uint32_t left = 0;  ///< number of primitives of the first child
  std::array<BvhBox, 2> boxes{};
  bool binned = false;
  std::uint32_t planes = 0;
  std::uint32_t moved = 0;
};

// Brings the references for which `first_child` holds before the others, and sets how many they are. Returns
// how many were exchanged.
template <class FirstChild>
std::uint32_t part(Reference* begin, Reference* end, const FirstChild& first_child, std::uint32_t& firsts) {
  const Reference* const all = begin;
  std::uint32_t moved = 0;
  for (;; ++begin, --end, moved += 2) {
    begin = std::find_if_not(begin, end, first_child);
    while (begin != end && !first_child(end[-1])) {
      --end;
    }
    if (begin == end) {
      firsts = static_cast<std::uint32_t>(begin - all);
      return moved;
    }
    std::swap(*begin, end[-1]);
  }
}

class BinaryBuilder {
 public:
  BinaryBuilder(const TriangleSet& triangles, PrimitiveRange range, const BvhSpace& space,
                const BvhOptions& options, BvhBinaryTree& tree)
      : triangles_(triangles), range_(range), space_(space), options_(options), tree_(tree) {}

  void run() {
    const std::uint32_t count = range_.count;
    require_tree(options_.memory,
                 std::uint64_t{count} *
                     (sizeof(Reference) + 2 * sizeof(BvhBinaryNode) + sizeof(Split) + sizeof(std::uint32_t)),
                 "bvh", "take a smaller scene");
    tree_.nodes.reserve(2 * std::size_t{count} - 1);
    references_.resize(count);
    parallel_pieces(count, references_at_once, options_.threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const std::uint32_t id = range_.first + static_cast<std::uint32_t>(i);
        references_[i] = {bvh_box_of(space_, triangles_, id), id};
      }
    });
    BvhBinaryNode root;
    root.count = count;
    for (const Reference& reference : references_) {
      root.box.include(reference.box);
    }
    tree_.nodes.push_back(root);
    std::size_t begin = 0;
    for (std::uint32_t level = 1; begin < tree_.nodes.size(); ++level) {
      begin = split_level(begin, level);
    }
    tree_.entries.resize(count);
    std::transform(references_.begin(), references_.end(), tree_.entries.begin(),
                   [](const Reference& reference) { return reference.id; });
  }

 private:
  // Splits the nodes from `begin` on, which are those of `level`; returns where the next level begins.
  std::size_t split_level(std::size_t begin, std::uint32_t level) {
    const std::size_t end = tree_.nodes.size();
    std::vector<Split> splits(end - begin);
    for (std::size_t n = begin; n < end; ++n) {
      if (tree_.nodes[n].count > large_node) {
        options_.memory.end_if_stopped();
        splits[n - begin] = split(tree_.nodes[n], level, options_.threads, bins_);
      }
    }
    parallel_pieces(end - begin, nodes_in_a_piece, options_.threads, [&](std::size_t from, std::size_t to) {
      options_.memory.end_if_stopped();
      const auto bins = std::make_unique<Bins>();
      for (std::size_t n = from; n < to; ++n) {
        if (tree_.nodes[begin + n].count <= large_node) {
          splits[n] = split(tree_.nodes[begin + n], level, 1, *bins);
        }
      }
    });
    for (std::size_t n = begin; n < end; ++n) {
      const Split& split = splits[n - begin];
      BvhBinaryNode& node = tree_.nodes[n];
      const std::uint32_t from = node.begin;
      const std::uint32_t count = node.count;
      node.leaf = count <= 1 || split.leaf;
      if (split.binned && !node.below_leaf) {
        tree_.work.of_size(count) += {1, count, split.planes, node.leaf ? 0 : split.moved};
        tree_.work.levels = level;
      }
      if (count > 1) {
        const bool below = node.leaf || node.below_leaf;
        node.first = static_cast<std::uint32_t>(tree_.nodes.size());
        tree_.nodes.push_back(
            {.box = split.boxes[0], .begin = from, .count = split.left, .below_leaf = below});
        tree_.nodes.push_back({.box = split.boxes[1],
                               .begin = from + split.left,
                               .count = count - split.left,
                               .below_leaf = below});
      }
    }
    return end;
  }

  // Decides on a node, and sorts its part of the references by child.
  Split split(const BvhBinaryNode& node, std::uint32_t level, unsigned threads, Bins& bins) {
    Split split;
    if (node.count <= 1) {
      return split;
    }
    Reference* const first = references_.data() + node.begin;
    const Binning binning(centroids_of(first, node.count, threads), options_.bins, node.count);
    const bool deep =
        level + static_cast<std::uint32_t>(std::bit_width(node.count - 1)) >= most_binary_levels;
    BvhPlane<float> plane;
    if (!deep) {
      sort_into_bins(first, node.count, binning, bins, threads);
      plane = bins.best_plane(binning);
      split.binned = true;
      split.planes = binning.planes();
    }
    if (node.count <= options_.max_objects) {
      const float area = node.box.half_area();
      split.leaf = !(plane.cost + area < area * static_cast<float>(node.count));
    }
    if (plane.cost < BvhBox::inf) {
      const auto is_first = [&](const Reference& reference) {
        return binning.bin(reference.box.centroid(), plane.axis) <= plane.bin;
      };
      split.moved = part(first, first + node.count, is_first, split.left);
      for (std::uint32_t bin = 0; bin < binning.bins; ++bin) {
        split.boxes[bin <= plane.bin ? 0 : 1].include(bins.of_axis[plane.axis][bin].box);
      }
      return split;
    }
    split.left = node.count / 2;
    for (std::uint32_t k = 0; k < node.count; ++k) {
      split.boxes[k < split.left ? 0 : 1].include(first[k].box);
    }
    return split;
  }

  [[nodiscard]] BvhBox centroids_of(const Reference* first, std::uint32_t count, unsigned threads) const {
    std::vector<BvhBox> pieces((count + references_at_once - 1) / references_at_once);
    parallel_pieces(count, references_at_once, threads, [&](std::size_t begin, std::size_t end) {
      BvhBox& box = pieces[begin / references_at_once];
      for (std::size_t k = begin; k < end; ++k) {
        box.include(first[k].box.centroid());
      }
    });
    for (const BvhBox& piece : pieces) {
      pieces[0].include(piece);
    }
    return pieces[0];
  }

  static void sort_into_bins(const Reference* first, std::uint32_t count, const Binning& binning, Bins& bins,
                             unsigned threads) {
    bins.clear(binning.bins);
    std::vector<Bins> pieces(threads == 1 ? 0 : (count + references_at_once - 1) / references_at_once);
    parallel_pieces(count, references_at_once, threads, [&](std::size_t begin, std::size_t end) {
      Bins& into = pieces.empty() ? bins : pieces[begin / references_at_once];
      for (std::size_t k = begin; k < end; ++k) {
        into.add(first[k].box, binning);
      }
    });
    for (const Bins& piece : pieces) {
      bins.merge(piece, binning.bins);
    }
  }

  const TriangleSet& triangles_;
  PrimitiveRange range_;
  const BvhSpace& space_;
  const BvhOptions& options_;
  BvhBinaryTree& tree_;
  std::vector<Reference> references_;
  Bins bins_;  // of large nodes
};

}  // namespace

BvhBinaryTree build_binary_bvh(const TriangleSet& triangles, PrimitiveRange range, const BvhSpace& space,
                               const BvhOptions& options) {
  BvhBinaryTree tree;
  BinaryBuilder(triangles, range, space, options, tree).run();
  return tree;
}

}  // namespace marti::accel
