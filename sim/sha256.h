// The hash function SHA-256 (NIST FIPS 180-4). For names of contents, as in a content security policy; it
// keeps no secrets.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace marti::sim {

/// The digest of the bytes of `message`, first byte first.
[[nodiscard]] std::array<std::uint8_t, 32> sha256(std::string_view message);
/// The same, as 64 hexadecimal digits.
[[nodiscard]] std::string sha256_text(std::string_view message);
/// That of a regular file's bytes, of any number; a link is not followed. UserError when it cannot be read.
[[nodiscard]] std::string sha256_of_file(const std::filesystem::path& file);

}  // namespace marti::sim
