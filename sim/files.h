// Reading and writing whole files. A file is written under a temporary name in its own directory and
// renamed when it is complete, so that a reader sees the old file or the new one and never half of one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "sim/pending_file.h"

namespace marti::sim {

/// The bytes of a regular file. A missing or unreadable file, a directory, or more than `max_bytes` bytes
/// is a UserError.
std::string read_file(const std::filesystem::path& file, std::int64_t max_bytes);

/// Writes `content` to `file` in one step. If that fails a UserError says why (no such directory, no
/// permission, disk full, ...); no partial file is left then, and an older file is unchanged.
void write_file(const std::filesystem::path& file, std::string_view content,
                Durability durability = Durability::cached);

}  // namespace marti::sim
