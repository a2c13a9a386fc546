#include "studies/run/scene_hash.h"

#include <bit>

namespace marti::studies::run {

namespace {

class Hash {
 public:
  void add(std::uint64_t word) {
    for (int byte = 0; byte < 8; ++byte) {
      hash_ = (hash_ ^ (word & 0xffU)) * 0x100000001b3ULL;
      word >>= 8U;
    }
  }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  template <class Vector>
  void add_vector(const Vector& vector) {
    for (int i = 0; i < Vector::length(); ++i) {
      add(vector[i]);
    }
  }
  [[nodiscard]] std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325ULL;
};

void add(Hash& hash, const scenes::Material& material) {
  hash.add_vector(material.color);
  hash.add_vector(material.specular_color);
  hash.add_vector(material.emission);
  for (const double value : {material.diffuse, material.reflection, material.transmission, material.ior,
                             material.highlight, material.shininess}) {
    hash.add(value);
  }
  hash.add(std::uint64_t{material.texture});
  if (const scenes::CutOut& cut_out = material.cut_out; cut_out.asks()) {
    hash.add(cut_out.alpha);
    hash.add(cut_out.cutoff);
    hash.add(std::uint64_t{cut_out.texture});
  }
}

void add(Hash& hash, const scenes::Texture& texture) {
  hash.add(std::uint64_t{texture.width});
  hash.add(std::uint64_t{texture.height});
  hash.add(std::uint64_t{(texture.srgb ? 1U : 0U) | (texture.repeat_u ? 2U : 0U) |
                         (texture.repeat_v ? 4U : 0U) | (texture.grey_is_alpha ? 8U : 0U)});
  for (const auto& texel : texture.texels) {
    hash.add(std::uint64_t{std::bit_cast<std::uint32_t>(texel)});
  }
}

void add(Hash& hash, const scenes::Quadric& quadric) {
  hash.add(static_cast<std::uint64_t>(quadric.kind));
  hash.add_vector(quadric.base);
  hash.add_vector(quadric.tip);
  hash.add(quadric.radius);
  hash.add(quadric.tip_radius);
  hash.add(std::uint64_t{quadric.material});
}

void add(Hash& hash, const scenes::Light& light) {
  hash.add(static_cast<std::uint64_t>(light.kind));
  hash.add_vector(light.position);
  hash.add_vector(light.direction);
  hash.add_vector(light.color);
  hash.add(std::uint64_t{light.inverse_square ? 1U : 0U});
  for (const double value : {light.range, light.cos_inner_cone, light.cos_outer_cone}) {
    hash.add(value);
  }
}

}  // namespace

std::uint64_t scene_hash(const scenes::Scene& scene) {
  Hash hash;
  hash.add(std::uint64_t{scene.positions.size()});
  for (const glm::dvec3& position : scene.positions) {
    hash.add_vector(position);
  }
  for (const glm::dvec3& normal : scene.normals) {
    hash.add_vector(normal);
  }
  for (const glm::dvec2& uv : scene.uvs) {
    hash.add_vector(uv);
  }
  hash.add(std::uint64_t{scene.triangles.size()});
  for (const scenes::Triangle& triangle : scene.triangles) {
    for (const std::uint32_t vertex : triangle.vertex) {
      hash.add(std::uint64_t{vertex});
    }
    hash.add(std::uint64_t{triangle.material});
  }
  for (const scenes::PrimitiveRange& mesh : scene.meshes) {
    hash.add(std::uint64_t{mesh.first});
    hash.add(std::uint64_t{mesh.count});
  }
  for (const scenes::InstancePlace& place : scene.instances) {
    hash.add(std::uint64_t{place.mesh});
    for (const glm::dvec3& vector : {place.linear[0], place.linear[1], place.linear[2], place.shift}) {
      hash.add_vector(vector);
    }
  }
  hash.add(std::uint64_t{scene.quadrics.size()});
  for (const scenes::Quadric& quadric : scene.quadrics) {
    add(hash, quadric);
  }
  for (const scenes::Material& material : scene.materials) {
    add(hash, material);
  }
  for (const scenes::Texture& texture : scene.textures) {
    add(hash, texture);
  }
  for (const scenes::Light& light : scene.lights) {
    add(hash, light);
  }
  for (const glm::dvec3& vector :
       {scene.camera.eye, scene.camera.at, scene.camera.up, scene.background, scene.ambient}) {
    hash.add_vector(vector);
  }
  hash.add(scene.camera.vertical_fov);
  for (std::size_t i = 0; i < scene.rays.rays.size(); ++i) {
    const scenes::GivenRay& ray = scene.rays.rays[i];
    hash.add_vector(ray.origin);
    hash.add_vector(ray.direction);
    hash.add(ray.least);
    hash.add(ray.greatest);
    hash.add(std::uint64_t{scene.rays.wants_any(i) ? 1U : 0U});
  }
  return hash.value();
}

}  // namespace marti::studies::run
