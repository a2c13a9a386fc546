// The valid name nearest to a misspelt one, for error messages.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace marti::sim {

/// Number of insertions, deletions, replacements and swaps of neighbours that turn `a` into `b` (optimal
/// string alignment). Time and memory are proportional to |a| |b|; names over 200 characters are cut.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The candidate with the least edit distance to `name` (the first on ties), or an empty view when no
/// candidate is near enough to be meant (more than half of `name` would have to change).
std::string_view nearest_name(std::string_view name, std::span<const std::string> candidates);

/// ` (did you mean "x"?)`, or an empty text when no candidate is near.
std::string did_you_mean(std::string_view name, std::span<const std::string> candidates);

}  // namespace marti::sim
