// Internal to scenes/: Wavefront's material libraries (.mtl; Object Files and Material Library File Format,
// Alias | Wavefront 4.2, 1995), as values of the file.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

#include "scenes/scene_notes.h"

namespace marti::scenes {

/// An image of a material.
struct MtlMap {
  std::string file;    ///< its name; empty: none
  std::string place;   ///< "FILE:LINE" of the statement
  bool clamp = false;  ///< -clamp on: it does not repeat
  bool matte = false;  ///< -imfchan m: its alpha counts, not its colours
};

/// The values of one material; those that are not given are as the format says or, where it says nothing,
/// those of a matt grey one.
struct MtlMaterial {
  std::string name;
  std::string place;                   ///< "FILE:LINE" of its newmtl
  glm::dvec3 diffuse{0.8};             ///< Kd
  glm::dvec3 specular{0.0};            ///< Ks
  glm::dvec3 emission{0.0};            ///< Ke
  std::optional<glm::dvec3> filter;    ///< Tf
  double exponent = 1.0;               ///< Ns
  double ior = 1.0;                    ///< Ni
  std::optional<double> opacity;       ///< d
  std::optional<double> transparency;  ///< Tr
  std::int64_t illumination = 2;       ///< illum
  MtlMap texture;                      ///< map_Kd
  MtlMap opacity_map;                  ///< map_d
};

/// Reads a library; `name` is the file's in messages. Throws UserError, "FILE:LINE: reason", for statements
/// that the format does not have and values out of range. Counts in `left_out` the statements that marti has
/// no use for, and what is replaced: materials and textures without a name, options that other programs have.
[[nodiscard]] std::vector<MtlMaterial> read_mtl(std::string_view text, const std::string& name,
                                                LeftOut& left_out);

}  // namespace marti::scenes
