// The directory where logs are kept for the next sweep.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "studies/sweep/log_file.h"

namespace marti::studies {

/// Any number of programs may use one directory at a time: a file is written under another name and then
/// renamed, and equal keys mean equal logs.
class LogCache {
 public:
  /// Makes the directory and removes half-written files of programs that were killed, as far as it can.
  /// Throws UserError when it cannot be made.
  explicit LogCache(std::filesystem::path directory);

  [[nodiscard]] std::filesystem::path file_of(const std::string& key) const;
  /// Writes the file, in place of an older one. Throws UserError when it cannot be written.
  void keep(const std::string& key, const FrameLog& log) const;

 private:
  std::filesystem::path directory_;
};

}  // namespace marti::studies
