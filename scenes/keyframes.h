// Values that change over time: key frames and the interpolation between them, as glTF 2.0.1 defines them in
// section 3.11 (Animations) and Appendix C (Animation Sampler Interpolation Modes).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec4.hpp>

namespace marti::scenes {

enum class Interpolation : std::uint8_t { step, linear, cubic_spline };

/// One value of `width` numbers that changes over time.
struct KeyFrames {
  Interpolation interpolation = Interpolation::linear;
  std::size_t width = 1;
  std::vector<double> times;  ///< seconds, strictly increasing, at least one
  /// `width` numbers for each time. For a cubic spline three times as many: for each time the in-tangents,
  /// the values and the out-tangents; tangents are per second.
  std::vector<double> values;
};

/// The value at a finite time: at a key frame exactly its value, before the first key frame the first value,
/// after the last one the last; between two key frames interpolated component by component.
[[nodiscard]] std::vector<double> value_at(const KeyFrames& frames, double seconds);

/// value_at() for rotations, quaternions (x, y, z, w) of a length above 0: linear interpolation is spherical,
/// along the shorter way (Appendix C.4). The result is in general not of unit length; that of a cubic spline
/// may have length 0.
[[nodiscard]] glm::dvec4 rotation_at(const KeyFrames& frames, double seconds);

/// Spherical linear interpolation between two unit quaternions, by the shorter way; `t` from 0 to 1.
[[nodiscard]] glm::dvec4 slerp(const glm::dvec4& from, const glm::dvec4& to, double t);

}  // namespace marti::scenes
