// Interpolation between key frames against closed forms and independent arithmetic.
#include "scenes/keyframes.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <glm/geometric.hpp>

#include "sim/error.h"

namespace marti::scenes {
namespace {

/// A number of -bound to bound.
double number(double bound) { return (*rc::gen::inRange(-1'000'000, 1'000'001)) * bound / 1e6; }

std::vector<double> increasing_times(int count) {
  std::vector<double> times = {std::abs(number(2.0))};
  while (static_cast<int>(times.size()) < count) {
    times.push_back(times.back() + 0.001 + std::abs(number(3.0)));
  }
  return times;
}

glm::dvec4 unit_quaternion() {
  glm::dvec4 q(number(1.0), number(1.0), number(1.0), number(1.0));
  RC_PRE(glm::length(q) > 0.01);
  return glm::normalize(q);
}

/// Appendix C.4 of the glTF 2.0 specification, literally, in long double.
glm::dvec4 slerp_by_the_book(const glm::dvec4& from, const glm::dvec4& to, double t) {
  long double dot = 0.0L;
  for (int i = 0; i < 4; ++i) {
    dot += static_cast<long double>(from[i]) * static_cast<long double>(to[i]);
  }
  const long double sign = dot < 0.0L ? -1.0L : 1.0L;
  const long double a = std::acos(std::min(1.0L, std::abs(dot)));
  glm::dvec4 result;
  for (int i = 0; i < 4; ++i) {
    const long double t0 = static_cast<long double>(t);
    result[i] = static_cast<double>(std::sin(a * (1.0L - t0)) / std::sin(a) * from[i] +
                                    sign * std::sin(a * t0) / std::sin(a) * to[i]);
  }
  return result;
}

TEST(KeyFrames, StepHoldsAndAllAreClamped) {
  const KeyFrames frames{Interpolation::step, 2, {1.0, 2.0, 4.0}, {10, 11, 20, 21, 30, 31}};
  EXPECT_EQ(value_at(frames, -5.0), (std::vector<double>{10, 11}));
  EXPECT_EQ(value_at(frames, 1.0), (std::vector<double>{10, 11}));
  EXPECT_EQ(value_at(frames, std::nextafter(2.0, 0.0)), (std::vector<double>{10, 11}));
  EXPECT_EQ(value_at(frames, 2.0), (std::vector<double>{20, 21}));
  EXPECT_EQ(value_at(frames, 3.9), (std::vector<double>{20, 21}));
  EXPECT_EQ(value_at(frames, 4.0), (std::vector<double>{30, 31}));
  EXPECT_EQ(value_at(frames, 1e300), (std::vector<double>{30, 31}));
}

RC_GTEST_PROP(KeyFrames, KeyFramesAreMetExactlyAndEndsAreClamped, ()) {
  const int count = *rc::gen::inRange(2, 8);
  for (const Interpolation kind : {Interpolation::step, Interpolation::linear, Interpolation::cubic_spline}) {
    KeyFrames frames{kind, 3, increasing_times(count), {}};
    const std::size_t parts = kind == Interpolation::cubic_spline ? 3 : 1;
    for (std::size_t i = 0; i < 3 * parts * frames.times.size(); ++i) {
      frames.values.push_back(number(100.0));
    }
    for (std::size_t k = 0; k < frames.times.size(); ++k) {
      const auto first =
          frames.values.begin() + static_cast<std::ptrdiff_t>(3 * (parts == 3 ? 3 * k + 1 : k));
      RC_ASSERT(value_at(frames, frames.times[k]) == std::vector<double>(first, first + 3));
    }
    RC_ASSERT(value_at(frames, frames.times.front() - 1.0) == value_at(frames, frames.times.front()));
    RC_ASSERT(value_at(frames, frames.times.back() + 1.0) == value_at(frames, frames.times.back()));
  }
}

RC_GTEST_PROP(KeyFrames, LinearIsTheStraightLine, ()) {
  KeyFrames frames{Interpolation::linear, 1, increasing_times(5), {}};
  const double slope = number(10.0);
  const double offset = number(10.0);
  for (const double time : frames.times) {
    frames.values.push_back(offset + slope * time);
  }
  const double span = frames.times.back() - frames.times.front();
  const double time = frames.times.front() + std::abs(number(1.0)) * span;
  RC_ASSERT(std::abs(value_at(frames, time)[0] - (offset + slope * time)) < 1e-11);
}

RC_GTEST_PROP(KeyFrames, ACubicSplineReproducesAnyCubic, ()) {
  // Two values and two slopes fix a cubic: the spline must be the polynomial itself, whatever its key frames.
  std::vector<double> c = {number(2.0), number(2.0), number(2.0), number(2.0)};
  const auto value = [&](double t) { return c[0] + t * (c[1] + t * (c[2] + t * c[3])); };
  const auto slope = [&](double t) { return c[1] + t * (2.0 * c[2] + t * 3.0 * c[3]); };
  KeyFrames frames{Interpolation::cubic_spline, 1, increasing_times(4), {}};
  for (const double time : frames.times) {
    frames.values.insert(frames.values.end(), {slope(time), value(time), slope(time)});
  }
  const double span = frames.times.back() - frames.times.front();
  const double time = frames.times.front() + std::abs(number(1.0)) * span;
  RC_ASSERT(std::abs(value_at(frames, time)[0] - value(time)) < 1e-9 * (1.0 + std::abs(value(20.0))));
}

TEST(KeyFrames, InAndOutTangentsAreOneSided) {
  // At the middle frame the tangents differ: each must count on its own side only.
  const KeyFrames frames{Interpolation::cubic_spline, 1, {0.0, 1.0, 2.0}, {9, 0, 0, 8, 0, 0, 0, 0, 9}};
  EXPECT_NEAR(value_at(frames, 0.5)[0], -1.0, 1e-12);  // 8 (t^3 - t^2) at one half
  EXPECT_EQ(value_at(frames, 1.5)[0], 0.0);
}

RC_GTEST_PROP(Slerp, AgreesWithTheFormulaInLongDouble, ()) {
  const glm::dvec4 from = unit_quaternion();
  const glm::dvec4 to = unit_quaternion();
  RC_PRE(std::abs(glm::dot(from, to)) < 0.9999999);
  const double t = std::abs(number(1.0));
  RC_ASSERT(glm::length(slerp(from, to, t) - slerp_by_the_book(from, to, t)) < 1e-9);
  RC_ASSERT(std::abs(glm::length(slerp(from, to, t)) - 1.0) < 1e-12);
}

RC_GTEST_PROP(Slerp, TakesTheShorterWayAtConstantSpeed, ()) {
  const glm::dvec4 from = unit_quaternion();
  const glm::dvec4 to = unit_quaternion();
  const double t = std::abs(number(1.0));
  const auto angle = [](const glm::dvec4& a, const glm::dvec4& b) {
    return 2.0 * std::atan2(glm::length(a - b), glm::length(a + b));
  };
  const double whole = std::min(angle(from, to), angle(from, -to));
  RC_ASSERT(whole <= std::numbers::pi / 2.0 + 1e-12);
  RC_ASSERT(std::abs(angle(from, slerp(from, to, t)) - t * whole) < 1e-12);
  // The sign of a quaternion does not change the rotation.
  const glm::dvec4 other = slerp(from, -to, t);
  RC_ASSERT(glm::length(slerp(from, to, t) - other) < 1e-12);
}

TEST(Slerp, EqualAndNearlyEqualRotations) {
  const glm::dvec4 q(0.0, 0.0, 0.0, 1.0);
  EXPECT_EQ(slerp(q, q, 0.3), q);
  EXPECT_EQ(slerp(q, -q, 0.3), q);
  const glm::dvec4 near(1e-12, 0.0, 0.0, 1.0);
  EXPECT_NEAR(slerp(q, near, 0.25).x, 0.25e-12, 1e-26);
}

TEST(Slerp, HalfOfARightAngleIsFortyFiveDegrees) {
  const double half = std::numbers::pi / 4.0;
  const KeyFrames frames{
      Interpolation::linear, 4, {0.0, 1.0}, {0, 0, 0, 1, 0, 0, std::sin(half), std::cos(half)}};
  const glm::dvec4 q = rotation_at(frames, 0.5);
  EXPECT_NEAR(q.z, std::sin(half / 2.0), 1e-15);
  EXPECT_NEAR(q.w, std::cos(half / 2.0), 1e-15);
}

TEST(KeyFrames, AFaultOfOursIsNoTimeAndNoKeyFrame) {
  EXPECT_THROW(static_cast<void>(value_at(KeyFrames{}, 0.0)), sim::InternalError);
  const KeyFrames one{Interpolation::linear, 1, {0.0}, {1.0}};
  EXPECT_THROW(static_cast<void>(value_at(one, std::nan(""))), sim::InternalError);
  EXPECT_THROW(static_cast<void>(rotation_at(one, 0.0)), sim::InternalError);
}

}  // namespace
}  // namespace marti::scenes
