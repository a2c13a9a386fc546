#include "studies/run/record/colour_scale.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace marti::studies::run {

namespace {

// sRGB, at equal distances.
constexpr std::array<std::uint32_t, 11> scale = {0x440154, 0x482374, 0x404387, 0x345e8d, 0x29788e, 0x20908c,
                                                 0x22a784, 0x44be70, 0x79d151, 0xbdde26, 0xfde724};

// IEC 61966-2-1.
float linear(double encoded) {
  return static_cast<float>(encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4));
}

}  // namespace

glm::vec3 colour_of(double share) {
  const double at = std::clamp(share, 0.0, 1.0) * static_cast<double>(scale.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(at), scale.size() - 2);
  const double weight = at - static_cast<double>(below);
  const auto channel = [&](unsigned shift) {
    const auto of = [&](std::uint32_t colour) { return static_cast<double>((colour >> shift) & 0xffU); };
    return linear((of(scale[below]) * (1.0 - weight) + of(scale[below + 1]) * weight) / 255.0);
  };
  return {channel(16), channel(8), channel(0)};
}

}  // namespace marti::studies::run
