#include "studies/run/plan/needs.h"

#include <algorithm>

#include "processors/program/path_sampling.h"
#include "processors/program/shading.h"
#include "studies/run/plan/view.h"

namespace marti::studies::run {

namespace {

using processors::program::is_black;

bool is_path(const processors::program::RenderOptions& options) {
  return options.integrator == processors::program::Integrator::path;
}

bool transmits(const scenes::Material& material) { return material.transmission > 0.0; }

// Finds out step by step; a step may use what the ones before it have found.
class Finder {
 public:
  Finder(const scenes::Scene& scene, const processors::program::RenderOptions& options)
      : scene_(scene),
        options_(options),
        everything_(options.voxel_cut > 0.0),
        in_view_(scene.triangles.size() + scene.quadrics.size()) {
    if (processors::program::asks_emitters(options.integrator)) {
      emitters_ = processors::program::Emitters(scene);
    }
  }

  SceneNeeds find() {
    find_shading();
    find_cut_outs();
    return needs_;
  }

 private:
  void find_shading() {
    if (options_.integrator == processors::program::Integrator::rays) {
      needs_.primitives = in_view_.size();
      needs_.materials.resize(scene_.materials.size());
      needs_.textures.resize(scene_.textures.size());
      return;  // given rays shade nothing
    }
    if (options_.integrator == processors::program::Integrator::gaussians) {
      needs_.primitives = in_view_.size();
      needs_.materials.assign(scene_.materials.size(), true);
      needs_.textures.resize(scene_.textures.size());
      needs_.refraction_rays = true;
      return;  // Gaussians have light of their own
    }
    find_materials();
    find_rays();
    if (processors::program::sends_any_hit_rays(options_.integrator)) {
      only_any_hit_rays();
      return;
    }
    find_textures();
    find_normals();
  }

  // Whatever rays are for, they are asked whether their hits count.
  void find_cut_outs() {
    for (const scenes::Material& material : scene_.materials) {
      if (material.cut_out.asks() && !scene_.uvs.empty()) {
        needs_.textures[material.cut_out.texture] = true;
        needs_.coordinates = true;
        ++needs_.cut_out;
      }
    }
  }

  // Surfaces have neither colour nor material for the rays of which any hit will do; lights have a side.
  void only_any_hit_rays() {
    const bool shadows = options_.integrator == processors::program::Integrator::shadow;
    needs_.textures.resize(scene_.textures.size());
    needs_.unlit = 0;
    needs_.shadow_rays = !shadows || needs_.shining_lights > 0;
    for (std::uint32_t id = 0; id < scene_.triangles.size() && !scene_.normals.empty(); ++id) {
      needs_.smooth += shadows && in_view_[id] ? 1U : 0U;
    }
    needs_.normals = needs_.smooth > 0;
  }

  // An average may reflect although one of its materials is black and another has no weight.
  [[nodiscard]] bool reflects(const scenes::Material& material) const {
    return material.reflection > 0.0 && (everything_ || !is_black(material.specular_color));
  }

  // Light that arrives anywhere is scattered on.
  [[nodiscard]] bool sends_scattered(const scenes::Material& material) const {
    return is_path(options_) && processors::program::scatters(material);
  }

  void find_materials() {
    scenes::ImagePlane plane = processors::program::image_plane(scene_.camera, options_);
    if (options_.window) {
      const processors::program::Window& window = *options_.window;
      plane.corner +=
          plane.step_x * static_cast<double>(window.left) + plane.step_y * static_cast<double>(window.top);
    }
    const View view(plane, options_.width, options_.height, options_.samples > 1);
    std::vector<bool> listed(scene_.materials.size());
    std::vector<bool> seen(scene_.materials.size());
    needs_.primitives = in_view_.size();
    for (std::uint32_t id = 0; id < in_view_.size(); ++id) {
      const std::uint32_t material = scenes::material_of(scene_, id);
      listed[material] = true;
      if (everything_ || !scene_.instances.empty() || view.may_meet(scene_, id)) {
        in_view_[id] = true;
        seen[material] = true;
      }
    }
    const bool deep = options_.max_depth > 1;
    const auto sends = [&](std::size_t i) {
      const scenes::Material& material = scene_.materials[i];
      return deep && seen[i] && (reflects(material) || transmits(material) || sends_scattered(material));
    };
    for (std::size_t i = 0; i < seen.size() && !secondary_; ++i) {
      secondary_ = sends(i);
    }
    needs_.materials = secondary_ ? listed : seen;
    for (std::uint32_t id = 0; id < scene_.triangles.size() && !emitters_.empty(); ++id) {
      if (emitters_.has(id)) {
        needs_.materials[scene_.triangles[id].material] = true;
      }
    }
  }

