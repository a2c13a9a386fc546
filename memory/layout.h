// The database layout: the address of each record, computed from record sizes and an alignment.
//
// The sections follow one another from address 0: nodes, transforms, object lists, primitives, materials,
// texels, frame buffer. Records of a section are a stride apart: the record's size rounded up to the record
// alignment (object lists, texels and pixels are packed arrays, so they are not padded). Primitives have two
// sizes: first come all triangles, then the spheres, cylinders and cones (quadrics), whose numbers continue
// those of the triangles.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "memory/record_kind.h"

namespace marti::memory {

enum class NodeOrder : std::uint8_t { breadth_first, depth_first, treelets };
inline constexpr std::array<std::string_view, 3> node_order_names = {"breadth_first", "depth_first",
                                                                     "treelets"};

/// How a leaf's primitives are found. list: by a list of references. inline_records: they lie in a row, one
/// record for each reference, leaf by leaf.
enum class LeafLayout : std::uint8_t { list, inline_records };
inline constexpr std::array<std::string_view, 2> leaf_layout_names = {"list", "inline"};

/// Record sizes in bytes, each at least 1.
struct LayoutConfig {
  std::uint32_t node_bytes = 8;  ///< kind and count in one word, first child or first entry in the other
  /// one instance: three rows of four 4-byte numbers, where its mesh begins, which it is. Vulkan's record of
  /// an instance (VkAccelerationStructureInstanceKHR) has 64 bytes, and so has what Intel's units read of one
  /// on the way down (the first part of the instance leaf in Mesa's src/intel/vulkan/bvh/anv_bvh.h)
  std::uint32_t transform_bytes = 64;
  std::uint32_t entry_bytes = 4;       ///< one object reference of a leaf's list
  std::uint32_t primitive_bytes = 48;  ///< three vertices of three 4-byte coordinates, material, padding
  /// one sphere, cylinder or cone: two points of three 4-byte coordinates, two radii, kind, material
  std::uint32_t quadric_bytes = 40;
  std::uint32_t material_bytes = 64;
  std::uint32_t texel_bytes = 4;
  std::uint32_t pixel_bytes = 4;
  std::uint32_t record_alignment = 4;      ///< a power of two
  std::uint32_t section_alignment = 4096;  ///< a power of two; every section starts on a multiple of it
  NodeOrder node_order = NodeOrder::breadth_first;
  LeafLayout leaf = LeafLayout::list;
  std::uint32_t treelet_bytes = 4096;  ///< the node records of a treelet take at most so many

  friend bool operator==(const LayoutConfig&, const LayoutConfig&) = default;
  /// Bytes from one node record to the next; record_alignment must be valid.
  [[nodiscard]] std::uint64_t node_stride() const {
    return (std::uint64_t{node_bytes} + record_alignment - 1) / record_alignment * record_alignment;
  }
};

/// Number of records in each section; primitives include quadrics.
using RecordCounts = std::array<std::uint64_t, record_kinds>;

/// The layout of one database. Throws UserError for a size of zero, an alignment that is not a power of
/// two, or a database beyond 2^48 bytes.
class Layout {
 public:
  /// The last `quadrics` primitives are quadrics.
  Layout(const LayoutConfig& config, const RecordCounts& counts, std::uint64_t quadrics = 0);

  /// Address of record `index` of a section.
  [[nodiscard]] Address address(RecordKind kind, std::uint64_t index) const {
    const Section& section = section_of(kind, index);
    return section.base + (index - section.first) * section.stride;
  }
  /// Bytes of a record; for primitives, of a triangle.
  [[nodiscard]] std::uint32_t record_bytes(RecordKind kind) const {
    return sections_[static_cast<std::size_t>(kind)].bytes;
  }
  /// Bytes of record `index` of a section.
  [[nodiscard]] std::uint32_t record_bytes(RecordKind kind, std::uint64_t index) const {
    return section_of(kind, index).bytes;
  }
  [[nodiscard]] Address base(RecordKind kind) const { return sections_[static_cast<std::size_t>(kind)].base; }
  [[nodiscard]] std::uint32_t stride(RecordKind kind) const {
    return sections_[static_cast<std::size_t>(kind)].stride;
  }
  /// Bytes of one section's records, without the gap after the last.
  [[nodiscard]] std::uint64_t section_bytes(RecordKind kind) const {
    const Section& section = sections_[static_cast<std::size_t>(kind)];
    const std::uint64_t bytes = section.count * section.stride;
    return kind == RecordKind::primitive ? bytes + quadrics_.count * quadrics_.stride : bytes;
  }
  /// Keeps `bytes` behind the last section, from a multiple of `alignment` on, a power of two. Once at most.
  void add_room(std::uint64_t bytes, std::uint64_t alignment);
  /// Where that begins.
  [[nodiscard]] Address room() const { return room_; }
  /// The kind of the record at an address, or before it where there is a gap; std::nullopt behind all
  /// records.
  [[nodiscard]] std::optional<RecordKind> kind_at(Address address) const;
  /// One past the last address, frame buffer and room included.
  [[nodiscard]] Address end() const { return end_; }
  /// Bytes of all sections except the frame buffer: the size of one copy of the database.
  [[nodiscard]] std::uint64_t database_bytes() const;

 private:
  struct Section {
    Address base = 0;
    std::uint64_t first = 0;  ///< number of its first record
    std::uint64_t count = 0;
    std::uint32_t stride = 0;
    std::uint32_t bytes = 0;
  };
  [[nodiscard]] const Section& section_of(RecordKind kind, std::uint64_t index) const {
    const Section& section = sections_[static_cast<std::size_t>(kind)];
    return kind == RecordKind::primitive && index >= quadrics_.first ? quadrics_ : section;
  }

  std::array<Section, record_kinds> sections_{};
  Section quadrics_;  ///< the second part of the primitives
  Address room_ = 0;
  Address end_ = 0;
};

}  // namespace marti::memory
