// Which packets of a frame are traced and timed in place of all of them.
//
// The packets, in the order in which the host hands them out, are cut into windows of equal length, long
// enough for every node to have a packet of each, so that nodes contend as they do in the frame. The windows
// are cut into strata, and two windows of each stratum are drawn: two are the fewest that show how windows of
// a stratum differ. Beside the windows a lattice of pixels is traced all over the image. It tells how much
// work the frame and each of its packets are, and takes the nodes' caches from one window to the next.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "processors/machine/packets.h"
#include "processors/program/pixel_set.h"
#include "processors/walk/observer.h"

namespace marti::studies::estimate {

/// A stratum: the units first .. end - 1, of which the chosen ones are in the sample.
struct Stratum {
  std::uint64_t first = 0;
  std::uint64_t end = 0;
  std::vector<std::uint64_t> chosen;  ///< ascending
  [[nodiscard]] std::uint64_t size() const { return end - first; }
};

/// Whether every unit is in the sample.
[[nodiscard]] bool all_chosen(std::span<const Stratum> strata);

/// Cuts units 0 .. units - 1 into `count` strata of nearly equal size and draws two units of each at random;
/// all of a stratum that has fewer. With twice the strata, and the same seed, all units that were drawn
/// before are drawn again. `count` is from 1 to `units`.
[[nodiscard]] std::vector<Stratum> draw_strata(std::uint64_t units, std::uint64_t count, std::uint64_t seed);

class PacketWindows {
 public:
  /// `length`: packets of a window, at least 1; the last window has up to twice as many less one. A window is
  /// as long as the frame when that has fewer packets. `strata`: how many are wanted; halved until there are
  /// at most half as many as windows, but at least one.
  PacketWindows(const processors::machine::PacketList& packets, std::uint64_t length, std::uint64_t strata,
                std::uint64_t seed);

  [[nodiscard]] std::uint64_t windows() const { return windows_; }
  [[nodiscard]] std::uint64_t drawn() const { return 2 * strata_.size(); }   ///< of windows()
  [[nodiscard]] std::span<const Stratum> strata() const { return strata_; }  ///< of windows
  [[nodiscard]] std::uint64_t first(std::uint64_t window) const { return window * length_; }
  [[nodiscard]] std::uint64_t end(std::uint64_t window) const {
    return window + 1 == windows_ ? packets_.size() : (window + 1) * length_;
  }
  [[nodiscard]] const processors::machine::PacketList& packets() const { return packets_; }
  /// Calls use(window) for each window drawn, ascending.
  template <class Use>
  void for_each_drawn(const Use& use) const {
    for (const Stratum& stratum : strata_) {
      for (const std::uint64_t window : stratum.chosen) {
        use(window);
      }
    }
  }
  /// The packets of the windows drawn, ascending.
  [[nodiscard]] std::vector<std::uint64_t> chosen() const;
  [[nodiscard]] bool has_all() const { return all_chosen(strata_); }

  /// Adds all pixels of the windows drawn.
  void add_to(processors::program::PixelSet& pixels) const;

 private:
  processors::machine::PacketList packets_;
  std::uint64_t length_;
  std::uint64_t windows_;
  std::vector<Stratum> strata_;
};

/// Pixels at equal distances in both directions.
class PixelLattice {
 public:
  /// From a pixel to the next: one pixel of 64 is traced, and a packet of the usual 8 x 8 has one.
  static constexpr std::uint32_t step = 8;

  PixelLattice(std::uint32_t width, std::uint32_t height);

  void add_to(processors::program::PixelSet& pixels) const;
  /// Row by row.
  [[nodiscard]] std::vector<processors::walk::PixelPlace> pixels() const;
  /// The index, in pixels(), of the one next to a pixel of the image.
  [[nodiscard]] std::size_t next_to(std::uint32_t x, std::uint32_t y) const {
    return std::size_t{std::min(y / step, rows_ - 1)} * columns_ + std::min(x / step, columns_ - 1);
  }
  /// Half of the 95 % interval of the sum over all the image's pixels, by `values`, which are those of
  /// pixels(). The variance of a systematic sample is estimated by the differences of neighbours (K. M.
  /// Wolter, "Introduction to variance estimation", 2nd ed. 2007, section 8.2). Infinite for a single pixel.
  [[nodiscard]] double half_width(std::span<const double> values) const;

 private:
  std::uint32_t width_;
  std::uint32_t height_;
  std::uint32_t columns_;
  std::uint32_t rows_;
};

/// Calls use(x, y) for each pixel of a packet.
template <class Use>
void for_each_pixel(const processors::machine::Packet& packet, const Use& use) {
  for (std::uint32_t y = packet.y0; y < packet.y1; ++y) {
    for (std::uint32_t x = packet.x0; x < packet.x1; ++x) {
      use(x, y);
    }
  }
}

}  // namespace marti::studies::estimate
