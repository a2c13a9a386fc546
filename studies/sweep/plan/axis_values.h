// The values of one key along an axis: a list, or a range.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/config.h"

namespace marti::studies::sweep {

/// The settings that `value` lists for the key of this index: a list of values, or a range
/// `{ from = ..., to = ..., steps = ..., scale = "linear" | "log" }`, whose ends are exact. The steps of
/// whole numbers (integers, bytes, ticks) are rounded to the nearest, halves away from `from`; a logarithmic
/// range whose ends are powers of two and whose steps fit gives exact powers. Values that rounding makes
/// equal are left out, and `notes` says so. `repeats`: a list may hold a value twice. Throws UserError naming
/// file, line and key.
[[nodiscard]] std::vector<sim::Setting> axis_values(const sim::Config& config, std::size_t key,
                                                    const sim::DocumentValue& value, bool repeats,
                                                    std::vector<std::string>& notes);

}  // namespace marti::studies::sweep
