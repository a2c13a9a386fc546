// What each pixel cost: time, misses and waiting, added up while a replay is watched.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "processors/program/image.h"
#include "processors/walk/observer.h"

namespace marti::studies::run {

/// The three figures of a pixel. Time that belongs to no pixel (waiting for a packet, building before the
/// frame, idling) is not counted.
enum class Heat : std::uint8_t {
  /// All time that nodes spent for it: working and waiting. Of a SIMT node that of the lanes that worked for
  /// it or waited with its ray, but not of those that others of their warp held up.
  cycles,
  misses,  ///< references that missed the node's cache
  waits,   ///< the part of `cycles` in which nothing was computed or tested for it
};
inline constexpr std::size_t heats = 3;
inline constexpr std::array<std::string_view, heats> heat_names = {"cycles", "misses", "waits"};

class HeatMap final : public processors::walk::Observer {
 public:
  /// Bytes of the computer's memory that recording and writing maps of so many pixels takes, roughly.
  [[nodiscard]] static std::uint64_t host_bytes(std::uint64_t pixels) { return 64 * pixels; }

  void begin(const processors::walk::ReplayInput& input) override;
  void spent(std::uint32_t node, processors::walk::NodeState state, sim::Ticks from, sim::Ticks to,
             processors::walk::PixelPlace pixel) override;
  void missed(std::uint32_t node, std::int64_t misses, processors::walk::PixelPlace pixel) override;

  [[nodiscard]] bool hears_lanes() const override { return true; }
  void lane_spent(bool working, sim::Ticks time, processors::walk::PixelPlace pixel) override {
    spent(0, working ? processors::walk::NodeState::working : processors::walk::NodeState::memory, 0, time,
          pixel);
  }

  [[nodiscard]] std::uint32_t width() const { return width_; }
  [[nodiscard]] std::uint32_t height() const { return height_; }
  /// Pixels row by row from the top: ticks, misses, ticks.
  [[nodiscard]] const std::vector<std::int64_t>& values(Heat heat) const {
    return values_[static_cast<std::size_t>(heat)];
  }
  /// Like values(), but times are in cycles of the nodes' clock.
  [[nodiscard]] std::vector<float> figures(Heat heat) const;

 private:
  [[nodiscard]] std::size_t index(processors::walk::PixelPlace pixel) const {
    return std::size_t{pixel.y} * width_ + pixel.x;
  }

  std::uint32_t width_ = 0;
  std::uint32_t height_ = 0;
  sim::Ticks period_ = 1;
  std::array<std::vector<std::int64_t>, heats> values_;
};

/// What the colours of a map stand for: 0 is the darkest, `brightest` and all above it the brightest.
struct Legend {
  double brightest = 0.0;  ///< 99 of 100 pixels lie at or below it
  double largest = 0.0;
  double mean = 0.0;
};

[[nodiscard]] Legend legend_of(const std::vector<float>& figures);

/// A map in false colours. All black-blue when every figure is 0.
[[nodiscard]] processors::program::Image false_colour(const std::vector<float>& figures, std::uint32_t width,
                                                      std::uint32_t height, const Legend& legend);

}  // namespace marti::studies::run
