// A directory for results that does not stay behind when no result came.
#pragma once

#include <filesystem>
#include <vector>

namespace marti::sim {

/// Makes a directory with its parents where they do not exist. At the end of its life those that it made and
/// that are still empty are removed, so that a command that is refused leaves nothing behind.
class MadeDirectory {
 public:
  /// With nothing to remove.
  MadeDirectory() = default;
  /// UserError if it cannot be made.
  explicit MadeDirectory(const std::filesystem::path& directory);
  ~MadeDirectory();
  MadeDirectory(MadeDirectory&&) = default;
  MadeDirectory& operator=(MadeDirectory&&) = delete;
  MadeDirectory(const MadeDirectory&) = delete;
  MadeDirectory& operator=(const MadeDirectory&) = delete;

 private:
  std::vector<std::filesystem::path> made_;  // the innermost first
};

}  // namespace marti::sim
