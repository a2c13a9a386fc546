// Figures of technologies, and of caches in them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "memory/cache_config.h"
#include "processors/machine/energy_config.h"

namespace marti::processors::energy {

/// The figures of a preset; their sources are in energy_presets.cpp. Those of caches are by_shape. All 0 for
/// `none`.
[[nodiscard]] machine::EnergyFigures energy_figures(machine::EnergyPreset preset);

/// Areas in mm2 of units that begin an operation in each cycle.
struct OperationAreas {
  double add = 0.0;
  double multiply = 0.0;
  double divide = 0.0;   ///< and square root
  double integer = 0.0;  ///< and comparison
};
[[nodiscard]] OperationAreas operation_areas(machine::EnergyPreset preset);

/// Caches whose figures are known, by the bytes of their lines. One of more ways than the most that are
/// known, 8 or with lines of 128 bytes 32, takes as much as one of so many: nobody builds one that reads them
/// all.
struct KnownCaches {
  std::uint32_t line = 0;
  std::uint64_t least_size = 0;  ///< bytes
  std::uint64_t most_size = 0;
};
inline constexpr std::array<KnownCaches, 3> known_caches = {
    {{32, 2U << 10U, 4U << 20U}, {64, 2U << 10U, 4U << 20U}, {128, 8U << 10U, 8U << 20U}}};

/// All three figures of a cache, between those of the caches in cacti_rows.h: equal to theirs, and where one
/// of theirs is left out and found from its neighbours of half and twice its size within 6 % (read), 9 %
/// (write) and 12 % (area) on average, 44, 35 and 50 % at most. std::nullopt for caches that are not among
/// known_caches, and for `none`.
[[nodiscard]] std::optional<machine::CacheFigures> known_cache(machine::EnergyPreset preset,
                                                               const memory::CacheConfig& cache);

}  // namespace marti::processors::energy
