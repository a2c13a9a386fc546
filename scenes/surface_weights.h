// Internal to scenes/: physically based materials as weights of Whitted's model.
#pragma once

#include "scenes/scene.h"

namespace marti::scenes {

/// Sets the weights of a material, whose colour and index of refraction are set, as gltf.h says. All three
/// lie in 0 to 1; `roughness` is glTF's: the square root of the width of a microfacet distribution.
void set_surface_weights(Material& material, double metallic, double roughness, double transmission);

}  // namespace marti::scenes
