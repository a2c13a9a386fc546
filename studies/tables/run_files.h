// The files that a run writes beside its result.json: which they are, and whether they are still its own.
#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>

#include "studies/tables/run_json.h"

namespace marti::studies::tables {

/// Every name that such a file can have. None has a directory in it.
[[nodiscard]] std::span<const std::string_view> run_file_names();

/// Hashes (SHA-256, 64 hexadecimal digits) by name, as a result has them under "files"; entries with another
/// name, or whose value is not a text, are ignored.
[[nodiscard]] std::map<std::string, std::string> files_of(const RunJson& run);

/// The files of the run that `directory` holds now; empty without a readable result.json. For a result from
/// before hashes were introduced: every file with such a name that exists, each with an empty hash.
[[nodiscard]] std::map<std::string, std::string> files_of_run_in(const std::filesystem::path& directory);

/// Removes a file of an earlier run if it is still what that run wrote. What cannot be removed stays.
void remove_run_file(const std::filesystem::path& file, const std::string& hash);

}  // namespace marti::studies::tables
