// Reading the tables of [sweep]: which keys take which values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/config.h"
#include "studies/sweep/plan/axis_values.h"

namespace marti::studies::sweep {

/// The most steps of an axis, and the most points of a sweep before its filter.
inline constexpr std::int64_t most_sweep_steps = 100'000;
inline constexpr std::uint64_t most_sweep_points = 1'000'000;

/// One direction of a sweep: keys that change together. All axes are crossed.
struct SweepAxis {
  /// named: the points of [sweep.points], whose steps may give different keys.
  enum class Kind : std::uint8_t { list, zip, named };
  Kind kind = Kind::list;
  int line = 0;                                  ///< of the file; 0: from the command line
  std::vector<std::size_t> keys;                 ///< indices into the schema, in the order of the file
  std::vector<std::vector<sim::Setting>> steps;  ///< what each step gives, in the order of the file
  std::vector<std::string> names;                ///< of named points, one for each step; else empty
};

struct SweepTable {
  std::vector<SweepAxis> axes;                       ///< named points first, then in the order of the file
  std::vector<sim::Setting> base;                    ///< of [sweep.base]; empty: one node
  std::optional<std::vector<sim::Setting>> compare;  ///< of [sweep.compare]
};

/// Reads what the free section "sweep" holds, and the axes of the command line (axis_values.h), which come
/// first and replace axes of the file over their keys, as do `more` of them. Throws UserError naming file,
/// line and key: for an unknown or repeated key, one that no sweep may change, a wrong value, an empty axis,
/// too many points, and where there is no axis at all.
[[nodiscard]] SweepTable read_sweep_table(const sim::Config& config,
                                          std::span<const std::string> arguments = {},
                                          std::span<const AxisArgument> more = {});

}  // namespace marti::studies::sweep
