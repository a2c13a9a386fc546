// What limits the points of a sweep, by its store.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>

#include "studies/limits/sweep_limits.h"
#include "studies/sweep/store/sweep_reader.h"

namespace marti::studies::limits {

/// Nothing is said of sweeps with more timed points: each takes about a millisecond and some 30 KiB.
inline constexpr std::ptrdiff_t most_limited_points = 4'000;

class StoredLimits {
 public:
  /// Reads the settings and figures of all timed points.
  explicit StoredLimits(const sweep::SweepReader& sweep,
                        const std::optional<keys::Prices>& prices = std::nullopt);

  /// std::nullopt for a point that has not been timed, or whose frame takes no time; for all points of a
  /// sweep with more than most_limited_points, or with settings that this version of the program does not
  /// know.
  [[nodiscard]] std::optional<PointLimit> at(std::int64_t ordinal) const;

 private:
  std::map<std::int64_t, std::size_t> places_;  // of timed points, in `limits_`
  std::optional<SweepLimits> limits_;
};

}  // namespace marti::studies::limits
