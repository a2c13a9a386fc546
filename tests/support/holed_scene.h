// Triangles with holes, and which of their hits count, found for each triangle by itself.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "accel/brute_force.h"
#include "scenes/scene.h"

namespace marti::test {

/// The texture of holed(): alphas of 0, 127, 128 and 255, in no order.
inline scenes::Texture holed_texture(std::uint32_t width, std::uint32_t height, bool repeats) {
  scenes::Texture texture;
  texture.width = width;
  texture.height = height;
  texture.repeat_u = texture.repeat_v = repeats;
  std::uint32_t state = 12345;
  for (std::uint32_t texel = 0; texel < width * height; ++texel) {
    state = state * 1664525 + 1013904223;
    const std::uint8_t alpha[4] = {0, 127, 128, 255};
    texture.texels.push_back({200, 100, 50, alpha[state >> 30U]});
  }
  return texture;
}

/// Gives a scene of triangles four materials in turns: an opaque one, one cut out at a half, one at nearly
/// all of a mask of greys, one of a texture that lets nothing through. Coordinates go beyond the textures.
inline scenes::Scene holed(scenes::Scene scene) {
  for (std::uint32_t i = 0; i < 3; ++i) {
    scene.textures.push_back(holed_texture(3 + 2 * i, 7 - i, i != 1));
  }
  scene.textures[1].grey_is_alpha = true;
  for (std::array<std::uint8_t, 4>& texel : scene.textures[1].texels) {
    texel = {texel[3], texel[3], texel[3], 255};
  }
  for (std::array<std::uint8_t, 4>& texel : scene.textures[2].texels) {
    texel[3] = 255;
  }
  const std::uint32_t first = static_cast<std::uint32_t>(scene.materials.size());
  for (std::uint32_t i = 0; i < 4; ++i) {
    scenes::Material material = scene.materials.empty() ? scenes::Material() : scene.materials.front();
    if (i > 0) {
      material.cut_out = {i == 2 ? 0.9 : 1.0, i == 2 ? 0.85 : 0.5, i - 1};
      material.texture = i == 2 ? scenes::no_texture : i - 1;
    }
    scene.materials.push_back(material);
  }
  scene.uvs.clear();
  for (const glm::dvec3& p : scene.positions) {
    scene.uvs.emplace_back(1.7 * p.x + 0.3 * p.z, 2.3 * p.y - 0.9 * p.z);
  }
  for (std::uint32_t id = 0; id < scene.triangles.size(); ++id) {
    scene.triangles[id].material = first + id % 4;
  }
  return scene;
}

/// Whether a hit of a triangle counts, written from what a texture is.
inline bool counts(const scenes::Scene& scene, const accel::Hit& hit) {
  const scenes::Triangle& triangle = scene.triangles[hit.primitive];
  const scenes::CutOut& holes = scene.materials[triangle.material].cut_out;
  if (holes.texture == scenes::no_texture) {
    return true;
  }
  const scenes::Texture& texture = scene.textures[holes.texture];
  const auto place = [&](int axis, std::uint32_t size, bool repeats) {
    const double at = hit.u * scene.uvs[triangle.vertex[0]][axis] +
                      hit.v * scene.uvs[triangle.vertex[1]][axis] +
                      hit.w * scene.uvs[triangle.vertex[2]][axis];
    const double in = (repeats ? at - std::floor(at) : at) * size;
    return static_cast<std::uint32_t>(std::fmin(std::fmax(std::floor(in), 0.0), size - 1.0));
  };
  const auto& texel = texture.texels[place(1, texture.height, texture.repeat_v) * texture.width +
                                     place(0, texture.width, texture.repeat_u)];
  return holes.alpha * (texture.grey_is_alpha ? texel[0] : texel[3]) >= 255.0 * holes.cutoff;
}

/// Asks each triangle by itself, without its holes, and takes the nearest hit that counts.
class NaiveHoles {
 public:
  explicit NaiveHoles(const scenes::Scene& scene) : scene_(scene) {
    const accel::TriangleSet all(scene);
    for (std::uint32_t id = 0; id < all.size(); ++id) {
      each_.emplace_back(std::make_shared<accel::TriangleSet>(std::vector{all[id]}));
    }
  }
  /// Also counts, of the hits that are the best so far when the triangles are asked one after the other,
  /// those of triangles that may have holes.
  [[nodiscard]] accel::Hit closest(const accel::Ray& ray) {
    accel::Hit best;
    for (std::uint32_t id = 0; id < each_.size(); ++id) {
      accel::NullVisitor visitor;
      accel::Hit hit = each_[id].closest(ray, visitor);
      if (!hit.found() || !(hit.t < best.t)) {
        continue;
      }
      hit.primitive = id;
      asked += id % 4 == 1 || id % 4 == 2 ? 1 : 0;
      best = counts(scene_, hit) ? hit : best;
    }
    return best;
  }

  std::uint64_t asked = 0;

 private:
  const scenes::Scene& scene_;
  std::vector<accel::BruteForce> each_;
};

}  // namespace marti::test
