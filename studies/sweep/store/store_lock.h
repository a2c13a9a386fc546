// At most one process writes a store.
#pragma once

#include <filesystem>
#include <string>

#include "sim/descriptor.h"

namespace marti::studies::sweep {

/// Holds the file `store` + ".lock" while it lives. The lock is the operating system's (flock), so it ends
/// with the process that holds it, however that ends; the text in the file is only for people.
class StoreLock {
 public:
  /// Throws UserError when another process holds it, when the file cannot be made, and when the file of that
  /// name is not a lock but a link, a pipe or a file of something else, which is not touched.
  explicit StoreLock(const std::filesystem::path& store);
  ~StoreLock();
  StoreLock(const StoreLock&) = delete;
  StoreLock& operator=(const StoreLock&) = delete;

 private:
  std::filesystem::path file_;
  sim::Descriptor descriptor_;
};

/// The name of this computer, as it stands in locks and stores.
[[nodiscard]] std::string host_name();

}  // namespace marti::studies::sweep
