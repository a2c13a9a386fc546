// The kinds of record in the scene database. The memory system knows them only as labels of addresses.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace marti::memory {

using Address = std::uint64_t;

/// transform: an instance of a mesh.
enum class RecordKind : std::uint8_t { node, transform, list, primitive, material, texel, pixel };
inline constexpr std::size_t record_kinds = 7;
inline constexpr std::array<std::string_view, record_kinds> record_kind_names = {
    "node", "transform", "list", "primitive", "material", "texel", "pixel"};

}  // namespace marti::memory
