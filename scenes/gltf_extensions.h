// Internal to scenes/: how a glTF file's extensions are treated.
#pragma once

#include <array>
#include <string>
#include <vector>

#include <tiny_gltf.h>

namespace marti::scenes::gltf {

inline constexpr std::array<const char*, 2> meshopt_names = {"EXT_meshopt_compression",
                                                             "KHR_meshopt_compression"};

/// Which of meshopt_names is among the extensions; empty if none is.
[[nodiscard]] std::string meshopt_among(const tinygltf::ExtensionMap& extensions);

/// Whether an extension says that data are compressed: KHR_draco_mesh_compression, or one of meshopt_names.
[[nodiscard]] bool is_compression(const std::string& extension);

/// Why an extension cannot be read: "not supported", or that marti was built without the library for it.
[[nodiscard]] std::string why_unsupported(const std::string& extension);

/// The extensions that the file requires and that are not supported.
[[nodiscard]] std::vector<std::string> missing_requirements(const tinygltf::Model& file);

/// Whether an extension changes how things look and no geometry, so that a file can be read without it.
[[nodiscard]] bool is_appearance(const std::string& extension);

/// The extensions that the file uses, that it does not require and that are not supported, with commas
/// between them.
[[nodiscard]] std::string ignored_extensions(const tinygltf::Model& file);

/// The extension with which the bytes of a buffer view are compressed (EXT_meshopt_compression or its Khronos
/// twin), if the file does not also hold them uncompressed; else empty. The view and its buffer must exist.
[[nodiscard]] std::string compression_of_view(const tinygltf::Model& file, int view);

/// The extension with which a primitive's attributes and indices are compressed (KHR_draco_mesh_compression).
[[nodiscard]] std::string compression_of_primitive(const tinygltf::Model& file,
                                                   const tinygltf::Primitive& primitive);

}  // namespace marti::scenes::gltf
