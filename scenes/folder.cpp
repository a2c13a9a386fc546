#include "scenes/folder.h"

#include <algorithm>
#include <string>
#include <system_error>
#include <vector>

#include "scenes/file_access.h"
#include "scenes/merged_scene.h"
#include "scenes/open.h"
#include "scenes/source_file.h"
#include "sim/shown.h"

namespace marti::scenes {

namespace {

/// In the order of their names, without hidden files.
std::vector<std::filesystem::path> scene_files(const SourceFile& folder) {
  std::vector<std::filesystem::path> files;
  FileAccess access(folder.path(), folder.options().max_file_bytes, folder.memory(), "file");
  std::error_code error;
  std::filesystem::directory_iterator entry(folder.path(), error);
  for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    // A pbrt file is a whole scene, or a part of one that another file includes.
    const std::string name = entry->path().filename().string();
    if (names_a_file(name) && entry->path().extension() != ".pbrt" && !name.starts_with('.') &&
        access.may_read(access.directory() + name)) {
      files.push_back(entry->path());
    }
    if (!access.refusal().empty()) {
      folder.fail(access.refusal());
    }
    if (files.size() > most_parts) {
      folder.fail("the folder has more than " + std::to_string(most_parts) +
                  " scene files, which is more than is accepted");
    }
  }
  if (error) {
    folder.fail("the folder cannot be read: " + error.message());
  }
  if (files.empty()) {
    folder.fail("the folder has no file whose name ends in .gltf, .glb, .obj, .ply or .camera");
  }
  std::sort(files.begin(), files.end(), [](const auto& a, const auto& b) { return a.native() < b.native(); });
  return files;
}

}  // namespace

AnimatedScene open_folder(const std::filesystem::path& path, const FileOptions& options,
                          const ImageDecoder& decode) {
  const SourceFile folder(path, options);
  MergedScene scene(folder);
  for (const std::filesystem::path& file : scene_files(folder)) {
    scene.open(file.string(), {}, decode, sim::shown(file.filename().string()));
  }
  return std::move(scene).finish(path.parent_path().filename().string());
}

}  // namespace marti::scenes
