// What is tried with bytes that nobody has written on purpose. A target returns when they are refused by a
// UserError or used without harm; everything else that is thrown, and every broken promise, is a finding.
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
/// is made up. A scene that comes out must be what scenes/scene.h says, at rest and in motion.
void try_gltf(std::span<const std::uint8_t> bytes);

}  // namespace marti::fuzz
