// Internal to scenes/: placeholders for what glTF 2.0 allows to be missing and tinygltf does not: the buffer
// view of vertex indices (section 3.6.2.3: zeros that sparse values replace; or data compressed by an
// extension), and the bytes of a buffer that is only there compressed (EXT_meshopt_compression, "fallback").
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <tiny_gltf.h>

namespace marti::scenes::gltf {

struct Placeholders {
  std::string json;            ///< with the placeholders; empty if none is needed
  std::vector<int> accessors;  ///< those that got an arbitrary buffer view
  std::vector<int> buffers;    ///< those that got one byte
};

/// Finds the accessors that primitives use for indices and that have no buffer view, and the buffers without
/// bytes.
[[nodiscard]] Placeholders with_placeholders(std::string_view json);

/// Replaces the JSON text of a .glb file. The file must begin with a complete one.
[[nodiscard]] std::string with_json(std::string_view glb, std::string json);

/// A .glb file whose chunks end on multiples of 4 bytes, made from one whose chunks do not; empty if they do,
/// and if the file is broken otherwise.
[[nodiscard]] std::string with_padding(std::string_view glb);

/// Removes the placeholders from the parsed file.
void remove_placeholders(const Placeholders& given, tinygltf::Model& file);

}  // namespace marti::scenes::gltf