  void find_rays() {
    for (std::size_t i = 0; i < scene_.materials.size(); ++i) {
      const scenes::Material& material = scene_.materials[i];
      if (!needs_.materials[i]) {
        needs_.reflecting_beside += reflects(material) ? 1U : 0U;
        needs_.transmitting_beside += transmits(material) ? 1U : 0U;
        continue;
      }
      ++needs_.shaded;
      needs_.reflecting += reflects(material) ? 1U : 0U;
      needs_.transmitting += transmits(material) ? 1U : 0U;
      needs_.diffuse_rays = needs_.diffuse_rays || (options_.max_depth > 1 && sends_scattered(material));
      const bool asks = processors::program::asks_lights(material);
      const bool shows = everything_ ? asks : processors::program::shows_light(material);
      needs_.unlit += asks && !shows ? 1U : 0U;
      shows_ = shows_ || shows;
    }
    const bool deep = options_.max_depth > 1;
    needs_.refraction_rays = deep && needs_.transmitting > 0;
    // At total internal reflection what would be refracted is reflected.
    needs_.reflection_rays = deep && (needs_.reflecting > 0 || needs_.transmitting > 0);
    needs_.lights = scene_.lights.size();
    for (const scenes::Light& light : scene_.lights) {
      needs_.shining_lights += is_black(light.color) ? 0U : 1U;
    }
    if (!emitters_.empty()) {
      ++needs_.lights;
      ++needs_.shining_lights;
    }
    needs_.shadow_rays = options_.shadows && shows_ && needs_.shining_lights > 0;
  }

  void find_textures() {
    needs_.textures.resize(scene_.textures.size());
    const bool any_light = needs_.shining_lights > 0 || !is_black(scene_.ambient) || is_path(options_);
    for (std::size_t i = 0; i < scene_.materials.size() && !scene_.uvs.empty(); ++i) {
      const scenes::Material& material = scene_.materials[i];
      if (!needs_.materials[i] || material.texture == scenes::no_texture) {
        continue;
      }
      ++needs_.textured;
      needs_.coordinates = true;
      // The colour of a texel is multiplied by the material's and goes into diffuse and ambient light alone.
      if (everything_ || (any_light && material.diffuse > 0.0 && !is_black(material.color))) {
        needs_.textures[material.texture] = true;
      }
    }
  }

  [[nodiscard]] bool uses_normal(const scenes::Material& material) const {
    const bool lit = needs_.shining_lights > 0 && processors::program::asks_lights(material);
    return lit || (options_.max_depth > 1 &&
                   (reflects(material) || transmits(material) || sends_scattered(material)));
  }

  void find_normals() {
    for (std::uint32_t id = 0; id < scene_.triangles.size() && !scene_.normals.empty(); ++id) {
      const scenes::Triangle& triangle = scene_.triangles[id];
      if (!(in_view_[id] || secondary_) ||
          !(everything_ || uses_normal(scene_.materials[triangle.material]))) {
        continue;
      }
      ++needs_.smooth;
    }
    needs_.normals = needs_.smooth > 0;
  }

  const scenes::Scene& scene_;
  const processors::program::RenderOptions& options_;
  bool everything_;
  processors::program::Emitters emitters_;  // wherever they are, points in view ask them for light
  std::vector<bool> in_view_;
  bool secondary_ = false;
  bool shows_ = false;
  SceneNeeds needs_;
};

}  // namespace

SceneNeeds needs_of(const scenes::Scene& scene, const processors::program::RenderOptions& options) {
  return Finder(scene, options).find();
}

}  // namespace marti::studies::run
