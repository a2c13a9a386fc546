// The files that this process has read as a user's input: configurations and scenes. No result may replace
// one of them, because the next run would then read something else.
#pragma once

#include <filesystem>
#include <string>

namespace marti::sim {

/// Notes a file that has been read. Thread-safe, as is refuse_input().
void note_input(const std::filesystem::path& file);

/// A digest of the names, sizes and times of change of all that were noted. Thread-safe.
[[nodiscard]] std::string inputs_digest();

/// Throws UserError if `target` is a file that was noted, whatever its name.
void refuse_input(const std::filesystem::path& target);

}  // namespace marti::sim
