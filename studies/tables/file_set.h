// The files that a command has written to a directory, as a file beside them names them: which of those there
// are its own and still as it wrote them, so that a later command replaces these and nothing else.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace marti::studies::tables {

struct FileSet {
  std::string of = "{}";  ///< what the files are of: a JSON object, as ordered_json::dump()
  std::map<std::string, std::string> files;    ///< SHA-256 (64 hexadecimal digits) by name
  std::map<std::string, std::string> notes{};  ///< what is in files, by their names, for people and programs
};

/// The set that a JSON file names; empty if there is none that can be read. Names with a directory in them
/// are ignored.
[[nodiscard]] FileSet read_file_set(const std::filesystem::path& file);

/// The JSON: the members of `of`, then "notes" if there are any, and "files".
[[nodiscard]] std::string text_of(const FileSet& set);

/// Whether a file of the directory is in the set and as the set says.
[[nodiscard]] bool is_as_written(const FileSet& set, const std::filesystem::path& directory,
                                 const std::string& name);

/// Removes the files of `earlier` that `now` does not have and that are still as they were written. What
/// cannot be removed stays.
void remove_others(const FileSet& earlier, const FileSet& now, const std::filesystem::path& directory);

}  // namespace marti::studies::tables
