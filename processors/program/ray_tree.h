// The rays of one pixel, or of one of its samples, as a tree: which ray made which, and which words of the
// log belong to each.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "processors/program/work_log.h"

namespace marti::processors::program {

/// One ray of a pixel: its words from its `ray` step to the next ray's. A shadow ray that reaches its light
/// has that light's contribution among its words.
struct LoggedRay {
  static constexpr std::uint32_t none = 0xffffffffU;

  const std::uint32_t* begin = nullptr;
  const std::uint32_t* end = nullptr;
  std::uint32_t parent = none;       ///< number in the pixel of the ray at whose hit point it began
  std::uint32_t first_child = none;  ///< the first of its children, which follow in the order of the log
  std::uint32_t next_sibling = none;
  std::uint32_t bounce = 0;
  RayKind kind = RayKind::camera;

  /// The operand of its `ray` step.
  [[nodiscard]] std::uint32_t operand() const { return ray_operand(kind, bounce); }
};

/// The words of the first camera ray and of all rays that it led to, from `words`, which are a pixel's words
/// or the rest of them. In a log with one sample a pixel these are all of `words`.
[[nodiscard]] std::span<const std::uint32_t> first_sample(const WorkLog& log,
                                                          std::span<const std::uint32_t> words);

/// Fills `rays` with the rays of a sample in the order of the log, which is depth first: a ray's number is
/// greater than its parent's. The parent of a ray is the last ray before it, other than a shadow ray, of
/// fewer bounces; words before the first `ray` step belong to that ray. `rays` keeps its capacity.
void rays_of_sample(std::span<const std::uint32_t> words, std::vector<LoggedRay>& rays);

}  // namespace marti::processors::program
