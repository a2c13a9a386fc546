#include "memory/layout.h"

#include <bit>
#include <string>

#include "sim/error.h"

namespace marti::memory {

namespace {

constexpr Address address_limit = Address{1} << 48U;

std::uint64_t round_up(std::uint64_t value, std::uint64_t multiple) {
  return (value + multiple - 1) / multiple * multiple;
}

}  // namespace

Layout::Layout(const LayoutConfig& config, const RecordCounts& counts) {
  const std::array<std::uint32_t, record_kinds> bytes = {config.node_bytes,      config.entry_bytes,
                                                         config.primitive_bytes, config.material_bytes,
                                                         config.texel_bytes,     config.pixel_bytes};
  if (!std::has_single_bit(config.record_alignment) || !std::has_single_bit(config.section_alignment)) {
    throw sim::UserError("layout: an alignment must be a power of two");
  }
  Address at = 0;
  for (std::size_t kind = 0; kind < record_kinds; ++kind) {
    if (bytes[kind] == 0) {
      throw sim::UserError("layout: a " + std::string(record_kind_names[kind]) + " record of 0 bytes");
    }
    const bool packed = kind == static_cast<std::size_t>(RecordKind::list) ||
                        kind == static_cast<std::size_t>(RecordKind::texel) ||
                        kind == static_cast<std::size_t>(RecordKind::pixel);
    Section& section = sections_[kind];
    section.base = round_up(at, config.section_alignment);
    section.count = counts[kind];
    section.bytes = bytes[kind];
    section.stride =
        packed ? bytes[kind] : static_cast<std::uint32_t>(round_up(bytes[kind], config.record_alignment));
    if (section.count > (address_limit - section.base) / section.stride) {
      throw sim::UserError("layout: the database does not fit in 2^48 bytes");
    }
    at = section.base + section.count * section.stride;
  }
  end_ = at;
}

std::uint64_t Layout::database_bytes() const {
  std::uint64_t sum = 0;
  for (std::size_t kind = 0; kind < record_kinds; ++kind) {
    if (kind != static_cast<std::size_t>(RecordKind::pixel)) {
      sum += section_bytes(static_cast<RecordKind>(kind));
    }
  }
  return sum;
}

}  // namespace marti::memory
