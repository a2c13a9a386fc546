// A set of an image's pixels: those that a partial rendering traces.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

namespace marti::processors::program {

class PixelSet {
 public:
  /// Empty.
  PixelSet(std::uint32_t width, std::uint32_t height)
      : width_(width), height_(height), bits_((std::size_t{width} * height + 63) / 64) {}

  [[nodiscard]] std::uint32_t width() const { return width_; }
  [[nodiscard]] std::uint32_t height() const { return height_; }
  [[nodiscard]] bool has(std::uint32_t x, std::uint32_t y) const {
    return (bits_[at(x, y) / 64] >> at(x, y) % 64 & 1U) != 0;
  }
  void add(std::uint32_t x, std::uint32_t y) { bits_[at(x, y) / 64] |= std::uint64_t{1} << at(x, y) % 64; }
  void add_all() {
    std::fill(bits_.begin(), bits_.end(), ~std::uint64_t{0});
    if (const std::size_t last = std::size_t{width_} * height_ % 64; last != 0) {
      bits_.back() = (std::uint64_t{1} << last) - 1;
    }
  }
  /// Takes the pixels of another set of this size away.
  void remove(const PixelSet& other) {
    for (std::size_t i = 0; i < bits_.size(); ++i) {
      bits_[i] &= ~other.bits_[i];
    }
  }
  [[nodiscard]] std::uint64_t count() const {
    std::uint64_t pixels = 0;
    for (const std::uint64_t bits : bits_) {
      pixels += static_cast<std::uint64_t>(std::popcount(bits));
    }
    return pixels;
  }

 private:
  [[nodiscard]] std::size_t at(std::uint32_t x, std::uint32_t y) const { return std::size_t{y} * width_ + x; }

  std::uint32_t width_;
  std::uint32_t height_;
  std::vector<std::uint64_t> bits_;  // row by row; those after the last pixel are 0
};

}  // namespace marti::processors::program
