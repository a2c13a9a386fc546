// A choice of nodes as one types it.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace marti::studies::run {

/// "0-3", "5", "0,2,8-9": node numbers and ranges with both ends, ascending and without doubles; empty: all
/// of `nodes`. Throws UserError naming what is wrong.
[[nodiscard]] std::vector<std::uint32_t> parse_nodes(std::string_view text, std::uint32_t nodes);

/// The same nodes as such a text, "0-3,8", ascending.
[[nodiscard]] std::string text_of_nodes(std::span<const std::uint32_t> nodes);

}  // namespace marti::studies::run
