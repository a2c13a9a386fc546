// Internal to scenes/: decompresses a mesh with the library Draco, within limits. Only where marti is built
// with it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include <draco/mesh/mesh.h>

namespace marti::scenes {

/// What the compressed data are said to hold.
struct DracoCounts {
  std::uint32_t faces = 0;
  std::uint32_t points = 0;
  std::uint64_t memory = 0;  ///< bytes that the values of its attributes may take
};

/// The mesh; null when the data are damaged or differ from what is expected: `refusal` then says what they
/// are, as in "are damaged". The library itself allocates what the data declare, so the counts are compared
/// before that.
[[nodiscard]] std::unique_ptr<draco::Mesh> decode_draco(std::span<const std::byte> bytes,
                                                        const DracoCounts& expected, std::string& refusal);

}  // namespace marti::scenes
