// What of a scene the rays of one frame may need.
//
// A camera's rays meet only what lies in the view. Shadow rays ask whether they meet anything and shade
// nothing. So as long as no material in view sends a reflected or a refracted ray, only the materials in view
// are shaded; as soon as one does, any may be. With Integrator::path scattering materials send rays too.
#pragma once

#include <cstdint>
#include <vector>

#include "processors/program/render.h"
#include "scenes/scene.h"

namespace marti::studies::run {

/// `primitives` and `lights` count all there are, needed or not.
struct SceneNeeds {
  std::uint64_t primitives = 0;
  std::vector<bool> materials;  ///< that may be shaded or asked for the light they emit, by index
  std::vector<bool> textures;   ///< whose texels may count in the image or let rays through, by index
  std::uint64_t lights = 0;
  /// With an intensity other than 0; with asks_emitters() also the emissive triangles, together one light.
  std::uint64_t shining_lights = 0;
  bool shadow_rays = false;  ///< some may be sent that can change the image
  bool reflection_rays = false;
  bool refraction_rays = false;
  bool diffuse_rays = false;
  bool coordinates =
      false;  ///< texture coordinates decide a texel: the work log keeps its number, or it is a hole
  bool normals = false;  ///< vertex normals can change something

  // Of the materials that may be shaded:
  std::uint64_t shaded = 0;
  std::uint64_t reflecting = 0;
  std::uint64_t transmitting = 0;
  std::uint64_t textured = 0;             ///< with texture coordinates to go with the texture
  std::uint64_t cut_out = 0;              ///< of all materials: cut out where a texture says so
  std::uint64_t unlit = 0;                ///< ask for lights, though none adds anything
  std::uint64_t reflecting_beside = 0;    ///< reflecting materials among those that may not be shaded
  std::uint64_t transmitting_beside = 0;  ///< transmitting materials among those that may not be shaded
  /// Triangles that may be shaded with the normals of their vertices. They count even if these equal the
  /// triangle's own normal or are not given: interpolating them at a point rounds.
  std::uint64_t smooth = 0;
};

/// With the voxel cut everything is needed: its averages are made of all materials and normals. With
/// Integrator::rays nothing is but the primitives.
[[nodiscard]] SceneNeeds needs_of(const scenes::Scene& scene,
                                  const processors::program::RenderOptions& options);

}  // namespace marti::studies::run
