#include "processors/replay/record_laws.h"

#include <array>
#include <numeric>

#include "processors/walk/law.h"
#include "processors/walk/record_places.h"

namespace marti::processors::replay {

namespace {

/// Of all records of a kind together.
struct Extent {
  sim::Sum bytes = 0;
  sim::Sum least = 0;  ///< lines
  sim::Sum most = 0;
};

/// A record begins on a multiple of what divides the beginning of its section, its stride and a line.
class Lines {
 public:
  Lines(const memory::LayoutConfig& layout, std::uint32_t line, bool anywhere)
      : layout_(layout), line_(line), anywhere_(anywhere) {}

  /// `count` records of `bytes` each, at any multiple of `apart` from their section's beginning.
  void add_records(Extent& extent, sim::Sum count, std::uint32_t bytes, std::uint64_t apart) const {
    extent.bytes += count * bytes;
    extent.least += count * ((sim::Sum{bytes} + line_ - 1) / line_);
    extent.most += count * most_lines(bytes, apart);
  }
  /// Lists of entries that lie next to each other, at least one entry each.
  void add_lists(Extent& extent, sim::Sum lists, sim::Sum entries, std::uint32_t entry) const {
    const sim::Sum bytes = entries * entry;
    extent.bytes += bytes;
    extent.least += std::max(lists, (bytes + line_ - 1) / line_);
    extent.most += (bytes + lists * (last_begin(entry) - 1)) / line_ + lists;
  }
  [[nodiscard]] sim::Sum most_lines(std::uint32_t bytes, std::uint64_t apart) const {
    return (last_begin(apart) + bytes - 1) / line_ + 1;
  }
  /// Of records that are not packed.
  [[nodiscard]] std::uint64_t stride(std::uint32_t bytes) const {
    const std::uint64_t alignment = layout_.record_alignment;
    return (bytes + alignment - 1) / alignment * alignment;
  }

 private:
  // The largest distance of a record's first byte from the beginning of its line.
  [[nodiscard]] sim::Sum last_begin(std::uint64_t apart) const {
    return anywhere_
               ? sim::Sum{line_} - 1
               : sim::Sum{line_} - static_cast<sim::Sum>(std::gcd(
                                       std::gcd<std::uint64_t>(apart, layout_.section_alignment), line_));
  }

  const memory::LayoutConfig& layout_;
  std::uint32_t line_;
  bool anywhere_;
};

// Spheres, cylinders and cones lie behind the triangles.
void add_primitives(const Lines& lines, const memory::LayoutConfig& layout, const cost::StepCounts& steps,
                    Extent& primitives) {
  const std::int64_t quadrics = steps.sphere_tests + steps.cone_tests;
  const std::uint64_t triangle_stride = lines.stride(layout.primitive_bytes);
  lines.add_records(primitives, steps.tests - quadrics, layout.primitive_bytes, triangle_stride);
  lines.add_records(primitives, quadrics, layout.quadric_bytes,
                    std::gcd(triangle_stride, lines.stride(layout.quadric_bytes)));
}

std::array<Extent, memory::record_kinds> extents_of(const program::WorkLog& log,
                                                    const machine::MachineConfig& config,
                                                    const MachineResult& result) {
  const cost::StepCounts steps = result.steps();
  const auto records = cost::records_of(steps, result.leaf_records);
  const memory::LayoutConfig& layout = config.layout;
  const Lines lines(layout, config.reference_bytes(), config.build.sharing != machine::Sharing::given);
  std::array<Extent, memory::record_kinds> extents;
  const auto of = [&](memory::RecordKind kind) -> Extent& { return extents[static_cast<std::size_t>(kind)]; };
  const auto count = [&](memory::RecordKind kind) { return records[static_cast<std::size_t>(kind)]; };
  using enum memory::RecordKind;
  const std::uint64_t node_stride = lines.stride(layout.node_bytes);
  const std::int64_t cuts = result.leaf_records ? 0 : steps.cuts;  // a leaf without a record may be cut
  lines.add_records(of(node), count(node) - cuts, layout.node_bytes, node_stride);
  of(node).most += cuts * lines.most_lines(layout.node_bytes, node_stride);
  lines.add_records(of(transform), count(transform), layout.transform_bytes,
                    lines.stride(layout.transform_bytes));
  lines.add_lists(of(list), count(list), log.mailboxes ? steps.lookups : steps.tests, layout.entry_bytes);
  if (layout.leaf == memory::LeafLayout::inline_records) {
    const std::uint32_t bytes = walk::inline_record_bytes(log, layout);
    lines.add_records(of(primitive), steps.tests, bytes, lines.stride(bytes));
  } else {
    add_primitives(lines, layout, steps, of(primitive));
  }
  of(node).most += result.simt.counts().fills;  // each a line of a stack, counted as a node's
  lines.add_records(of(material), count(material), layout.material_bytes,
                    lines.stride(layout.material_bytes));
  lines.add_records(of(texel), count(texel), layout.texel_bytes, layout.texel_bytes);
  return extents;  // pixels are written, not looked up
}

}  // namespace

void check_records(const program::WorkLog& log, const machine::MachineConfig& config,
                   const MachineResult& result) {
  const bool given = config.build.sharing == machine::Sharing::given;
  const cost::ReferenceCounts references = result.references();
  const auto extents = extents_of(log, config, result);
  sim::Sum record_bytes = 0;
  for (std::size_t kind = 0; kind < memory::record_kinds; ++kind) {
    const std::int64_t looked_up = references.hits.at(kind) + references.misses.at(kind);
    const std::string of(memory::record_kind_names.at(kind));
    // Lanes share what they look up.
    walk::require(!result.simt.nodes.empty() || looked_up >= extents.at(kind).least,
                  "records are read whole: " + of);
    walk::require(!given || looked_up <= extents.at(kind).most, "nothing but records is read: " + of);
    record_bytes += extents.at(kind).bytes;
  }
  if (!given) {
    return;
  }
  sim::Sum reads = 0;
  sim::Sum writes = 0;
  sim::Sum bytes = 0;
  for (const ClusterResult& cluster : result.clusters) {
    reads += cluster.interconnect.reads;
    writes += cluster.interconnect.writes;
    bytes += cluster.interconnect.bytes;
  }
  const sim::Sum of_pixels =
      (result.simt.nodes.empty() ? sim::Sum{writes} : sim::Sum{result.steps().pixels}) *
      config.layout.pixel_bytes;
  if (config.cache.organisation != machine::CacheOrganisation::none) {
    const sim::Sum lines = reads + result.simt.counts().spills;
    walk::require(bytes == of_pixels + lines * config.reference_bytes(),
                  "an interconnect moves whole lines and pixels");
  } else if (reads > 0 && config.l2.sharing == machine::SecondLevel::none &&
             (result.leaf_records || result.steps().cuts == 0)) {
    walk::require(bytes == of_pixels + record_bytes, "an interconnect moves the records read and pixels");
  }
}

}  // namespace marti::processors::replay
