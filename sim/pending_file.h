// A file that is written under a temporary name and gets its final name when it is complete.
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

/// Makes an empty file under a temporary name, which this object or other code (an image library, a database)
/// fills; commit() gives it its final name. Without commit() the temporary file is removed.
///
/// The temporary name is random and the file is new, so no existing file is overwritten or removed. The file
/// is locked (flock) while it is pending; leftovers of a killed program have no lock, and the next
/// PendingFile of the same target removes them.
class PendingFile {
 public:
  /// UserError when the file cannot be made, or when the target is there and is no regular file.
  explicit PendingFile(std::filesystem::path target);
  ~PendingFile();
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  /// A name in the target's directory with the target's extension. Other code must write to this file and not
  /// replace it by another.
  [[nodiscard]] const std::filesystem::path& temporary() const { return temporary_; }
  /// The file, emptied and open for writing. UserError if it does not exist any more.
  [[nodiscard]] Descriptor open() const;
  /// Replaces the file's content. UserError says why if that fails.
  void write(std::string_view content, Durability durability = Durability::cached);
  /// Renames the temporary file to the target. UserError if that fails, or if another file has taken the
  /// temporary name.
  void commit();

 private:
  friend void abandon_pending_files();
  [[nodiscard]] bool make();
  void remove() const;
  [[nodiscard]] bool is_ours(const std::filesystem::path& file) const;

  std::filesystem::path target_;
  std::filesystem::path temporary_;
  dev_t device_ = 0;  // with the inode: the identity of the file, whatever its name
  ino_t inode_ = 0;
  Descriptor lock_;
  bool committed_ = false;
};

/// Removes the temporary files of every PendingFile and blocks all further ones: for a program that is about
/// to end itself because of a signal. Must not be called from a signal handler.
void abandon_pending_files();

}  // namespace marti::sim
