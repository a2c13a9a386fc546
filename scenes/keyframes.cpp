#include "scenes/keyframes.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "sim/error.h"

namespace marti::scenes {

namespace {

/// A time among key frames: exactly at `frame` if `t` is 0, else at the share `t` of the way to the next.
struct Place {
  std::size_t frame = 0;
  double t = 0.0;
  double length = 0.0;  // seconds between the two key frames
};

Place find(const KeyFrames& frames, double seconds) {
  const std::vector<double>& times = frames.times;
  sim::ensure(!times.empty() && std::isfinite(seconds), "a value needs key frames and a finite time");
  if (seconds <= times.front()) {
    return {};
  }
  if (seconds >= times.back()) {
    return {times.size() - 1, 0.0, 0.0};
  }
  const auto next = std::upper_bound(times.begin(), times.end(), seconds);
  Place place;
  place.frame = static_cast<std::size_t>(next - times.begin()) - 1;
  if (frames.interpolation != Interpolation::step) {
    place.length = *next - times[place.frame];
    place.t = (seconds - times[place.frame]) / place.length;
  }
  return place;
}

/// The numbers of a key frame; for a cubic spline `part` is 0: in-tangents, 1: values, 2: out-tangents.
std::span<const double> numbers(const KeyFrames& frames, std::size_t frame, std::size_t part) {
  const bool spline = frames.interpolation == Interpolation::cubic_spline;
  const std::size_t at = spline ? 3 * frame + part : frame;
  return std::span(frames.values).subspan(at * frames.width, frames.width);
}

std::vector<double> value_at(const KeyFrames& frames, const Place& place) {
  const std::span<const double> here = numbers(frames, place.frame, 1);
  std::vector<double> value(here.begin(), here.end());
  const double t = place.t;
  if (t == 0.0) {
    return value;
  }
  const std::span<const double> next = numbers(frames, place.frame + 1, 1);
  if (frames.interpolation == Interpolation::linear) {
    for (std::size_t i = 0; i < value.size(); ++i) {
      value[i] = (1.0 - t) * here[i] + t * next[i];
    }
    return value;
  }
  const std::span<const double> leaving = numbers(frames, place.frame, 2);
  const std::span<const double> arriving = numbers(frames, place.frame + 1, 0);
  const double t2 = t * t;
  const double t3 = t2 * t;
  for (std::size_t i = 0; i < value.size(); ++i) {
    value[i] = (2.0 * t3 - 3.0 * t2 + 1.0) * here[i] + place.length * (t3 - 2.0 * t2 + t) * leaving[i] +
               (3.0 * t2 - 2.0 * t3) * next[i] + place.length * (t3 - t2) * arriving[i];
  }
  return value;
}

glm::dvec4 quaternion(std::span<const double> numbers) {
  return {numbers[0], numbers[1], numbers[2], numbers[3]};
}

}  // namespace

std::vector<double> value_at(const KeyFrames& frames, double seconds) {
  return value_at(frames, find(frames, seconds));
}

glm::dvec4 rotation_at(const KeyFrames& frames, double seconds) {
  sim::ensure(frames.width == 4, "a rotation has four numbers");
  const Place place = find(frames, seconds);
  if (place.t == 0.0 || frames.interpolation != Interpolation::linear) {
    return quaternion(value_at(frames, place));
  }
  // Quaternions stored as integers have only approximately unit length.
  return slerp(glm::normalize(quaternion(numbers(frames, place.frame, 1))),
               glm::normalize(quaternion(numbers(frames, place.frame + 1, 1))), place.t);
}

glm::dvec4 slerp(const glm::dvec4& from, const glm::dvec4& to, double t) {
  const glm::dvec4 target = glm::dot(from, to) < 0.0 ? -to : to;
  // The angle from chords: an arc cosine loses all digits when the two are close.
  const double angle = 2.0 * std::atan2(glm::length(target - from), glm::length(target + from));
  const double sine = std::sin(angle);
  if (!(sine > 0.0)) {
    return from;
  }
  return from * (std::sin((1.0 - t) * angle) / sine) + target * (std::sin(t * angle) / sine);
}

}  // namespace marti::scenes
