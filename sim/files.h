// Reading and writing whole files. A file is written under a temporary name in its own directory and
// renamed when it is complete, so that a reader sees the old file or the new one and never half of one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace marti::sim {

enum class Durability {
  cached,  // safe against a crash of the program
  synced,  // also against a crash of the machine: the data are on the disk before the rename
};

/// The bytes of a regular file. A missing or unreadable file, a directory, or more than `max_bytes` bytes
/// is a UserError.
std::string read_file(const std::filesystem::path& file, std::int64_t max_bytes);

/// Writes `content` to `file` in one step. A UserError says why it cannot be done (no such directory, no
/// permission, disk full, ...); nothing is left behind then, and an older file stays as it was.
void write_file(const std::filesystem::path& file, std::string_view content,
                Durability durability = Durability::cached);

/// Makes a directory with its parents, if it is not there. UserError when that cannot be done.
void make_directory(const std::filesystem::path& directory);

/// A file that somebody else writes (an image library, a database) under a temporary name, and that gets
/// its own name by commit(). Without commit() the temporary file is removed.
class PendingFile {
 public:
  explicit PendingFile(std::filesystem::path target);
  ~PendingFile();
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  /// In the target's directory and with its extension; unique among running processes.
  [[nodiscard]] const std::filesystem::path& temporary() const { return temporary_; }
  /// Renames the temporary file. UserError when that cannot be done.
  void commit();

 private:
  std::filesystem::path target_;
  std::filesystem::path temporary_;
  bool committed_ = false;
};

/// Removes the temporary files of every PendingFile, and lets no other be made or committed: for a program
/// that is about to end itself because of a signal. Not for signal handlers.
void abandon_pending_files();

}  // namespace marti::sim
