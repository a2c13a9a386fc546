// Files that a program writes for itself only, and that vanish with it, however it ends.
#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <string>

#include "sim/files.h"

namespace marti::studies {

/// Names such files in a directory that other programs may use for theirs, on this computer or on another.
/// Every object holds a lock (flock) while it lives, once it has a file: files whose lock is free belong to a
/// program that was killed, and the next object removes them. Thread-safe.
class SpillFiles {
 public:
  /// Removes what killed programs have left in `directory`, as far as it can. An empty path: no files can be
  /// made.
  explicit SpillFiles(std::filesystem::path directory);
  ~SpillFiles();
  SpillFiles(const SpillFiles&) = delete;
  SpillFiles& operator=(const SpillFiles&) = delete;

  /// The name of a new file, temporary() of what is returned; the file goes with it, or when a signal ends
  /// the program. Throws UserError when the directory cannot be written.
  [[nodiscard]] std::unique_ptr<sim::PendingFile> make();

 private:
  class Lock;
  std::filesystem::path directory_;
  std::mutex mutex_;
  std::unique_ptr<Lock> lock_;
};

}  // namespace marti::studies
