// At most one process writes a store.
#pragma once

#include <filesystem>

namespace marti::studies {

/// Holds the file `store` + ".lock" while it lives. The lock is the operating system's (flock), so that it is
/// gone with the process that held it, however that ended; what the file says is only for people.
class StoreLock {
 public:
  /// Throws UserError when another process holds it, when the file cannot be made, and when what has its name
  /// is no lock: a link, a pipe, a file of something else. That is not touched.
  explicit StoreLock(const std::filesystem::path& store);
  ~StoreLock();
  StoreLock(const StoreLock&) = delete;
  StoreLock& operator=(const StoreLock&) = delete;

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
};

}  // namespace marti::studies
