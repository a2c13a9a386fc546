// Which channel, bank, row and column of a DRAM memory an address means.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "memory/dram_config.h"
#include "memory/record_kind.h"

namespace marti::memory {

/// Where one burst is.
struct DramPlace {
  std::uint32_t channel = 0;
  std::uint32_t rank = 0;
  std::uint32_t stack = 0;  ///< counted over all ranks of the channel
  std::uint32_t group = 0;  ///< bank group, counted over all stacks of the channel
  std::uint32_t bank = 0;   ///< counted over all ranks and bank groups of the channel
  std::uint32_t row = 0;
};

class DramMapping {
 public:
  /// Throws KeyError for a mapping that does not have all bits of each field exactly once.
  explicit DramMapping(const DramConfig& config);

  /// Addresses beyond the memory's capacity begin again at its start.
  [[nodiscard]] DramPlace place(Address address) const {
    const std::uint32_t rank = value(DramField::rank, address);
    const std::uint32_t stack = rank * stacks_ + value(DramField::stack, address);
    const std::uint32_t group = stack * bank_groups_ + value(DramField::bank_group, address);
    return {.channel = value(DramField::channel, address),
            .rank = rank,
            .stack = stack,
            .group = group,
            .bank = group * banks_ + value(DramField::bank, address),
            .row = value(DramField::row, address)};
  }
  /// The value of one field: within its rank, bank group or stack, as simulators that are given such fields
  /// count.
  [[nodiscard]] std::uint32_t field(DramField field, Address address) const { return value(field, address); }
  [[nodiscard]] std::uint32_t channel(Address address) const { return value(DramField::channel, address); }

  /// Bytes in a row that are in the same row of the same channel.
  [[nodiscard]] std::uint32_t channel_interleave() const { return channel_interleave_; }

 private:
  struct Run {
    std::uint32_t shift = 0;  // of the run's lowest bit in the address
    std::uint32_t up = 0;     // of that bit in the field
    Address mask = 0;
  };
  // Nearly every field's bits are in one run.
  struct Field {
    Run first;
    std::vector<Run> more;
  };

  [[nodiscard]] std::uint32_t value(DramField field, Address address) const {
    const Field& bits = fields_[static_cast<std::size_t>(field)];
    Address value = address >> bits.first.shift & bits.first.mask;
    for (const Run& run : bits.more) {
      value |= (address >> run.shift & run.mask) << run.up;
    }
    return static_cast<std::uint32_t>(value);
  }

  std::array<Field, dram_field_names.size()> fields_;
  std::uint32_t stacks_;
  std::uint32_t bank_groups_;
  std::uint32_t banks_;
  std::uint32_t channel_interleave_ = 0;
};

/// Reads one entry of a mapping: "column", or "column:3" for three of its bits. Throws UserError.
[[nodiscard]] DramFieldBits parse_dram_field(std::string_view text);

}  // namespace marti::memory
