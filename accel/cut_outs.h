// Triangles with holes: where the texture of a triangle says that it is cut out, a ray goes on through it.
//
// The kernel asks when it has found a hit that would be the best, and before the hit may shorten the ray
// (accept() in watertight.h), so every structure, walk and scalar gets the same answers. A triangle whose
// material is nowhere cut out is never asked about. An answer depends on the hit's barycentric weights alone,
// hence on the triangle and the ray, and not on the order in which triangles are tested.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>

#include "scenes/scene.h"

namespace marti::accel {

/// What a hit was asked for: its material, whose texture's texel decides; or a Gaussian.
struct AnyHit {
  std::uint32_t material = 0;  ///< or the first record of the Gaussian whose proxy was hit
  std::uint32_t texture = 0;   ///< scenes::no_texture for a Gaussian
  std::uint32_t texel = 0;
  bool counts = false;  ///< the triangle is not cut out there
};

/// Visitors that are told of each hit that was asked about, in order, while a leaf is tested: before leaf().
class AnyHitListener {
 public:
  virtual void any_hit(const AnyHit& hit) = 0;

 protected:
  ~AnyHitListener() = default;
};

/// The holes of a scene's triangles. Immutable; for any number of threads.
class CutOuts {
 public:
  /// Takes what it needs out of a valid scene: a bit for each texel, and coordinates of the triangles that
  /// may have holes.
  explicit CutOuts(const scenes::Scene& scene);

  /// Whether no triangle has holes.
  [[nodiscard]] bool empty() const { return triangles_.empty(); }
  [[nodiscard]] bool asks(std::uint32_t triangle) const { return place_[triangle] != opaque; }
  /// Of a triangle that is asked about, at a point with these barycentric weights.
  [[nodiscard]] AnyHit ask(std::uint32_t triangle, const std::array<double, 3>& weights) const;
  /// Bytes of host memory that those of a scene take at most.
  [[nodiscard]] static std::uint64_t host_bytes(const scenes::Scene& scene);

 private:
  static constexpr std::uint32_t opaque = 0xffffffffU;

  struct Mask {
    std::uint32_t material = 0;
    std::uint32_t texture = 0;
    scenes::Texture size;  ///< without texels: only the size and how it repeats
    std::vector<bool> kept;
  };
  struct Marked {
    std::uint32_t mask = 0;
    std::array<glm::dvec2, 3> uv{};
  };
  std::vector<Mask> masks_;
  std::vector<std::uint32_t> place_;  ///< of each triangle of the scene in triangles_, or `opaque`
  std::vector<Marked> triangles_;
};

}  // namespace marti::accel
