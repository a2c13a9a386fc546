// The user's scene moved and scaled, its hits beside those of brute force, and floats beside doubles.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "accel/ray.h"
#include "accel/structure.h"
#include "studies/stability/hostile_rays.h"
#include "studies/stability/stability_case.h"
#include "studies/tables/table.h"

namespace marti::studies::stability {

/// Equal bit for bit.
[[nodiscard]] bool same_hit(const accel::Hit& a, const accel::Hit& b);

/// The rays for which `good` does not hold. It is asked by all host threads.
[[nodiscard]] Tally tally_of(const std::vector<accel::Ray>& rays,
                             const std::function<bool(const accel::Ray&)>& good);

/// The nearest hit, computed in doubles or in floats.
[[nodiscard]] accel::Hit closest(const accel::Structure& structure, const accel::Ray& ray, bool floats);

/// Rays whose nearest hit is not that of brute force, bit for bit; in doubles also those of which the two
/// disagree on whether anything is hit.
[[nodiscard]] Tally differences(const accel::Structure& structure, const std::vector<accel::Ray>& rays,
                                bool floats = false);

/// Whether products of two lengths of the scene, and of its rays, stay in a float's range.
[[nodiscard]] bool within_floats(const accel::TriangleSet& triangles);

/// A copy of the subject's scene with a structure of its own.
struct Moved {
  double offset = 0.0;  ///< by which it is moved along every axis
  std::shared_ptr<const accel::TriangleSet> triangles;
  std::unique_ptr<const accel::Structure> structure;

  /// All lengths times `factor`, then moved along every axis by so many times the scene's largest side.
  /// std::nullopt when there can be no such scene: coordinates or sizes would leave the range of the program.
  [[nodiscard]] static std::optional<Moved> of(const Subject& subject, double factor, double sizes);
};

/// By how many times its largest side the scene is moved.
inline constexpr std::array<double, 4> places{0.0, 1e3, 1e6, 1e9};

/// Rays of these kinds by turns, at a structure and its primitives.
[[nodiscard]] std::vector<accel::Ray> rays_of(const accel::Structure& structure, std::span<const Aim> aims,
                                              std::uint32_t count);

/// "float_double": for each of `places` that can be.
[[nodiscard]] tables::Table precision_table(const Subject& subject);

}  // namespace marti::studies::stability
