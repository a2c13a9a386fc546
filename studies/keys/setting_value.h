// The value of a setting, of its text in a TOML file, as a result.json and a store keep it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "sim/schema.h"

namespace marti::studies {

/// As JSON has it: a size in bytes, a frequency in Hz, a duration in ps, a percentage as a fraction, a
/// boolean, a number, a text, or a list of these. The text without quotation marks where `schema` lacks the
/// key or the key has no such value: somebody may have changed the file.
[[nodiscard]] nlohmann::ordered_json setting_value(const sim::Schema& schema, std::string_view key,
                                                   const std::string& toml);

/// As people write it: "16 KiB" without the quotation marks, other texts as they are. An empty text stays
/// "\"\"".
[[nodiscard]] std::string plain_setting(const std::string& toml);

}  // namespace marti::studies
