// Internal to scenes/: the files that a glTF file may refer to, for tinygltf's callbacks.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include <tiny_gltf.h>

#include "sim/memory_budget.h"

namespace marti::scenes::gltf {

/// Allows files in the folder of the scene and below, after all links are resolved. A URI that leads
/// elsewhere (by "..", also as "%2e%2e", by a symbolic link, an absolute path or a scheme such as "file:") is
/// refused, and so is a file that is too large for the budget.
class FileAccess {
 public:
  /// `directory` is the scene's folder; the budget must outlive this object. No file may exceed `max_bytes`.
  FileAccess(const std::filesystem::path& directory, std::uint64_t max_bytes, sim::MemoryBudget& memory);

  /// The scene's folder, with a slash at the end.
  [[nodiscard]] const std::string& directory() const { return directory_; }
  /// The callbacks for tinygltf. They refer to this object.
  [[nodiscard]] tinygltf::FsCallbacks callbacks();
  /// Why a file was refused, as one sentence; empty when none was.
  [[nodiscard]] const std::string& refusal() const { return refusal_; }

 private:
  bool may_read(const std::string& name);
  bool read(const std::string& name, std::vector<unsigned char>& bytes, std::string& error);

  std::string directory_;
  std::filesystem::path root_;  // the folder without links
  std::uint64_t max_bytes_;
  sim::MemoryBudget& memory_;
  std::string refusal_;
};

/// Foreign text in quotation marks and in ASCII, with unprintable characters escaped, cut off after 200
/// characters.
[[nodiscard]] std::string shown(std::string_view text);

}  // namespace marti::scenes::gltf
