#include "studies/estimate/packet_windows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "sim/error.h"
#include "sim/mix.h"

namespace marti::studies::estimate {

namespace {

std::uint64_t strata_of(std::uint64_t windows, std::uint64_t wanted) {
  while (wanted > 1 && wanted > windows / 2) {
    wanted /= 2;
  }
  return std::max<std::uint64_t>(1, wanted);
}

// The first place of the lattice along a side, and how many there are.
std::uint32_t first_of(std::uint32_t side) { return std::min(PixelLattice::step / 2, side - 1); }
std::uint32_t count_of(std::uint32_t side) { return (side - 1 - first_of(side)) / PixelLattice::step + 1; }

}  // namespace

std::vector<Stratum> draw_strata(std::uint64_t units, std::uint64_t count, std::uint64_t seed) {
  sim::ensure(count >= 1 && count <= units, "a number of strata without units");
  // Each unit has a rank of its own at random, and the two lowest of a stratum are drawn. The lowest two of a
  // stratum are among the lowest two of each half.
  const auto rank = [start = sim::mix(seed)](std::uint64_t unit) { return sim::mix(unit ^ start); };
  std::vector<Stratum> strata(count);
  for (std::uint64_t i = 0; i < count; ++i) {
    Stratum& stratum = strata[i];
    stratum.first = units / count * i + units % count * i / count;
    stratum.end = units / count * (i + 1) + units % count * (i + 1) / count;
    std::vector<std::uint64_t> all(stratum.size());
    std::iota(all.begin(), all.end(), stratum.first);
    const auto drawn = all.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(2, all.size()));
    std::partial_sort(all.begin(), drawn, all.end(),
                      [&](std::uint64_t a, std::uint64_t b) { return rank(a) < rank(b); });
    stratum.chosen.assign(all.begin(), drawn);
    std::ranges::sort(stratum.chosen);
  }
  return strata;
}

bool all_chosen(std::span<const Stratum> strata) {
  return std::ranges::all_of(strata,
                             [](const Stratum& stratum) { return stratum.chosen.size() == stratum.size(); });
}

PacketWindows::PacketWindows(const processors::machine::PacketList& packets, std::uint64_t length,
                             std::uint64_t strata, std::uint64_t seed)
    : packets_(packets),
      length_(std::min(length, packets.size())),
      windows_(packets.size() / length_),
      strata_(draw_strata(windows_, strata_of(windows_, strata), seed)) {}

std::vector<std::uint64_t> PacketWindows::chosen() const {
  std::vector<std::uint64_t> packets;
  for_each_drawn([&](std::uint64_t window) {
    for (std::uint64_t packet = first(window); packet < end(window); ++packet) {
      packets.push_back(packet);
    }
  });
  return packets;
}

void PacketWindows::add_to(processors::program::PixelSet& pixels) const {
  for (const std::uint64_t packet : chosen()) {
    for_each_pixel(packets_[packet], [&](std::uint32_t x, std::uint32_t y) { pixels.add(x, y); });
  }
}

PixelLattice::PixelLattice(std::uint32_t width, std::uint32_t height)
    : width_(width), height_(height), columns_(count_of(width)), rows_(count_of(height)) {}

std::vector<processors::walk::PixelPlace> PixelLattice::pixels() const {
  std::vector<processors::walk::PixelPlace> pixels;
  for (std::uint32_t y = first_of(height_); y < height_; y += step) {
    for (std::uint32_t x = first_of(width_); x < width_; x += step) {
      pixels.push_back({x, y});
    }
  }
  return pixels;
}

void PixelLattice::add_to(processors::program::PixelSet& pixels) const {
  for (const processors::walk::PixelPlace& pixel : this->pixels()) {
    pixels.add(pixel.x, pixel.y);
  }
}

double PixelLattice::half_width(std::span<const double> values) const {
  sim::ensure(values.size() == std::size_t{columns_} * rows_, "values of another lattice");
  double squares = 0.0;
  double pairs = 0.0;
  const auto compare = [&](std::size_t a, std::size_t b) {
    const double difference = values[a] - values[b];
    squares += difference * difference;
    pairs += 1.0;
  };
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i % columns_ != 0) {
      compare(i, i - 1);
    }
    if (i >= columns_) {
      compare(i, i - columns_);
    }
  }
  if (pairs == 0.0) {
    return std::numeric_limits<double>::infinity();
  }
  const auto n = static_cast<double>(values.size());
  const double pixels = static_cast<double>(width_) * static_cast<double>(height_);
  constexpr double normal_95 = 1.959963984540054;
  return normal_95 * pixels * std::sqrt((1.0 - n / pixels) * 0.5 * squares / pairs / n);
}

}  // namespace marti::studies::estimate
