// Checks of a TOML text that must precede toml++.
#pragma once

#include <cstddef>
#include <string_view>

namespace marti::sim {

/// The line (from 1) of the first byte beyond ASCII outside of strings and comments; 0 when there is none.
/// TOML allows no such byte, but toml++ 3.3 runs into undefined behaviour when it tests it for white space
/// (is_non_ascii_horizontal_whitespace of most letters). A byte order mark at the beginning does not
/// count.
[[nodiscard]] std::size_t line_beyond_ascii(std::string_view text);

}  // namespace marti::sim
