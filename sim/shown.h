// Foreign text in messages: keys, values, names inside files, any content of the input.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <string_view>

namespace marti::sim {

/// The number of characters of a foreign text that a message shows.
inline constexpr std::size_t most_shown = 200;
/// For a text that only has to be made printable, without a limit.
inline constexpr std::size_t all_shown = std::numeric_limits<std::size_t>::max();

/// The text as one line of printable characters. Control characters, line and paragraph separators and
/// bidirectional formatting characters become escapes such as \n, \t, \u001b or \u202e, bytes that are not
/// UTF-8 become \xff. After `most` characters, counted before escaping, the text ends in "...". Backslashes
/// are not escaped, so that showing a shown text again changes nothing, unless it is cut.
[[nodiscard]] std::string shown(std::string_view text, std::size_t most = most_shown);

}  // namespace marti::sim
