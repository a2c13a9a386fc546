// Internal to scenes/: faults of a glTF file's JSON that tinygltf reads over. It takes numbers modulo 2^32,
// drops values of the wrong type, and does not look at the version.
#pragma once

#include <string>
#include <string_view>

namespace marti::scenes::gltf {

/// What is wrong with the JSON text of a glTF 2.0 file, with the place in the form of a JSON pointer (RFC
/// 6901) as in
/// "/nodes/0/mesh is 4294967296, ..."; empty when nothing was found, or when the text is no JSON. Looks at
/// whole numbers (glTF's indices, enumerations and what the supported compressions say), at the numbers of
/// nodes, cameras and materials, at extensions, and at `asset` (glTF 2.0, section 3.2).
[[nodiscard]] std::string json_fault(std::string_view text);

}  // namespace marti::scenes::gltf
