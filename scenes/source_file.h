// Internal to scenes/: a scene's file while it is read: its path, what its reader was told, the memory that
// is left, and the form of the messages about it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "scenes/file_options.h"
#include "sim/error.h"
#include "sim/memory_budget.h"

namespace marti::scenes {

/// The file is well, but has no triangles.
class NoTriangles : public sim::UserError {
 public:
  using UserError::UserError;
};

class SourceFile {
 public:
  SourceFile(std::filesystem::path path, const FileOptions& options);

  [[nodiscard]] const FileOptions& options() const { return options_; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] sim::MemoryBudget& memory() const { return memory_; }

  /// The file's bytes; takes as much memory as `copies` of them need. Throws UserError.
  [[nodiscard]] std::string read(std::uint64_t copies) const;

  /// Takes `bytes` from the memory. Throws UserError when less is left; `what` begins the sentence, as "its
  /// textures take". Only for the thread that opens the file.
  void take_memory(std::uint64_t bytes, const char* what) const;
  /// Checks for memory that is soon freed again: as take_memory(), but takes nothing.
  void require_memory(std::uint64_t bytes, const char* what) const;

  /// Throws a UserError that begins with the file's path.
  [[noreturn]] void fail(const std::string& what) const;
  /// Throws NoTriangles.
  [[noreturn]] void fail_empty(const std::string& what = "the scene has no triangles") const;
  /// Throws a PartError: the file lacks the part (scenes/part_error.h) that the options ask for.
  [[noreturn]] void fail_choice(const char* part, const std::string& what) const;

 private:
  std::filesystem::path path_;
  FileOptions options_;
  mutable sim::MemoryBudget memory_;
};

/// Takes the memory of lists step by step while they grow.
class GrowingMemory {
 public:
  GrowingMemory(const SourceFile& file, const char* what) : file_(file), what_(what) {}
  /// Some list has grown by `bytes`; up to as many again may lie unused behind its end.
  void grow(std::uint64_t bytes) {
    pending_ += 2 * bytes;
    if (pending_ >= step) {
      file_.take_memory(pending_, what_);
      pending_ = 0;
    }
  }

 private:
  static constexpr std::uint64_t step = std::uint64_t{1} << 16U;
  const SourceFile& file_;
  const char* what_;
  std::uint64_t pending_ = 0;
};

}  // namespace marti::scenes
