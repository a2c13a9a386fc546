// Metrics of images against second, plainer implementations.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "studies/error/rendering_metrics.h"

namespace marti::studies {

using namespace error;

namespace {

using processors::program::Image;

Image random_image(std::mt19937_64& random, std::uint32_t width, std::uint32_t height) {
  std::uniform_real_distribution<float> value(0.0F, 2.0F);
  Image image{width, height, sim::LargeVector<glm::vec3>(std::size_t{width} * height)};
  for (glm::vec3& pixel : image.pixels) {
    pixel = {value(random), value(random), value(random)};
  }
  return image;
}

TEST(RenderingMetrics, OfEqualImagesAreNothing) {
  std::mt19937_64 random(3);
  const Image image = random_image(random, 7, 5);
  const RenderingErrors errors = rendering_errors(image, image);
  EXPECT_EQ(errors.plain.rmse, 0.0);
  EXPECT_EQ(errors.relative, 0.0);
  EXPECT_EQ(errors.rel_mse, 0.0);
  EXPECT_EQ(errors.plain.changed, 0U);
  EXPECT_EQ(errors.median_change, 0.0);
  EXPECT_FALSE(errors.first);
}

TEST(RenderingMetrics, OfOnePixelByHand) {
  Image reference{2, 2, sim::LargeVector<glm::vec3>(4, glm::vec3(0.5F))};
  Image image = reference;
  image.pixels[2] = {0.5F, 0.75F, 0.5F};
  const RenderingErrors errors = rendering_errors(image, reference);
  EXPECT_DOUBLE_EQ(errors.plain.rmse, 0.25 / std::sqrt(12.0));
  EXPECT_DOUBLE_EQ(errors.relative, 0.5 / std::sqrt(12.0));
  EXPECT_DOUBLE_EQ(errors.rel_mse, 0.0625 / 0.26 / 12.0);
  EXPECT_DOUBLE_EQ(errors.plain.largest, 0.25);
  EXPECT_EQ(errors.plain.changed, 1U);
  EXPECT_EQ(errors.plain.visible, 1U);
  EXPECT_DOUBLE_EQ(errors.median_change, 0.5);
  EXPECT_EQ(errors.first, 2U);
}

TEST(RenderingMetrics, AgainstABlackReferenceAreInfiniteOrNothing) {
  const Image black{1, 1, {glm::vec3(0.0F)}};
  const Image grey{1, 1, {glm::vec3(0.1F)}};
  EXPECT_EQ(rendering_errors(black, black).relative, 0.0);
  EXPECT_TRUE(std::isinf(rendering_errors(grey, black).relative));
  EXPECT_NEAR(rendering_errors(grey, black).rel_mse, 1.0, 1e-6);
}

RC_GTEST_PROP(RenderingMetrics, EqualPlainSums, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const Image reference = random_image(random, 6, 4);
  Image image = reference;
  for (glm::vec3& pixel : image.pixels) {
    if (random() % 3 == 0) {
      pixel = random_image(random, 1, 1).pixels[0];
    }
  }
  long double squares = 0.0L;
  long double relative = 0.0L;
  long double level = 0.0L;
  std::vector<double> changes;
  std::size_t first = image.pixels.size();
  for (std::size_t i = image.pixels.size(); i-- > 0;) {
    double most = 0.0;
    for (int channel = 0; channel < 3; ++channel) {
      const long double r = reference.pixels[i][channel];
      const long double d = image.pixels[i][channel] - r;
      squares += d * d / 72.0L;
      relative += d * d / (r * r + 0.01L) / 72.0L;
      level += r * r / 72.0L;
      most = std::max(most, static_cast<double>(std::abs(d)));
    }
    if (most > 0.0) {
      changes.push_back(most);
      first = i;
    }
  }
  const RenderingErrors errors = rendering_errors(image, reference);
  const auto close = [](double a, long double b) {
    return std::abs(a - static_cast<double>(b)) <= 1e-12 * (1.0 + std::abs(a));
  };
  RC_ASSERT(close(errors.plain.rmse, std::sqrt(squares)));
  RC_ASSERT(close(errors.rel_mse, relative));
  RC_ASSERT(close(root_mean_square(reference), std::sqrt(level)));
  RC_ASSERT(close(errors.relative, std::sqrt(squares / level)));
  RC_ASSERT(errors.plain.changed == changes.size());
  RC_ASSERT(errors.first.has_value() == !changes.empty());
  if (!changes.empty()) {
    RC_ASSERT(*errors.first == first);
    std::sort(changes.begin(), changes.end());
    RC_ASSERT(close(errors.median_change, changes[changes.size() / 2] / std::sqrt(level)));
  }
}

}  // namespace
}  // namespace marti::studies
