// Internal to scenes/: the header of a PLY file (G. Turk, The PLY Polygon File Format, Stanford 1994).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scenes/scene_notes.h"
#include "scenes/text_lines.h"

namespace marti::scenes {

enum class PlyFormat : std::uint8_t { ascii, binary_little_endian, binary_big_endian };

enum class PlyType : std::uint8_t { i8, u8, i16, u16, i32, u32, f32, f64 };

[[nodiscard]] std::size_t size_of(PlyType type);
[[nodiscard]] bool is_integer(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::f32;
  std::optional<PlyType> count;  ///< set for a list: the type of its length
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;  ///< at least one

  /// The place of a property in `properties`.
  [[nodiscard]] std::optional<std::size_t> find(std::string_view property) const;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
};

/// Reads up to the line end_header. Throws UserError with file and line. Counts are as declared, but no
/// larger than the `size` of the file allows. Lines that are no statement, and in text types that PLY does
/// not have, are replaced (`left_out`).
[[nodiscard]] PlyHeader read_ply_header(TextLines& lines, std::size_t size, LeftOut& left_out);

}  // namespace marti::scenes
