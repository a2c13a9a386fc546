// How long data take in whole beats, for many sizes.
#pragma once

#include <algorithm>
#include <cstdint>

#include "sim/divider.h"
#include "sim/time.h"

namespace marti::memory {

/// For links and memories that move `width` bytes a beat of `beat` ticks. BeatTime (link.h) keeps the last
/// result instead, which suits transactions of one size.
class Beats {
 public:
  /// A width of 0 counts as 1: the owner refuses it.
  Beats(sim::Ticks beat, std::uint32_t width) : beat_(beat), width_(std::max(width, 1U)), beats_of_(width_) {}

  [[nodiscard]] sim::Ticks operator()(std::uint32_t bytes) const {
    return sim::multiply_ticks(beat_, static_cast<std::int64_t>(beats_of_(bytes + width_ - 1)));
  }

 private:
  sim::Ticks beat_;
  std::uint64_t width_;
  sim::Divider beats_of_;
};

}  // namespace marti::memory
