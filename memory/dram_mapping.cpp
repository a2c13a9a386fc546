#include "memory/dram_mapping.h"

#include <algorithm>
#include <bit>
#include <string>

#include "sim/error.h"
#include "sim/key_error.h"
#include "sim/parse_number.h"
#include "sim/shown.h"

namespace marti::memory {

namespace {

std::uint32_t bits_of(const DramConfig& config, DramField field) {
  const std::array<std::uint32_t, dram_field_names.size()> counts = {
      config.channels, config.ranks, config.stacks,   config.bank_groups,
      config.banks,    config.rows,  config.columns()};
  return static_cast<std::uint32_t>(std::countr_zero(counts[static_cast<std::size_t>(field)]));
}

std::string name_of(DramField field) {
  return std::string(dram_field_names[static_cast<std::size_t>(field)]);
}

// The bits of the run that takes what is left of its field: those that no run with a number has.
std::uint32_t bits_left(const DramConfig& config, const std::vector<DramFieldBits>& mapping,
                        DramField field) {
  std::uint32_t given = 0;
  std::uint32_t without = 0;
  for (const DramFieldBits& run : mapping) {
    if (run.field == field) {
      given += run.bits;
      without += run.bits == 0 ? 1 : 0;
    }
  }
  const std::uint32_t all = bits_of(config, field);
  if (without > 1 || given > all || (without == 0 && given < all)) {
    throw sim::KeyError("dram.mapping", "must have each of the " + std::to_string(all) +
                                            " bits of the field " + name_of(field) +
                                            " once: runs of \"field:bits\", and at most one \"field\", which "
                                            "takes the bits that are left");
  }
  return all - given;
}

// The runs with that of the stacks, which may be left out.
std::vector<DramFieldBits> with_stacks(const DramConfig& config) {
  std::vector<DramFieldBits> mapping = config.mapping;
  const auto is = [](DramField field) {
    return [field](const DramFieldBits& run) { return run.field == field; };
  };
  if (std::none_of(mapping.begin(), mapping.end(), is(DramField::stack))) {
    const auto last_rank = std::find_if(mapping.rbegin(), mapping.rend(), is(DramField::rank));
    mapping.insert(last_rank == mapping.rend() ? mapping.end() : last_rank.base(), {DramField::stack, 0});
  }
  return mapping;
}

}  // namespace

DramMapping::DramMapping(const DramConfig& config)
    : stacks_(config.stacks), bank_groups_(config.bank_groups), banks_(config.banks) {
  const std::vector<DramFieldBits> mapping = with_stacks(config);
  std::array<std::uint32_t, dram_field_names.size()> left{};
  for (std::size_t i = 0; i < left.size(); ++i) {
    left[i] = bits_left(config, mapping, static_cast<DramField>(i));
  }
  std::array<std::uint32_t, dram_field_names.size()> up{};
  auto shift = static_cast<std::uint32_t>(std::countr_zero(config.burst_bytes));
  bool only_columns = true;
  channel_interleave_ = config.burst_bytes;
  for (const auto& [field, given] : mapping) {
    const auto index = static_cast<std::size_t>(field);
    const std::uint32_t bits = given == 0 ? left[index] : given;
    if (bits == 0) {
      continue;
    }
    if (shift + bits > 63) {
      throw sim::KeyError("dram.mapping", "the memory is larger than 2^63 bytes");
    }
    const Run run{shift, up[index], (Address{1} << bits) - 1};
    if (up[index] == 0) {
      fields_[index].first = run;
    } else {
      fields_[index].more.push_back(run);
    }
    only_columns = only_columns && field == DramField::column;
    if (only_columns) {
      channel_interleave_ <<= bits;
    }
    shift += bits;
    up[index] += bits;
  }
}

DramFieldBits parse_dram_field(std::string_view text) {
  const std::size_t colon = text.find(':');
  const std::string_view name = text.substr(0, colon);
  const auto* const found = std::find(dram_field_names.begin(), dram_field_names.end(), name);
  DramFieldBits run;
  bool valid = found != dram_field_names.end();
  if (valid) {
    run.field = static_cast<DramField>(found - dram_field_names.begin());
  }
  if (valid && colon != std::string_view::npos) {
    run.bits = sim::parse_number<decltype(run.bits)>(text.substr(colon + 1)).value_or(0);
    valid = run.bits >= 1 && run.bits <= 32;
  }
  if (!valid) {
    throw sim::UserError(
        sim::shown(text) +
        " is no field of an address: channel, rank, stack, bank_group, bank, row or column, or one "
        "of these with a number of bits from 1 to 32, as in \"column:3\"");
  }
  return run;
}

}  // namespace marti::memory
