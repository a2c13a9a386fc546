// Inside of the folder: what is done about a glTF file's extensions.
#pragma once

#include <string>

#include <tiny_gltf.h>

namespace marti::scenes::gltf {

/// The first extension that the file requires and that is not supported; empty when there is none.
[[nodiscard]] std::string missing_requirement(const tinygltf::Model& file);

/// The extensions that the file uses and that are not supported, with commas between them.
[[nodiscard]] std::string ignored_extensions(const tinygltf::Model& file);

/// The extension that has compressed the bytes of a buffer view (EXT_meshopt_compression or its Khronos
/// twin) where nobody has stored them uncompressed as well; else empty. The view and its buffer must exist.
[[nodiscard]] std::string compression_of_view(const tinygltf::Model& file, int view);

/// The same for the attributes and indices of a primitive (KHR_draco_mesh_compression).
[[nodiscard]] std::string compression_of_primitive(const tinygltf::Model& file,
                                                   const tinygltf::Primitive& primitive);

}  // namespace marti::scenes::gltf
