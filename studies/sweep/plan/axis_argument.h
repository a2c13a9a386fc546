// An axis of a sweep given on the command line.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/config.h"

namespace marti::studies::sweep {

/// The values of one key.
struct AxisArgument {
  std::size_t key = 0;  ///< index into the schema
  std::vector<sim::Setting> steps;
};

/// Reads "KEY=VALUE,VALUE,...", of which each part may be a range of numbers: "1..8" goes up by 1 (integers
/// only), "1..9+2" by 2, "4KiB..64KiB*2" by factors of 2, from the first value to the last that is not above
/// the second. A value in quotation marks may hold commas; two quotation marks in it are one, as in CSV.
/// Throws UserError that begins with "--axis ARGUMENT: " for an unknown key, a wrong or repeated value, a
/// range that is empty, does not go up or has more than most_sweep_steps values.
[[nodiscard]] AxisArgument read_axis_argument(const sim::Config& config, const std::string& argument);

}  // namespace marti::studies::sweep
