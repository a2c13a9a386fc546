// Memories to start from, as their standards and other simulators give them.
#pragma once

#include <array>
#include <string_view>

#include "memory/dram_config.h"

namespace marti::memory {

inline constexpr std::array<std::string_view, 8> dram_preset_names = {
    "ddr4-2400",          "ddr5-4800", "hbm2-2000",     "gddr6-14000-1350mv",
    "gddr6-14000-1250mv", "hbm3-6400", "hbm3-6400-4gb", "lpddr5-6400"};

/// The memory with this index in dram_preset_names; the sources of its figures are in dram_presets.cpp.
[[nodiscard]] DramConfig dram_preset(std::size_t index);

}  // namespace marti::memory
