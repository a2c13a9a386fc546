#include "accel/cut_outs.h"

#include <algorithm>
#include <utility>

#include "scenes/texture.h"

namespace marti::accel {

CutOuts::CutOuts(const scenes::Scene& scene) {
  std::vector<std::uint32_t> mask_of(scene.materials.size(), opaque);
  for (std::uint32_t i = 0; i < scene.materials.size() && !scene.uvs.empty(); ++i) {
    const scenes::CutOut& holes = scene.materials[i].cut_out;
    if (!holes.asks()) {
      continue;
    }
    const scenes::Texture& texture = scene.textures[holes.texture];
    Mask mask{i, holes.texture, {}, {}};
    mask.size.width = texture.width;
    mask.size.height = texture.height;
    mask.size.repeat_u = texture.repeat_u;
    mask.size.repeat_v = texture.repeat_v;
    mask.kept.resize(texture.size());
    for (std::uint64_t texel = 0; texel < texture.size(); ++texel) {
      mask.kept[texel] = holes.keeps(scenes::alpha_of(texture, static_cast<std::uint32_t>(texel)));
    }
    if (std::ranges::find(mask.kept, false) != mask.kept.end()) {
      mask_of[i] = static_cast<std::uint32_t>(masks_.size());
      masks_.push_back(std::move(mask));
    }
  }
  if (masks_.empty()) {
    return;
  }
  place_.assign(scene.triangles.size(), opaque);
  for (std::size_t id = 0; id < scene.triangles.size(); ++id) {
    const scenes::Triangle& triangle = scene.triangles[id];
    if (const std::uint32_t mask = mask_of[triangle.material]; mask != opaque) {
      const auto uv = [&](std::size_t corner) { return scene.uvs[triangle.vertex[corner]]; };
      place_[id] = static_cast<std::uint32_t>(triangles_.size());
      triangles_.push_back({mask, {uv(0), uv(1), uv(2)}});
    }
  }
}

AnyHit CutOuts::ask(std::uint32_t triangle, const std::array<double, 3>& weights) const {
  const Marked& marked = triangles_[place_[triangle]];
  const Mask& mask = masks_[marked.mask];
  const double weight[3] = {weights[0], weights[1], weights[2]};
  const std::uint32_t texel = scenes::nearest_texel(mask.size, scenes::mixed_uv(marked.uv, weight));
  return {mask.material, mask.texture, texel, mask.kept[texel]};
}

std::uint64_t CutOuts::host_bytes(const scenes::Scene& scene) {
  std::uint64_t masks = 0;
  for (const scenes::Material& material : scene.materials) {
    if (material.cut_out.asks()) {
      masks += sizeof(Mask) + scene.textures[material.cut_out.texture].size() / 8;
    }
  }
  return masks == 0 ? 0 : masks + scene.triangles.size() * (sizeof(std::uint32_t) + 2 * sizeof(Marked));
}

}  // namespace marti::accel
