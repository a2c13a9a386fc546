// Internal to scenes/: colours and spectra of pbrt files as linear RGB.
#pragma once

#include <string_view>

#include <glm/vec3.hpp>

#include "scenes/pbrt_text.h"
#include "scenes/scene_notes.h"

namespace marti::scenes::pbrt {

/// The colour that a parameter gives, each channel 0 to `highest`; `otherwise` if it is not given or names a
/// texture.
///
/// A spectrum of wavelengths and values is averaged over 600 to 700, 500 to 600 and 400 to 500 nm; one of a
/// temperature is that of a black body (Kim et al., Design of Advanced Color Temperature Control System for
/// HDTV Applications, J. Korean Phys. Soc. 41, 2002) of luminance 1. Of spectra that have a name those of
/// metals and glasses are known (index_of_refraction(), metal_color()); others are white, and counted. Throws
/// UserError when the values are none of the type's, or out of range.
[[nodiscard]] glm::dvec3 color_in(const Parameters& parameters, std::string_view name,
                                  const glm::dvec3& otherwise, double highest, LeftOut& left_out);

/// A number, or that of a glass by its name ("glass-BK7"); 1.5 if it is not given. Refractive indices at
/// 587.6 nm (Schott, Optical Glass, data sheets).
[[nodiscard]] double index_of_refraction(const Parameters& parameters, LeftOut& left_out);

/// The reflectance of a conductor at normal incidence: `reflectance`, or that of the metal whose spectra
/// `eta` and `k` name, else by Fresnel's formula from both; copper if none is given, as in pbrt. Colours of
/// metals: S. Lagarde, Feeding a physically based shading model, 2011.
[[nodiscard]] glm::dvec3 metal_color(const Parameters& parameters, LeftOut& left_out);

}  // namespace marti::scenes::pbrt
