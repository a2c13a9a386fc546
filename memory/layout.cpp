#include "memory/layout.h"

#include <bit>
#include <string>
#include <string_view>

#include "sim/key_error.h"
#include "sim/round_up.h"

namespace marti::memory {

namespace {

constexpr Address address_limit = Address{1} << 48U;

// The configuration key of the size of such a record.
std::string key_of(std::string_view name) {
  return "layout." +
         std::string(name == record_kind_names[static_cast<std::size_t>(RecordKind::list)] ? "entry" : name);
}

}  // namespace

Layout::Layout(const LayoutConfig& config, const RecordCounts& counts, std::uint64_t quadrics) {
  const std::array<std::uint32_t, record_kinds> bytes = {
      config.node_bytes,     config.transform_bytes, config.entry_bytes, config.primitive_bytes,
      config.material_bytes, config.texel_bytes,     config.pixel_bytes};
  if (!std::has_single_bit(config.record_alignment) || !std::has_single_bit(config.section_alignment)) {
    throw sim::KeyError(
        std::has_single_bit(config.record_alignment) ? "layout.section_alignment" : "layout.record_alignment",
        "must be a power of two");
  }
  sim::ensure(quadrics <= counts[static_cast<std::size_t>(RecordKind::primitive)],
              "layout: more quadrics than primitives");
  Address at = 0;
  const auto place = [&](Section& section, std::uint64_t count, std::uint32_t record, std::uint32_t alignment,
                         std::string_view name) {
    if (record == 0) {
      throw sim::KeyError(key_of(name), "a record of 0 bytes");
    }
    section.base = at;
    section.count = count;
    section.bytes = record;
    section.stride = static_cast<std::uint32_t>(sim::round_up(record, alignment));
    if (count > (address_limit - at) / section.stride) {
      throw sim::KeyError(key_of(name), "the database does not fit in 2^48 bytes");
    }
    at += count * section.stride;
  };
  for (std::size_t k = 0; k < record_kinds; ++k) {
    const auto kind = static_cast<RecordKind>(k);
    const bool packed = kind == RecordKind::list || kind == RecordKind::texel || kind == RecordKind::pixel;
    at = sim::round_up(at, config.section_alignment);
    const std::uint64_t count = kind == RecordKind::primitive ? counts[k] - quadrics : counts[k];
    place(sections_[k], count, bytes[k], packed ? 1U : config.record_alignment, record_kind_names[k]);
    if (kind == RecordKind::primitive) {
      quadrics_.first = count;
      place(quadrics_, quadrics, config.quadric_bytes, config.record_alignment, "quadric");
    }
  }
  end_ = at;
}

void Layout::add_room(std::uint64_t bytes, std::uint64_t alignment) {
  room_ = sim::round_up(end_, alignment);
  end_ = room_ + bytes;
}

std::optional<RecordKind> Layout::kind_at(Address address) const {
  const Address records_end = room_ != 0 ? room_ : end_;
  std::optional<RecordKind> kind;
  for (std::size_t k = 0; k < record_kinds && address < records_end; ++k) {
    if (sections_[k].base <= address && section_bytes(static_cast<RecordKind>(k)) > 0) {
      kind = static_cast<RecordKind>(k);
    }
  }
  return kind;
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
