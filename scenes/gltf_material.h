// Internal to scenes/: converts glTF materials and textures when they are first used.
#pragma once

#include <array>
#include <compare>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "scenes/gltf_model.h"
#include "scenes/image_file.h"
#include "scenes/scene.h"
#include "scenes/scene_notes.h"
#include "scenes/texture.h"

namespace marti::scenes::gltf {

/// Member `key` of an object as a number; std::nullopt if it is not one.
[[nodiscard]] std::optional<double> number_in(const tinygltf::Value& object, const char* key);

/// The index that member `key` of an object holds, a whole number from 0 to below 1e9; std::nullopt where
/// there is no such member or it holds something else.
[[nodiscard]] std::optional<int> index_in(const tinygltf::Value& object, const char* key);

/// Member `key` of an object as three numbers of `lowest` to `highest`; std::nullopt if it is not that.
[[nodiscard]] std::optional<glm::dvec3> color_in(const tinygltf::Value& object, const char* key,
                                                 double lowest, double highest);

/// The `extras.marti` object, or nullptr.
[[nodiscard]] const tinygltf::Value* own_extras(const tinygltf::Value& extras);

/// What KHR_texture_transform does to texture coordinates.
struct TextureTransform {
  /// (u, v) becomes (u m0 + v m2 + m4, u m1 + v m3 + m5).
  std::array<double, 6> m{1.0, 0.0, 0.0, 1.0, 0.0, 0.0};

  [[nodiscard]] glm::dvec2 operator()(const glm::dvec2& uv) const {
    return {uv.x * m[0] + uv.y * m[2] + m[4], uv.x * m[1] + uv.y * m[3] + m[5]};
  }
  auto operator<=>(const TextureTransform&) const = default;
};

class Materials {
 public:
  Materials(const Model& model, const ImageDecoder& decode, Scene& scene, LeftOut& left_out)
      : model_(model), decode_(decode), scene_(scene), left_out_(left_out) {}

  struct Use {
    std::uint32_t material = 0;    ///< index into Scene::materials
    int texture_coordinates = -1;  ///< the TEXCOORD set that its texture needs, -1 if none
    TextureTransform transform;    ///< of these
  };
  /// The material of a primitive; -1 is glTF's default material.
  Use use(int index);

  /// Number of the file's materials in use.
  [[nodiscard]] std::uint64_t used() const { return used_.size() - (used_.contains(-1) ? 1U : 0U); }
  /// The file's images in use, by index.
  [[nodiscard]] const std::set<int>& used_images() const { return images_; }
  /// Decodes an image that the scene does not use, to check it.
  void check_image(int image) const;

 private:
  Material convert(int index, Use& use);
  [[nodiscard]] CutOut cut_out_of(const tinygltf::Material& source, std::uint32_t texture,
                                  const std::string& name) const;
  [[nodiscard]] TextureTransform transform_of(const tinygltf::Value& given, const std::string& user) const;
  std::uint32_t texture_index(int texture, const std::string& user);
  /// The first image in use with the same bytes, so that equal images are decoded once and share a texture.
  int first_alike(int image, const std::string& user);
  [[nodiscard]] ImageFile find_image(int image, const std::string& user) const;

  const Model& model_;
  const ImageDecoder& decode_;
  Scene& scene_;
  LeftOut& left_out_;
  std::map<int, Use> used_;
  std::set<int> images_;
  std::map<std::pair<const std::byte*, std::size_t>, int> image_at_;  // so that shared bytes are hashed once
  std::unordered_map<std::string_view, int> image_of_bytes_;          // of the model's buffers
  std::uint64_t compared_ = 0;                                        // bytes of different images
  std::map<std::tuple<int, int, int>, std::uint32_t> textures_;       // by image and wrap modes
};

}  // namespace marti::scenes::gltf
