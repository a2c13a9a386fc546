#include "scenes/surface_weights.h"

#include <algorithm>

#include <glm/common.hpp>

namespace marti::scenes {

void set_surface_weights(Material& material, double metallic, double roughness, double transmission) {
  constexpr double largest_shininess = 1e5;
  const double root = (material.ior - 1.0) / (material.ior + 1.0);
  const double f0 = root * root;
  const double gloss = (1.0 - roughness) * (1.0 - roughness);
  const double dielectric = (1.0 - metallic) * (1.0 - gloss * f0);
  material.diffuse = dielectric * (1.0 - transmission) + metallic * (1.0 - gloss);
  material.reflection = gloss * (metallic + (1.0 - metallic) * f0);
  material.transmission = dielectric * transmission;
  material.highlight = metallic + (1.0 - metallic) * f0;
  const double r2 = roughness * roughness;
  material.shininess =
      r2 * r2 > 0.0 ? std::clamp(2.0 / (r2 * r2) - 2.0, 1.0, largest_shininess) : largest_shininess;
  material.specular_color = glm::mix(glm::dvec3(1.0), material.color, metallic);
}

}  // namespace marti::scenes
