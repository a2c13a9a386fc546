// A finished image in linear RGB, rows from the top.
#pragma once

#include <cstdint>

#include <glm/vec3.hpp>

#include "sim/large_pages.h"

namespace marti::processors::program {

struct Image {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  sim::LargeVector<glm::vec3> pixels;  ///< width * height

  [[nodiscard]] const glm::vec3& at(std::uint32_t x, std::uint32_t y) const {
    return pixels[static_cast<std::size_t>(y) * width + x];
  }
};

}  // namespace marti::processors::program
