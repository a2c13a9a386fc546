#include "studies/run/record/heat_map.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/mapped.h"
#include "studies/run/record/colour_scale.h"

namespace marti::studies::run {

using processors::walk::NodeState;
using processors::walk::PixelPlace;

void HeatMap::begin(const processors::walk::ReplayInput& input) {
  width_ = input.log.width;
  height_ = input.log.height;
  period_ = input.config.clock.period();
  for (std::vector<std::int64_t>& values : values_) {
    values.assign(std::size_t{width_} * height_, 0);
  }
}

void HeatMap::spent(std::uint32_t /*node*/, NodeState state, sim::Ticks from, sim::Ticks to,
                    PixelPlace pixel) {
  if (pixel.none()) {
    return;
  }
  values_[static_cast<std::size_t>(Heat::cycles)][index(pixel)] += to - from;
  if (state != NodeState::working) {
    values_[static_cast<std::size_t>(Heat::waits)][index(pixel)] += to - from;
  }
}

void HeatMap::missed(std::uint32_t /*node*/, std::int64_t misses, PixelPlace pixel) {
  if (!pixel.none()) {
    values_[static_cast<std::size_t>(Heat::misses)][index(pixel)] += misses;
  }
}

std::vector<float> HeatMap::figures(Heat heat) const {
  const double unit = heat == Heat::misses ? 1.0 : static_cast<double>(period_);
  return sim::mapped(values(heat), [&](const std::int64_t value) {
    return static_cast<float>(static_cast<double>(value) / unit);
  });
}

Legend legend_of(const std::vector<float>& figures) {
  Legend legend;
  if (figures.empty()) {
    return legend;
  }
  std::vector<float> sorted = figures;
  const auto rank = static_cast<std::ptrdiff_t>((sorted.size() * 99 + 99) / 100 - 1);
  std::nth_element(sorted.begin(), sorted.begin() + rank, sorted.end());
  legend.brightest = static_cast<double>(sorted[static_cast<std::size_t>(rank)]);
  legend.largest = static_cast<double>(*std::ranges::max_element(figures));
  if (legend.brightest == 0.0) {
    legend.brightest = legend.largest;
  }
  legend.mean = std::accumulate(figures.begin(), figures.end(), 0.0) / static_cast<double>(figures.size());
  return legend;
}

processors::program::Image false_colour(const std::vector<float>& figures, std::uint32_t width,
                                        std::uint32_t height, const Legend& legend) {
  processors::program::Image image{width, height, {}};
  image.pixels.reserve(figures.size());
  for (const float figure : figures) {
    const double share = legend.brightest > 0.0 ? static_cast<double>(figure) / legend.brightest : 0.0;
    image.pixels.push_back(colour_of(share));
  }
  return image;
}

}  // namespace marti::studies::run
