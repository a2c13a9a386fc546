// How far an image is from its reference.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "processors/program/image.h"
#include "studies/run/voxel_report.h"

namespace marti::studies::error {

struct RenderingErrors {
  run::ImageError plain;  ///< root mean square, largest, pixels that differ
  double relative = 0.0;  ///< plain.rmse over the root mean square of the reference; 0 if that is 0 too
  /// Mean over pixels and channels of (x - r)^2 / (r^2 + 0.01): dark parts weigh as much as bright ones
  /// (F. Rousselle, C. Knaus, M. Zwicker, "Adaptive sampling and reconstruction using greedy error
  /// minimization", ACM TOG 30(6), 2011).
  double rel_mse = 0.0;
  /// Of the pixels that differ, the median of their largest channel's difference over the root mean square of
  /// the reference: what rounding does to a typical pixel. 0 if none differs.
  double median_change = 0.0;
  std::optional<std::size_t> first;  ///< index of the first pixel that differs in any bit, row by row
};

/// Root of the mean square over all pixels and channels; 0 for no pixels.
[[nodiscard]] double root_mean_square(const processors::program::Image& image);

/// The images must be of one size.
[[nodiscard]] RenderingErrors rendering_errors(const processors::program::Image& image,
                                               const processors::program::Image& reference);

}  // namespace marti::studies::error
