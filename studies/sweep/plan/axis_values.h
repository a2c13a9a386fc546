// The values of one key along an axis, in a file and on the command line.
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

/// The settings of an axis in a file, for the key of this index: a text as read_axis_argument() has it after
/// its "=", for keys of numbers, or a list whose elements are values or such texts. `repeats`: a value may
/// come twice. Throws UserError naming file, line and key.
[[nodiscard]] std::vector<sim::Setting> axis_values(const sim::Config& config, std::size_t key,
                                                    const sim::DocumentValue& value, bool repeats);

}  // namespace marti::studies::sweep
