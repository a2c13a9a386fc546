// What has to be known of a TOML text before toml++ may see it.
#pragma once

#include <cstddef>
#include <string_view>

namespace marti::sim {

/// The line (from 1) of the first byte beyond ASCII outside of strings and comments; 0 when there is none.
/// TOML allows none there, but toml++ 3.3 runs into what it declares unreachable when it asks whether one is
/// white space (is_non_ascii_horizontal_whitespace of most letters). A byte order mark at the beginning does
/// not count.
[[nodiscard]] std::size_t line_beyond_ascii(std::string_view text);

}  // namespace marti::sim
