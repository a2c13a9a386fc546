// The lists of all figures and of all keys.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>
#include <string_view>

#include "sim/schema.h"

namespace marti::studies::show {

[[nodiscard]] std::string list_figures_as_text();
[[nodiscard]] std::string list_figures_as_markdown();

/// `only`: the name of a key or section; empty: all. Throws UserError when there is none of this name.
[[nodiscard]] std::string keys_as_text(const sim::Schema& schema, std::string_view only);
/// A list of objects with name, type, list, default, minimum, maximum, choices, unit and meaning; sizes in
/// bytes, durations in ps, frequencies in Hz, percentages as fractions.
[[nodiscard]] std::string keys_as_json(const sim::Schema& schema, std::string_view only);

/// A limit of a key's range as JSON; null for none.
[[nodiscard]] nlohmann::ordered_json json_of_bound(const std::optional<sim::Value>& bound);

}  // namespace marti::studies::show
