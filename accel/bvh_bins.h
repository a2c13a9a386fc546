// How a node of the binary tree under a bounding volume hierarchy is split: its references are sorted into
// bins along three axes, and the best plane between two bins is found (bvh_build.h). Float: float, or the
// scalar that counts.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "accel/bvh_box.h"
#include "accel/bvh_options.h"
#include "accel/counted.h"

namespace marti::accel {

/// A node whose centroids lie closer together than this along an axis is not split across it.
inline constexpr float bvh_least_extent = 0x1p-100F;

/// How a centroid finds its bin.
template <class Float>
struct BvhBinning {
  using Box = BvhBoxOf<Float>;
  using Count = std::conditional_t<std::is_same_v<Float, float>, std::uint32_t, CountedInt>;

  std::array<Float, 3> from{};
  std::array<Float, 3> scale{};
  std::array<bool, 3> wide{};  ///< the axis has an extent
  std::uint32_t bins = 2;

  /// A short list takes fewer bins: it has fewer places where it can be split.
  BvhBinning(const Box& centroids, std::uint32_t most, std::uint32_t count)
      : bins(std::min(most, 2 * count)) {
    for (std::size_t a = 0; a < 3; ++a) {
      const Float extent = centroids.hi[a] - centroids.lo[a];
      from[a] = centroids.lo[a];
      wide[a] = extent > bvh_least_extent;
      scale[a] = wide[a] ? static_cast<float>(bins) * 0.99999F / extent : Float(0.0F);
    }
  }
  [[nodiscard]] std::uint32_t bin(const typename Box::Point& centroid, std::size_t axis) const {
    using std::min;
    const Float at = (centroid[axis] - from[axis]) * scale[axis];
    return static_cast<std::uint32_t>(
        min(Count(static_cast<std::uint32_t>(static_cast<float>(at))), Count(bins - 1)));
  }
  /// Between bins, along all axes that have an extent.
  [[nodiscard]] std::uint32_t planes() const {
    return (bins - 1) * static_cast<std::uint32_t>(std::count(wide.begin(), wide.end(), true));
  }
};

template <class Float>
struct BvhPlane {
  Float cost = BvhBoxOf<Float>::inf;  ///< sum over the children of area times primitives
  std::size_t axis = 0;
  std::uint32_t bin = 0;  ///< the last one of the first child
};

/// Bins along the three axes.
template <class Float>
struct BvhBins {
  using Binning = BvhBinning<Float>;
  using Box = BvhBoxOf<Float>;
  using Count = typename Binning::Count;
  struct Bin {
    Box box;
    Count count = 0U;
  };
  using Row = std::array<Bin, bvh_most_bins>;

  std::array<Row, 3> of_axis;

  void clear(std::uint32_t bins) {
    for (Row& row : of_axis) {
      std::fill(row.begin(), row.begin() + bins, Bin{});
    }
  }
  void add(const Box& box, const Binning& binning) {
    const typename Box::Point centroid = box.centroid();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Bin& bin = of_axis[axis][binning.bin(centroid, axis)];
      bin.box.include(box);
      bin.count = bin.count + 1U;
    }
  }
  void merge(const BvhBins& other, std::uint32_t bins) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::uint32_t bin = 0; bin < bins; ++bin) {
        of_axis[axis][bin].box.include(other.of_axis[axis][bin].box);
        of_axis[axis][bin].count = of_axis[axis][bin].count + other.of_axis[axis][bin].count;
      }
    }
  }

  [[nodiscard]] BvhPlane<Float> best_plane(const Binning& binning) const {
    const auto number = [](Count count) {
      return Float(static_cast<float>(static_cast<std::uint32_t>(count)));
    };
    BvhPlane<Float> best;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!binning.wide[axis]) {
        continue;
      }
      const Row& row = of_axis[axis];
      std::array<Float, bvh_most_bins> above{};
      Box box;
      Count count = 0U;
      for (std::uint32_t bin = binning.bins - 1; bin > 0; --bin) {
        box.include(row[bin].box);
        count = count + row[bin].count;
        above[bin - 1] = box.half_area() * number(count);
      }
      box = {};
      count = 0U;
      for (std::uint32_t bin = 0; bin + 1 < binning.bins; ++bin) {
        box.include(row[bin].box);
        count = count + row[bin].count;
        const Float cost = box.half_area() * number(count) + above[bin];
        if (cost < best.cost) {
          best = {cost, axis, bin};
        }
      }
    }
    return best;
  }
};

}  // namespace marti::accel
