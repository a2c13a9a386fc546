// How a node of an octree is divided: into which of its eight children each of its triangles is sorted, and
// when it remains a leaf. Every builder of the octree (at once, lazily, in part) uses these functions, so
// that all of them make the same tree. The arithmetic is a template over its scalar, so the cost of dividing
// a node is counted by running it with Counted.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "accel/counted.h"
#include "accel/frame.h"
#include "accel/primitive_overlap.h"
#include "accel/triangles.h"

namespace marti::accel {

/// A node's place: its level (the root is level 1) and its whole coordinates there, each in [0, 2^(level-1)).
struct OctreeCell {
  std::uint32_t level = 1;
  std::array<std::uint32_t, 3> at{};

  /// Bit 0 of `child` is the half along x, bit 1 along y, bit 2 along z.
  [[nodiscard]] constexpr OctreeCell child(std::uint32_t child) const {
    return {level + 1,
            {2 * at[0] + (child & 1U), 2 * at[1] + ((child >> 1U) & 1U), 2 * at[2] + (child >> 2U)}};
  }
  bool operator==(const OctreeCell&) const = default;
};

/// Children bit set by child number: those in the upper half of each axis.
inline constexpr std::array<std::uint32_t, 3> upper_children{0xaaU, 0xccU, 0xf0U};

/// Sorts the triangles of one node.
template <class Real = double>
class ChildSorter {
 public:
  ChildSorter(const RootFrame& frame, const OctreeCell& cell) : delta_(frame.delta) {
    // A plane is computed from its integer coordinate, so that neighbours get the same number.
    const Real scale(std::ldexp(1.0, -static_cast<int>(cell.level)));
    for (std::size_t a = 0; a < 3; ++a) {
      const auto axis = static_cast<glm::length_t>(a);
      const Real lo(frame.box.lo[axis]);
      const Real extent = Real(frame.box.hi[axis]) - lo;
      for (std::uint32_t k = 0; k < 3; ++k) {
        planes_[k][a] = lo + extent * (Real(static_cast<double>(2 * cell.at[a] + k)) * scale);
      }
      for (std::size_t side = 0; side < 2; ++side) {
        center_[side][a] = Real(0.5) * (planes_[side][a] + planes_[side + 1][a]);
        half_[side][a] = Real(0.5) * (planes_[side + 1][a] - planes_[side][a]) + delta_;
      }
    }
  }

  /// The children that list primitive `id`, as a set of bits; adds the number of overlap tests to `tests`. A
  /// primitive well inside one child needs no test.
  [[nodiscard]] std::uint32_t children(const TriangleSet& set, std::uint32_t id, std::uint32_t& tests) const {
    IntegerOf<Real> candidates = 0xffU;
    bool inside = true;
    for (std::size_t a = 0; a < 3; ++a) {
      const auto [lo, hi] = extent_of<Real>(set, id, a);
      if (lo - delta_ > planes_[1][a]) {
        candidates = candidates & upper_children[a];
      } else if (hi + delta_ < planes_[1][a]) {
        candidates = candidates & ~upper_children[a];
      }
      inside = inside && lo >= planes_[0][a] && hi <= planes_[2][a];
    }
    std::uint32_t left = plain(candidates);
    if (inside && (left & (left - 1)) == 0) {
      return left;
    }
    std::uint32_t met = 0;
    for (; left != 0; left &= left - 1) {
      const auto child = static_cast<std::uint32_t>(std::countr_zero(left));
      const std::size_t x = child & 1U;
      const std::size_t y = (child >> 1U) & 1U;
      const std::size_t z = child >> 2U;
      ++tests;
      if (overlaps<Real>(set, id, {center_[x][0], center_[y][1], center_[z][2]},
                         {half_[x][0], half_[y][1], half_[z][2]})) {
        met |= 1U << child;
      }
    }
    return met;
  }

 private:
  std::array<std::array<Real, 3>, 3> planes_{};  ///< [low, middle, high][axis]
  std::array<std::array<Real, 3>, 2> center_{};  ///< of the children, [lower, upper][axis]
  std::array<std::array<Real, 3>, 2> half_{};    ///< half their size, plus the margin
  Real delta_;
};

/// The result of sorting one node.
struct SortedChildren {
  std::array<std::vector<std::uint32_t>, 8> lists;  ///< what each child lists, in the node's order
  std::uint32_t overlaps = 0;                       ///< number of triangle against box tests
};

/// Sorts the node of `cell`, which lists `list`, into its eight children.
template <class Real = double>
void sort_into_children(const TriangleSet& triangles, const RootFrame& frame, const OctreeCell& cell,
                        std::span<const std::uint32_t> list, SortedChildren& sorted) {
  for (auto& child : sorted.lists) {
    child.clear();
  }
  sorted.overlaps = 0;
  const ChildSorter<Real> sorter(frame, cell);
  for (const std::uint32_t id : list) {
    for (std::uint32_t met = sorter.children(triangles, id, sorted.overlaps); met != 0; met &= met - 1) {
      sorted.lists[static_cast<std::size_t>(std::countr_zero(met))].push_back(id);
    }
  }
}

/// Whether cells of `level` are thick enough to be used: at least 8 delta on every axis.
[[nodiscard]] inline bool resolvable(const RootFrame& frame, std::uint32_t level) {
  for (int a = 0; a < 3; ++a) {
    const double thickness = std::ldexp(frame.box.hi[a] - frame.box.lo[a], -static_cast<int>(level - 1));
    if (!(thickness >= 8.0 * frame.delta) || !(thickness > 0.0)) {
      return false;
    }
  }
  return true;
}

/// Whether nodes of `level` may be split at all, whatever they list.
[[nodiscard]] inline bool level_splits(const RootFrame& frame, std::uint32_t max_level, std::uint32_t level) {
  return level < max_level && resolvable(frame, level + 1);
}

/// Whether a split would only repeat the parent's list: two or more children list everything and the others
/// nothing. `counts` are the numbers of the children's entries.
[[nodiscard]] inline bool separates_nothing(std::span<const std::uint32_t, 8> counts,
                                            std::size_t parent_count) {
  std::size_t complete = 0;
  for (const std::uint32_t count : counts) {
    if (count == parent_count) {
      ++complete;
    } else if (count != 0) {
      return false;
    }
  }
  return complete >= 2;
}

/// separates_nothing() for sorted lists.
[[nodiscard]] inline bool separates_nothing(const SortedChildren& sorted, std::size_t parent_count) {
  std::array<std::uint32_t, 8> counts{};
  for (std::size_t child = 0; child < 8; ++child) {
    counts[child] = static_cast<std::uint32_t>(sorted.lists[child].size());
  }
  return separates_nothing(counts, parent_count);
}

}  // namespace marti::accel
