// A scene's fingerprint, for the provenance of results.
#pragma once

#include <cstdint>

#include "scenes/scene.h"

namespace marti::studies::run {

/// FNV-1a (Fowler, Noll, Vo) over the bits of what a frame depends on: vertices, triangles, quadrics,
/// materials, textures, lights, camera, background, given rays. Equal scenes have equal hashes, whatever
/// their names.
[[nodiscard]] std::uint64_t scene_hash(const scenes::Scene& scene);

}  // namespace marti::studies::run
