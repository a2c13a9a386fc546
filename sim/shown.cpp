#include "sim/shown.h"

#include <array>
#include <cstdint>

namespace marti::sim {

namespace {

struct Character {
  std::uint32_t code = 0;
  std::size_t bytes = 0;  // 0: the text does not begin with a character
};

// The character that the text begins with, by the table of well-formed sequences of the Unicode Standard
// (version 15, table 3-7).
Character first_of(std::string_view text) {
  const auto byte = [&](std::size_t at) {
    return at < text.size() ? static_cast<std::uint32_t>(static_cast<unsigned char>(text[at])) : 0U;
  };
  const std::uint32_t lead = byte(0);
  if (lead < 0x80) {
    return {lead, 1};
  }
  const std::size_t bytes = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  if (lead < 0xc2 || lead > 0xf4) {
    return {};
  }
  std::uint32_t code = lead & (0x7fU >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xc0U) != 0x80U) {
      return {};
    }
    code = code << 6U | (byte(i) & 0x3fU);
  }
  constexpr std::array<std::uint32_t, 5> least = {0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xd800 && code <= 0xdfff;
  return code < least[bytes] || code > 0x10ffff || surrogate ? Character{} : Character{code, bytes};
}

// C0 and C1 controls, line and paragraph separators, and bidirectional formatting characters.
bool unprintable(std::uint32_t code) {
  return code < 0x20 || (code >= 0x7f && code < 0xa0) || code == 0x200e || code == 0x200f ||
         (code >= 0x2028 && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069) || code == 0xfeff;
}

void append_hex(std::string& to, std::uint32_t number, unsigned digits) {
  for (unsigned shift = 4 * digits; shift > 0; shift -= 4) {
    to += "0123456789abcdef"[number >> (shift - 4) & 15U];
  }
}

}  // namespace

std::string shown(std::string_view text, std::size_t most) {
  std::string printable;
  printable.reserve(text.size());
  for (std::size_t count = 0; !text.empty(); ++count) {
    if (count == most) {
      return printable + "...";
    }
    const Character character = first_of(text);
    if (character.bytes == 0) {
      printable += "\\x";
      append_hex(printable, static_cast<unsigned char>(text.front()), 2);
    } else if (character.code == '\n' || character.code == '\t' || character.code == '\r') {
      printable += character.code == '\n' ? "\\n" : character.code == '\t' ? "\\t" : "\\r";
    } else if (unprintable(character.code)) {
      printable += "\\u";
      append_hex(printable, character.code, 4);
    } else {
      printable += text.substr(0, character.bytes);
    }
    text.remove_prefix(character.bytes == 0 ? 1 : character.bytes);
  }
  return printable;
}

}  // namespace marti::sim
