// What every refusal of a configuration must be: one printable line of bounded length that begins with the
// file, the line and the key, or with the --set option.
#pragma once

#include <algorithm>
#include <charconv>
#include <string>
#include <string_view>

#include "sim/shown.h"
#include "target.h"

namespace marti::fuzz {

/// Bytes of the longest refusal: its own text and up to three foreign texts of 200 characters, each
/// of up to six bytes (sim/shown.h).
inline constexpr std::size_t longest_refusal = 4096;

struct Refusal {
  int line = 0;      ///< 0: set by an option, or a default
  bool set = false;  ///< begins with --set
  std::string key;   ///< empty if the line of the file has no key
};

/// Takes the message apart, and breaks a promise where it is not as it must be. `file` is the
/// configuration's name.
inline Refusal refusal_of(const std::string& message, std::string_view file) {
  const bool plain = std::all_of(message.begin(), message.end(),
                                 [](char c) { return static_cast<unsigned char>(c) >= 0x20 && c != 0x7f; });
  promise(plain && sim::shown(message, sim::all_shown) == message, "not printable: " + message);
  promise(message.size() <= longest_refusal, "too long: " + message);
  Refusal refusal;
  std::string_view rest = message;
  if (rest.starts_with("--set ")) {
    refusal.set = true;
    rest.remove_prefix(6);
    refusal.key = rest.substr(0, std::min(rest.find('='), rest.find(": ")));
    return refusal;
  }
  promise(rest.starts_with(file), "without a place: " + message);
  rest.remove_prefix(file.size());
  if (rest.starts_with(':') && !rest.starts_with(": ")) {
    const auto [end, error] = std::from_chars(rest.data() + 1, rest.data() + rest.size(), refusal.line);
    promise(error == std::errc{} && refusal.line > 0, "without a line: " + message);
    rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
    if (rest.starts_with(':') && !rest.starts_with(": ")) {  // errors in TOML have a column
      rest.remove_prefix(std::min(rest.find(": "), rest.size()));
    }
  }
  promise(rest.starts_with(": "), "without a place: " + message);
  rest.remove_prefix(2);
  const std::string_view key = rest.substr(0, rest.find(": "));
  refusal.key = key.size() < rest.size() ? key : std::string_view();
  promise(refusal.line > 0 || !refusal.key.empty(), "without line and key: " + message);
  return refusal;
}

}  // namespace marti::fuzz
