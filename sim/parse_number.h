// Numbers in texts that hold nothing else.
#pragma once

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>

namespace marti::sim {

/// The number that the whole text is, as std::from_chars() reads it: no blanks, no "+"; std::nullopt if the
/// text is anything else or the number does not fit in a Number.
template <class Number>
[[nodiscard]] std::optional<Number> parse_number(std::string_view text) {
  Number number{};
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  return error == std::errc{} && stop == end ? std::optional(number) : std::nullopt;
}

}  // namespace marti::sim
