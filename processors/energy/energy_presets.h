// Figures of technologies, and the fit of caches to them.
#pragma once

#include <cstdint>
#include <optional>

#include "memory/cache_config.h"
#include "processors/machine/energy_config.h"

namespace marti::processors::energy {

/// The figures of a preset; their sources are in energy_presets.cpp. Those of caches are by_fit. All 0 for
/// `none`.
[[nodiscard]] machine::EnergyFigures energy_figures(machine::EnergyPreset preset);

/// The caches that the fit was made of: sizes and lines in bytes. A cache of more ways than most_fitted_ways
/// takes as much as one of so many: nobody builds one that reads them all.
inline constexpr std::uint64_t least_fitted_size = std::uint64_t{2} * 1024;
inline constexpr std::uint64_t most_fitted_size = std::uint64_t{4} * 1024 * 1024;
inline constexpr std::uint32_t least_fitted_line = 32;
inline constexpr std::uint32_t most_fitted_line = 64;
inline constexpr std::uint32_t most_fitted_ways = 8;

/// All three figures of a cache, by the fit; std::nullopt outside what it was made of, and for `none`.
[[nodiscard]] std::optional<machine::CacheFigures> fitted_cache(machine::EnergyPreset preset,
                                                                const memory::CacheConfig& cache);

}  // namespace marti::processors::energy
