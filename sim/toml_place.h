// Where in a TOML text a fault is, in words that its author knows: toml++ says line and column only.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace marti::sim {

/// The byte at which a line and a column (both from 1, columns in characters of UTF-8) begin, at most the
/// text's size.
[[nodiscard]] std::size_t byte_of(std::string_view text, std::size_t line, std::size_t column);

/// The name of the key that a reader of the text is at when it has read `end` bytes, as it is written, with
/// the names of its tables before it: "cache.size". In the head of a table it is the table's. Empty where
/// neither has begun. The text up to there need not be valid.
[[nodiscard]] std::string name_at(std::string_view text, std::size_t end);

}  // namespace marti::sim
