// Internal to scenes/: materials and textures of pbrt files as those of a scene.
//
// A material has the weights of gltf.h: diffuse ones of a rough dielectric without gloss, coated ones of a
// dielectric over its colour, conductors of a metal, dielectrics transmit all that they do not reflect. The
// roughness of gltf.h is the square root of the width that pbrt gives its microfacet distribution, the fourth
// root of `roughness` unless `remaproughness` is false. A material that pbrt mixes of two is the one of which
// there is more.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "scenes/pbrt_text.h"
#include "scenes/scene.h"
#include "scenes/scene_notes.h"
#include "scenes/source_file.h"
#include "scenes/texture.h"

namespace marti::scenes::pbrt {

class PbrtMaterials {
 public:
  /// All must outlive this object. Material 0 is pbrt's default, a diffuse grey of 0.5.
  PbrtMaterials(const SourceFile& file, Text& text, const ImageDecoder& decode, Scene& scene,
                LeftOut& left_out);

  /// Adds a material and gives its number.
  std::size_t add(std::string type, Parameters parameters);
  /// Gives a name to a material whose type is its parameter `type`.
  void add_named(const std::string& name, Parameters parameters);
  /// The number of the material with this name. Throws UserError when no material has it.
  [[nodiscard]] std::size_t named(const std::string& name) const;
  void add_texture(std::string name, std::string kind, Parameters parameters);

  /// Its place among the scene's materials when it emits so much light and has these holes; nothing for the
  /// surface of a medium, which no ray sees.
  [[nodiscard]] std::optional<std::uint32_t> in_scene(std::size_t material, const glm::dvec3& emission,
                                                      const CutOut& cut_out);
  /// The holes of a shape by its parameter `alpha`, a number or a texture, of which the mean of the colours
  /// counts. pbrt compares it with a random number for each ray; here a surface is where it is at least 0.5.
  [[nodiscard]] CutOut cut_out_of(const Parameters& shape);

  /// Parameters of textures in use that nothing has asked for. Call it when all shapes have been read.
  void leave_out_rest() const;

  [[nodiscard]] std::size_t known() const { return known_.size(); }
  [[nodiscard]] std::size_t used() const { return used_; }

 private:
  struct Known {
    std::string name;
    std::string type;
    Parameters parameters;
    /// By what it emits, and by alpha and texture of its holes.
    std::map<std::tuple<std::array<double, 3>, double, std::uint32_t>, std::uint32_t> in_scene;
  };
  struct KnownTexture {
    std::string kind;
    Parameters parameters;
    bool used = false;
  };
  struct Tint {
    glm::dvec3 color{1.0};
    std::uint32_t texture = no_texture;
  };

  [[nodiscard]] std::optional<Material> convert(const Known& known, int depth);
  [[nodiscard]] Tint tint(const Parameters& parameters, std::string_view name, const glm::dvec3& otherwise,
                          bool is_alpha, int depth = 0);
  [[nodiscard]] Tint texture(const std::string& name, const Parameters& by, bool is_alpha, int depth);
  [[nodiscard]] std::uint32_t image(const Parameters& parameters, bool is_alpha);
  [[nodiscard]] double roughness(const Parameters& parameters, double otherwise);

  const SourceFile& file_;
  Text& text_;
  const ImageDecoder& decode_;
  Scene& scene_;
  LeftOut& left_out_;
  std::vector<Known> known_;
  std::size_t used_ = 0;
  std::map<std::string, std::size_t> by_name_;
  std::map<std::string, KnownTexture> textures_;
  /// By file, wrap, encoding, and whether they are of holes.
  std::map<std::tuple<std::string, bool, bool, bool>, std::uint32_t> images_;
};

}  // namespace marti::scenes::pbrt
