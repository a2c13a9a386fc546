// The values of a key, from the file or an assignment.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sim/document.h"
#include "sim/error.h"
#include "sim/schema.h"

namespace marti::sim {

/// The values that a key accepts, in words: "a size such as \"16 KiB\"".
[[nodiscard]] std::string expected_of(const Key& key);

/// The unit in which a value of the key is a number: "byte", "Hz", "ps", of a percentage "1", else the key's
/// own unit.
[[nodiscard]] std::string unit_of(const Key& key);

/// The values of `key`: one, or those of a list. Throws UserError at `place` for another type and
/// for a value out of range.
[[nodiscard]] std::vector<Value> read_values(const Key& key, const DocumentValue& value, const Place& place);

}  // namespace marti::sim
