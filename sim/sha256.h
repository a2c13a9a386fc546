// The hash function SHA-256 (NIST FIPS 180-4). It names contents, as in a content security policy; it
// protects no secrets.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace marti::sim {

/// The digest of the bytes of `message`, first byte first.
[[nodiscard]] std::array<std::uint8_t, 32> sha256(std::string_view message);
/// The digest as 64 hexadecimal digits.
[[nodiscard]] std::string sha256_text(std::string_view message);
/// The digest of a regular file as text; links are not followed. UserError when it cannot be read.
[[nodiscard]] std::string sha256_of_file(const std::filesystem::path& file);

}  // namespace marti::sim
