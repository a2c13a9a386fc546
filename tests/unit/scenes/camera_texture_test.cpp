#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "scenes/camera.h"
#include "scenes/texture.h"
#include "sim/error.h"

namespace marti::scenes {
namespace {

glm::dvec3 direction(const ImagePlane& plane, double x, double y) {
  return glm::normalize(plane.corner + x * plane.step_x + y * plane.step_y);
}

TEST(Camera, ImagePlaneSpansTheFieldOfView) {
  Camera camera;
  camera.eye = {1, 2, 3};
  camera.at = {4, -1, 2};
  camera.up = {0.1, 0.2, 1};
  camera.vertical_fov = 1.1;
  const ImagePlane plane = camera.image_plane(300, 200);
  EXPECT_EQ(plane.origin, camera.eye);
  const glm::dvec3 forward = glm::normalize(camera.at - camera.eye);
  EXPECT_LT(glm::length(direction(plane, 150, 100) - forward), 1e-14);
  const double vertical = std::acos(glm::dot(direction(plane, 150, 0), direction(plane, 150, 200)));
  EXPECT_NEAR(vertical, 1.1, 1e-12);
  const double horizontal = std::acos(glm::dot(direction(plane, 0, 100), direction(plane, 300, 100)));
  EXPECT_NEAR(std::tan(horizontal / 2), 1.5 * std::tan(0.55), 1e-12) << "pixels are square";
  EXPECT_GT(glm::dot(direction(plane, 150, 0), camera.up), glm::dot(direction(plane, 150, 200), camera.up));
  EXPECT_GT(glm::dot(plane.step_x, glm::cross(forward, camera.up)), 0.0) << "x runs to the right";
  EXPECT_NEAR(glm::dot(plane.step_x, plane.step_y), 0.0, 1e-18);
  EXPECT_NEAR(glm::length(plane.step_x), glm::length(plane.step_y), 1e-16);
}

TEST(Camera, RefusesWhatHasNoFrame) {
  const auto refuses = [](auto&& change) {
    Camera camera;
    change(camera);
    EXPECT_THROW(static_cast<void>(camera.image_plane(4, 4)), sim::UserError);
  };
  refuses([](Camera& c) { c.at = c.eye; });
  refuses([](Camera& c) { c.up = glm::dvec3(0.0); });
  refuses([](Camera& c) { c.up = 3.0 * (c.at - c.eye); });
  refuses([](Camera& c) { c.eye.x = NAN; });
  refuses([](Camera& c) { c.vertical_fov = 0.0; });
  refuses([](Camera& c) { c.vertical_fov = 3.2; });
  EXPECT_THROW(static_cast<void>(Camera{}.image_plane(0, 4)), sim::UserError);
  EXPECT_THROW(static_cast<void>(Camera{}.image_plane(4, 0)), sim::UserError);
}

TEST(Texture, AnyNumberOfChannelsBecomesFour) {
  for (std::uint32_t channels = 1; channels <= 6; ++channels) {
    std::vector<std::uint8_t> samples;
    for (std::uint32_t i = 0; i < 6 * channels; ++i) {
      samples.push_back(static_cast<std::uint8_t>(10 * (i / channels) + i % channels));
    }
    const Texture texture = texture_from_samples("t", 3, 2, channels, samples);
    ASSERT_EQ(texture.texels.size(), 6U);
    for (std::uint32_t i = 0; i < 6; ++i) {
      const auto base = static_cast<std::uint8_t>(10 * i);
      const bool grey = channels <= 2;
      EXPECT_EQ(texture.texels[i][0], base);
      EXPECT_EQ(texture.texels[i][1], grey ? base : base + 1);
      EXPECT_EQ(texture.texels[i][2], grey ? base : base + 2);
      EXPECT_EQ(texture.texels[i][3], channels == 2 ? base + 1 : channels >= 4 ? base + 3 : 255);
    }
  }
  EXPECT_THROW(static_cast<void>(texture_from_samples("t", 0, 1, 1, {})), sim::UserError);
  const std::vector<std::uint8_t> five(5);
  EXPECT_THROW(static_cast<void>(texture_from_samples("t", 2, 2, 1, five)), sim::UserError);
  EXPECT_THROW(static_cast<void>(texture_from_samples("t", 4'000'000'000U, 4'000'000'000U, 1, five)),
               sim::UserError);
}

TEST(Texture, SamplesTheNearestTexel) {
  std::vector<std::uint8_t> samples(8);
  for (std::size_t i = 0; i < 8; ++i) {
    samples[i] = static_cast<std::uint8_t>(i);
  }
  Texture texture = texture_from_samples("t", 4, 2, 1, samples);
  texture.srgb = false;
  for (std::uint32_t row = 0; row < 2; ++row) {
    for (std::uint32_t column = 0; column < 4; ++column) {
      for (const double turn : {0.0, 1.0, -3.0}) {
        const TextureSample sample =
            sample_nearest(texture, {turn + (column + 0.4) / 4.0, turn + (row + 0.6) / 2.0});
        EXPECT_EQ(sample.texel, row * 4 + column);
        EXPECT_DOUBLE_EQ(sample.color.g, (row * 4 + column) / 255.0);
      }
    }
  }
  texture.repeat_u = texture.repeat_v = false;
  EXPECT_EQ(sample_nearest(texture, {-7.0, -7.0}).texel, 0U);
  EXPECT_EQ(sample_nearest(texture, {7.0, 1e300}).texel, 7U);
  EXPECT_EQ(sample_nearest(texture, {1.0, 1.0}).texel, 7U);
  texture.repeat_u = true;
  // The largest fraction below 1 and a tiny negative number, whose fraction rounds to 1.
  EXPECT_EQ(sample_nearest(texture, {std::nextafter(1.0, 0.0), 0.0}).texel, 3U);
  EXPECT_EQ(sample_nearest(texture, {-1e-300, 0.0}).texel, 3U);
  for (const double odd : {static_cast<double>(NAN), static_cast<double>(INFINITY), 1e300, -1e300}) {
    EXPECT_LT(sample_nearest(texture, {odd, odd}).texel, 8U);
  }
}

TEST(Texture, LinearisesSrgb) {
  EXPECT_EQ(srgb_to_linear(0), 0.0);
  EXPECT_EQ(srgb_to_linear(255), 1.0);
  EXPECT_NEAR(srgb_to_linear(188), 0.5, 0.005);
  for (int i = 1; i < 256; ++i) {
    EXPECT_GT(srgb_to_linear(static_cast<std::uint8_t>(i)), srgb_to_linear(static_cast<std::uint8_t>(i - 1)));
  }
  const std::vector<std::uint8_t> sample = {188, 0, 255};
  Texture texture = texture_from_samples("t", 1, 1, 3, sample);
  EXPECT_NEAR(sample_nearest(texture, {0.5, 0.5}).color.r, 0.5, 0.005);
  EXPECT_EQ(sample_nearest(texture, {0.5, 0.5}).color.b, 1.0);
}

}  // namespace
}  // namespace marti::scenes
