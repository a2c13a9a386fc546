// A set of files that appears whole or not at all.
#pragma once

#include <deque>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "sim/pending_file.h"

namespace marti::studies::tables {

/// Files of one directory that get their names together. To be used while a SignalsHeld lives; what is not
/// committed is removed.
class PendingFiles {
 public:
  explicit PendingFiles(std::filesystem::path directory);

  /// The name under which to write `name`.
  const std::filesystem::path& add(const std::string& name);
  /// Throws UserError with the reason, as sim::write_file does.
  void write(const std::string& name, std::string_view content);

  /// The hash (SHA-256, 64 hexadecimal digits) of what each holds now, by name.
  [[nodiscard]] std::map<std::string, std::string> hashes() const;

  /// Renames them all and returns their names, in the order in which they were added. Throws UserError.
  std::vector<std::filesystem::path> commit();
  /// As commit(), with a further file, files.json, that names the others (studies/tables/file_set.h). Files
  /// that the directory's files.json names, that are as it says and that are not among these, are removed.
  std::vector<std::filesystem::path> commit_set();

 private:
  std::filesystem::path directory_;
  std::deque<sim::PendingFile> pending_;  // a PendingFile does not move
  std::vector<std::filesystem::path> names_;
};

}  // namespace marti::studies::tables
