// The functions that are tried on random bytes. A target returns when the bytes are refused by a UserError or
// used without harm; any other exception, and every broken promise, is a finding.
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>

namespace marti::fuzz {

/// A promise that was not kept.
class Finding : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

inline void promise(bool kept, const std::string& what) {
  if (!kept) {
    throw Finding(what);
  }
}

/// The bytes as a configuration of `marti run`, and of `marti sweep` where they describe one. What was
/// read, written out again, must be read as the same.
void try_config(std::span<const std::uint8_t> bytes);

/// The bytes as a binary glTF file when they begin like one, else as the JSON part of one whose binary part
/// is made up. A scene that is loaded must be valid by scenes/scene.h, at rest and in motion.
void try_gltf(std::span<const std::uint8_t> bytes);

/// The bytes as an OBJ file; what comes after a line "#mtl" is the material library a.mtl beside it.
void try_obj(std::span<const std::uint8_t> bytes);

/// The bytes as a PLY file.
void try_ply(std::span<const std::uint8_t> bytes);

/// The bytes as a pbrt file.
void try_pbrt(std::span<const std::uint8_t> bytes);

/// The bytes as an array of NumPy with rays. What is read must be rays by scenes/given_rays.h.
void try_rays(std::span<const std::uint8_t> bytes);

}  // namespace marti::fuzz
