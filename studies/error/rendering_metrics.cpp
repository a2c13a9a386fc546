#include "studies/error/rendering_metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace marti::studies::error {

double root_mean_square(const processors::program::Image& image) {
  if (image.pixels.empty()) {
    return 0.0;
  }
  double squares = 0.0;
  for (const glm::vec3& pixel : image.pixels) {
    for (int channel = 0; channel < 3; ++channel) {
      const double value = pixel[channel];
      squares += value * value;
    }
  }
  return std::sqrt(squares / (3.0 * static_cast<double>(image.pixels.size())));
}

RenderingErrors rendering_errors(const processors::program::Image& image,
                                 const processors::program::Image& reference) {
  RenderingErrors errors;
  errors.plain = run::image_error(image, reference);
  const double scale = root_mean_square(reference);
  const auto over_scale = [&](double value) {
    return value == 0.0 ? 0.0 : (scale > 0.0 ? value / scale : std::numeric_limits<double>::infinity());
  };
  errors.relative = over_scale(errors.plain.rmse);
  std::vector<double> changes;
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    double most = 0.0;
    for (int channel = 0; channel < 3; ++channel) {
      const double wanted = reference.pixels[i][channel];
      const double difference = static_cast<double>(image.pixels[i][channel]) - wanted;
      errors.rel_mse += difference * difference / (wanted * wanted + 1e-2);
      most = std::max(most, std::abs(difference));
    }
    if (image.pixels[i] != reference.pixels[i]) {
      changes.push_back(most);
      errors.first = errors.first.value_or(i);
    }
  }
  if (!image.pixels.empty()) {
    errors.rel_mse /= 3.0 * static_cast<double>(image.pixels.size());
  }
  if (!changes.empty()) {
    const auto middle = changes.begin() + static_cast<std::ptrdiff_t>(changes.size() / 2);
    std::nth_element(changes.begin(), middle, changes.end());
    errors.median_change = over_scale(*middle);
  }
  return errors;
}

}  // namespace marti::studies::error
