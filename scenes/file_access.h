// Internal to scenes/: the files that a scene's file may refer to.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "sim/memory_budget.h"

namespace marti::scenes {

/// Allows files in the folder of the scene and below, after all links are resolved. A name that leads
/// elsewhere (by "..", by a symbolic link, an absolute path or a scheme such as "file:") is refused, and so
/// is a file that is too large for the budget.
class FileAccess {
 public:
  /// `directory` is the scene's folder; the budget must outlive this object. No file may exceed `max_bytes`.
  /// `kind` says in messages what the names are: "URI".
  FileAccess(const std::filesystem::path& directory, std::uint64_t max_bytes, sim::MemoryBudget& memory,
             const char* kind);

  /// The scene's folder, with a slash at the end; names of files begin with it.
  [[nodiscard]] const std::string& directory() const { return directory_; }
  /// Whether the file exists and may be read.
  [[nodiscard]] bool may_read(const std::string& name);
  /// The bytes of a file that may be read. False if that fails; `error` or refusal() says why.
  [[nodiscard]] bool read(const std::string& name, std::string& bytes, std::string& error);
  /// Why a file was refused, as one sentence; empty when none was.
  [[nodiscard]] const std::string& refusal() const { return refusal_; }

 private:
  std::string directory_;
  std::filesystem::path root_;  // the folder without links
  std::uint64_t max_bytes_;
  sim::MemoryBudget& memory_;
  const char* kind_;
  std::string refusal_;
};

/// Foreign text in quotation marks and in ASCII, with unprintable characters escaped, cut off after 200
/// characters.
[[nodiscard]] std::string double_quoted(std::string_view text);

}  // namespace marti::scenes
