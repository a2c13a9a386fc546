// The values of a sweep's axes, as its store and its tables have them, for people.
#pragma once

#include <string>

#include "studies/tables/table.h"

namespace marti::studies::sweep {

/// Whether it is a key of the configuration.
[[nodiscard]] bool is_axis(const std::string& name);

/// The unit in which the values of an axis are numbers: "byte", "Hz", "ps", ...; empty for an axis of texts,
/// and for "point".
[[nodiscard]] std::string axis_unit(const std::string& axis);

/// Whether the axis is a key that is true or false: a store has 1 and 0.
[[nodiscard]] bool is_boolean_axis(const std::string& axis);

/// A value as its key would have it in a file, without quotation marks: "16 KiB", "33 MHz", "true"; "none"
/// where the point has no value.
[[nodiscard]] std::string axis_text(const std::string& axis, const tables::Cell& value);

}  // namespace marti::studies::sweep
