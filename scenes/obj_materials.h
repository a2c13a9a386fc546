// Internal to scenes/: the materials of an OBJ file, converted when they are first used. scenes/obj.h says
// how.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "scenes/file_access.h"
#include "scenes/mtl.h"
#include "scenes/scene.h"
#include "scenes/scene_notes.h"
#include "scenes/source_file.h"
#include "scenes/text_lines.h"
#include "scenes/texture.h"

namespace marti::scenes {

class ObjMaterials {
 public:
  /// All must outlive this object.
  ObjMaterials(const SourceFile& file, const ImageDecoder& decode, Scene& scene, LeftOut& left_out);

  /// Reads the libraries of a statement mtllib: one file whose name has blanks, or several.
  void add_libraries(const TextLines& statement);
  /// Takes the material of a statement usemtl for the faces that follow; the default one if no library has
  /// it.
  void choose(const TextLines& statement);
  /// The scene's material for a face.
  [[nodiscard]] std::uint32_t current();

  [[nodiscard]] std::uint64_t known() const { return known_.size(); }
  /// How many of them are in use.
  [[nodiscard]] std::uint64_t used() const { return used_; }
  /// Decodes the textures of the others, to check them.
  void check_unused();

 private:
  struct Known {
    MtlMaterial source;
    std::string folder;  ///< of its library
    std::optional<std::uint32_t> in_scene;
  };
  void add_library(const std::string& name, const TextLines& statement);
  /// The bytes of a file in the scene's folder; std::nullopt, and `reason` says why, if it cannot be read.
  /// Throws UserError for one elsewhere and one that is too large.
  std::optional<std::string> bytes_of(const std::string& path, const std::string& place, std::string& reason);
  void check_image(const std::string& folder, const MtlMap& map);
  [[nodiscard]] Material convert(const Known& known);
  /// `grey_is_alpha`: as Texture::grey_is_alpha.
  [[nodiscard]] std::uint32_t texture_of(const Known& known, const MtlMap& map, bool grey_is_alpha);
  [[nodiscard]] CutOut cut_out_of(const Known& known, double opacity);

  const SourceFile& file_;
  const ImageDecoder& decode_;
  Scene& scene_;
  LeftOut& left_out_;
  FileAccess access_;
  std::set<std::string> libraries_;
  std::vector<Known> known_;
  std::map<std::string, std::size_t, std::less<>> by_name_;
  std::optional<std::size_t> chosen_;
  std::optional<std::uint32_t> default_material_;
  std::uint64_t used_ = 0;
  std::map<std::tuple<std::string, bool, bool>, std::uint32_t> textures_;  // by file, MtlMap::clamp, alpha
};

}  // namespace marti::scenes
