// Internal to scenes/: vertex indices without a buffer view. glTF 2.0 allows them (section 3.6.2.3: zeros
// that sparse values replace; or data compressed by an extension), tinygltf does not.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <tiny_gltf.h>

namespace marti::scenes::gltf {

struct IndexViews {
  std::string json;  ///< with an arbitrary buffer view added to each of them; empty if there are none
  std::vector<int> accessors;  ///< those without a buffer view
};

/// Finds the accessors that primitives use for indices and that have no buffer view.
[[nodiscard]] IndexViews given_index_views(std::string_view json);

/// Replaces the JSON text of a .glb file. The file must begin with a complete one.
[[nodiscard]] std::string with_json(std::string_view glb, std::string json);

/// Removes the added views from the parsed accessors.
void take_index_views(const IndexViews& given, tinygltf::Model& file);

}  // namespace marti::scenes::gltf
