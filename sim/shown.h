// Foreign text in messages: keys, values, names inside files, whatever the input holds.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <string_view>

namespace marti::sim {

/// Characters of a foreign text that a message shows.
inline constexpr std::size_t most_shown = 200;
/// For a text that only has to be made printable.
inline constexpr std::size_t all_shown = std::numeric_limits<std::size_t>::max();

/// The text as one line of printable characters: control characters, line and paragraph separators and marks
/// that turn the direction of writing stand as \n, \t, \u001b or \u202e, bytes that are no UTF-8 as \xff.
/// After `most` characters, counted before they are escaped, it ends in "...". Backslashes stay as they are,
/// so that showing a text that has been shown changes nothing, unless it is cut.
[[nodiscard]] std::string shown(std::string_view text, std::size_t most = most_shown);

}  // namespace marti::sim
