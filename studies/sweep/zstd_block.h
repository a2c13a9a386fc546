// Single blocks of bytes, compressed by Zstandard (RFC 8878) with a checksum of their content.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace marti::studies {

/// The same bytes for the same bytes, with one version of the library.
[[nodiscard]] std::string compress_block(std::string_view raw);

/// Throws DamagedBytes unless `compressed` is one block of exactly `raw_size` bytes, before it takes the
/// memory for them.
[[nodiscard]] std::string decompress_block(std::string_view compressed, std::size_t raw_size);

}  // namespace marti::studies
