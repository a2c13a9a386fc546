// The hash function SHA-256 (NIST FIPS 180-4). For names of contents, as in a content security policy; it
// keeps no secrets.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace marti::sim {

/// The digest of the bytes of `message`, first byte first.
[[nodiscard]] std::array<std::uint8_t, 32> sha256(std::string_view message);

}  // namespace marti::sim
