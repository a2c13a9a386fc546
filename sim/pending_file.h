// A file that is written under a temporary name and gets its own when it is complete.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string_view>

#include "sim/descriptor.h"

namespace marti::sim {

enum class Durability {
  cached,  // safe against a crash of the program
  synced,  // also against a crash of the machine: the data are on the disk before the rename
};

/// Makes an empty file under a temporary name, which this object or somebody else (an image library, a
/// database) fills, and which gets its own name by commit(). Without commit() the temporary file is removed.
///
/// The temporary name is random and the file is new: nothing that was there is written through or removed. It
/// is locked (flock) while it is pending; those of the same target that a killed program has left have no
/// such lock, and the next PendingFile of that target removes them.
class PendingFile {
 public:
  /// UserError when the file cannot be made.
  explicit PendingFile(std::filesystem::path target);
  ~PendingFile();
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  /// In the target's directory and with its extension. Whoever writes it must write this very file, not put
  /// another one in its place.
  [[nodiscard]] const std::filesystem::path& temporary() const { return temporary_; }
  /// The file, emptied and open for writing. UserError when it is not there any more.
  [[nodiscard]] Descriptor open() const;
  /// Replaces what the file holds. UserError says why it cannot be done.
  void write(std::string_view content, Durability durability = Durability::cached);
  /// Renames the temporary file. UserError when that cannot be done, or when the name has come to be another
  /// file's.
  void commit();

 private:
  friend void abandon_pending_files();
  [[nodiscard]] bool make();
  void remove() const;
  [[nodiscard]] bool is_ours(const std::filesystem::path& file) const;

  std::filesystem::path target_;
  std::filesystem::path temporary_;
  dev_t device_ = 0;  // which file it is, whatever its name
  ino_t inode_ = 0;
  Descriptor lock_;
  bool committed_ = false;
};

/// Removes the temporary files of every PendingFile, and lets no other be made or committed: for a program
/// that is about to end itself because of a signal. Not for signal handlers.
void abandon_pending_files();

}  // namespace marti::sim
