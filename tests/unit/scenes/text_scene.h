// Scene files that tests write as text, and how they are refused.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "scenes/open.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"

namespace marti::scenes::testing {

/// An OBJ file of one triangle.
inline const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// A folder for files of one test.
class SceneFolder {
 public:
  /// Writes a file and returns its path.
  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    std::filesystem::create_directories((path() / name).parent_path());
    std::ofstream(path() / name, std::ios::binary) << bytes;
    return path() / name;
  }
  [[nodiscard]] std::filesystem::path path() const { return outer_.path() / "scene"; }
  [[nodiscard]] std::filesystem::path outside() const { return outer_.path(); }

  /// Writes a file and opens it.
  [[nodiscard]] Scene open(const std::string& name, const std::string& bytes, const FileOptions& options = {},
                           const ImageDecoder& decode = {}) const {
    return open_scene(write(name, bytes).string(), {{}, options}, decode);
  }
  /// The message that refuses it, without the folder's path; "no UserError" if it is not refused.
  [[nodiscard]] std::string refusal(const std::string& name, const std::string& bytes,
                                    const FileOptions& options = {}, const ImageDecoder& decode = {}) const {
    const std::string message =
        test::user_error_of([&] { static_cast<void>(open(name, bytes, options, decode)); });
    const std::string folder = path().string() + "/";
    return message.starts_with(folder) ? message.substr(folder.size()) : message;
  }

 private:
  test::TemporaryDirectory outer_;
};

}  // namespace marti::scenes::testing
