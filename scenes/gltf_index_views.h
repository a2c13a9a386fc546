// Inside of the folder: vertex indices without a buffer view, which glTF 2.0 allows (section 3.6.2.3: zeros
// that sparse values replace; or what an extension compresses) and tinygltf does not.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <tiny_gltf.h>

namespace marti::scenes::gltf {

struct IndexViews {
  std::string json;  ///< with a buffer view for each of them, any; empty where there is none of them
  std::vector<int> accessors;  ///< that had none
};

/// Finds the accessors that primitives have for indices and that name no buffer view.
[[nodiscard]] IndexViews given_index_views(std::string_view json);

/// A .glb file with another JSON text. The file must begin with a whole one.
[[nodiscard]] std::string with_json(std::string_view glb, std::string json);

/// Takes the views from the parsed accessors again.
void take_index_views(const IndexViews& given, tinygltf::Model& file);

}  // namespace marti::scenes::gltf
