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

template <class Use>
void for_each_pixel(const processors::machine::Packet& packet, const Use& use) {
  for (std::uint32_t y = packet.y0; y < packet.y1; ++y) {
    for (std::uint32_t x = packet.x0; x < packet.x1; ++x) {
      use(x, y);
    }
  }
}

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

PixelLattice::Axis::Axis(std::uint32_t size) {
  for (std::uint32_t place = std::min(step / 2, size - 1); place < size; place += step) {
    places.push_back(place);
  }
  for (std::uint32_t place = 0; place < size; ++place) {
    next_to.push_back(std::min(place / step, static_cast<std::uint32_t>(places.size()) - 1));
  }
}

PixelLattice::PixelLattice(std::uint32_t width, std::uint32_t height) : columns_(width), rows_(height) {}

std::vector<processors::walk::PixelPlace> PixelLattice::pixels() const {
  std::vector<processors::walk::PixelPlace> pixels;
  pixels.reserve(size());
  for (const std::uint32_t y : rows_.places) {
    for (const std::uint32_t x : columns_.places) {
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

std::vector<double> PixelLattice::expected_of_packets(std::span<const double> values,
                                                      const processors::machine::PacketList& packets) const {
  sim::ensure(values.size() == size(), "values of another lattice");
  std::vector<double> expected(packets.size());
  for (std::uint64_t packet = 0; packet < packets.size(); ++packet) {
    for_each_pixel(packets[packet], [&](std::uint32_t x, std::uint32_t y) {
      expected[packet] += values[columns_.places.size() * rows_.next_to[y] + columns_.next_to[x]];
    });
  }
  return expected;
}

double PixelLattice::half_width(std::span<const double> values) const {
  sim::ensure(values.size() == size(), "values of another lattice");
  const std::size_t columns = columns_.places.size();
  double squares = 0.0;
  double pairs = 0.0;
  const auto compare = [&](std::size_t a, std::size_t b) {
    const double difference = values[a] - values[b];
    squares += difference * difference;
    pairs += 1.0;
  };
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i % columns != 0) {
      compare(i, i - 1);
    }
    if (i >= columns) {
      compare(i, i - columns);
    }
  }
  if (pairs == 0.0) {
    return std::numeric_limits<double>::infinity();
  }
  const auto n = static_cast<double>(values.size());
  const double pixels =
      static_cast<double>(columns_.next_to.size()) * static_cast<double>(rows_.next_to.size());
  constexpr double normal_95 = 1.959963984540054;
  return normal_95 * pixels * std::sqrt((1.0 - n / pixels) * 0.5 * squares / pairs / n);
}

PixelLattice::ImageWork PixelLattice::expected_of_image(const processors::program::WorkLog& log) const {
  ImageWork work;
  for (const processors::walk::PixelPlace& pixel : pixels()) {
    const std::span<const std::uint32_t> words = log.pixel(pixel.x, pixel.y);
    work.words += static_cast<double>(words.size());
    for (std::size_t at = 0; at < words.size(); at += processors::program::step_words(&words[at])) {
      work.rays += processors::program::step_of(words[at]) == processors::program::Step::ray ? 1.0 : 0.0;
    }
  }
  const double scale =
      static_cast<double>(log.width) * static_cast<double>(log.height) / static_cast<double>(size());
  return {scale * work.rays, scale * work.words};
}

}  // namespace marti::studies::estimate
