#include "scenes/folder.h"

#include <algorithm>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "scenes/default_view.h"
#include "scenes/open.h"
#include "scenes/source_file.h"
#include "sim/shown.h"

namespace marti::scenes {

namespace {

/// In the order of their names.
std::vector<std::filesystem::path> scene_files(const SourceFile& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  std::filesystem::directory_iterator entry(folder.path(), error);
  for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    if (names_a_file(entry->path().filename().string())) {
      files.push_back(entry->path());
    }
  }
  if (error) {
    folder.fail("the folder cannot be read: " + error.message());
  }
  if (files.empty()) {
    folder.fail("the folder has no file whose name ends in .gltf, .glb, .obj or .ply");
  }
  std::sort(files.begin(), files.end(), [](const auto& a, const auto& b) { return a.native() < b.native(); });
  return files;
}

template <class T>
void append(std::vector<T>& to, std::vector<T>&& from) {
  to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
}

/// A list that is empty or as long as the positions, and its part for more of them.
template <class T>
void append_attribute(std::vector<T>& to, std::size_t before, std::vector<T>&& from, std::size_t more) {
  if (!to.empty() || !from.empty()) {
    to.resize(before, T(0.0));
    from.resize(more, T(0.0));
    append(to, std::move(from));
  }
}

class FolderScene {
 public:
  explicit FolderScene(const SourceFile& folder) : folder_(folder) { scene_.framed = true; }

  void add(Scene part, const FileUse& use, const std::string& name) {
    const auto vertices = static_cast<std::uint32_t>(scene_.positions.size());
    const auto materials = static_cast<std::uint32_t>(scene_.materials.size());
    const auto textures = static_cast<std::uint32_t>(scene_.textures.size());
    const std::uint64_t most = folder_.options().max_triangles;
    if (scene_.triangles.size() + part.triangles.size() > most || vertices + part.positions.size() > most) {
      folder_.fail("its files have more than " + std::to_string(most) +
                   " triangles or vertices, which is more than is accepted");
    }
    folder_.take_memory(host_bytes(part), "its files take");
    for (Triangle& triangle : part.triangles) {
      for (std::uint32_t& vertex : triangle.vertex) {
        vertex += vertices;
      }
      triangle.material += materials;
      triangle.polygon += static_cast<std::uint32_t>(scene_.polygons);
    }
    for (Material& material : part.materials) {
      material.texture += material.texture == no_texture ? 0 : textures;
    }
    if (scene_.framed && !part.framed) {
      scene_.framed = false;
      scene_.camera = part.camera;
      scene_.background = part.background;
      scene_.ambient = part.ambient;
    }
    scene_.lights_are_all = scene_.lights_are_all || part.lights_are_all;
    scene_.polygons += part.polygons;
    append_attribute(scene_.normals, vertices, std::move(part.normals), part.positions.size());
    append_attribute(scene_.uvs, vertices, std::move(part.uvs), part.positions.size());
    append(scene_.positions, std::move(part.positions));
    append(scene_.triangles, std::move(part.triangles));
    append(scene_.materials, std::move(part.materials));
    append(scene_.textures, std::move(part.textures));
    append(scene_.lights, std::move(part.lights));
    for (const std::string& note : part.notes) {
      if (note != no_camera_note) {
        scene_.notes.push_back(name + ": " + note);
      }
    }
    add(use);
  }

  void left_out(std::string name) { without_triangles_.push_back(std::move(name)); }

  [[nodiscard]] AnimatedScene finish() && {
    if (scene_.triangles.empty()) {
      folder_.fail("none of its " + std::to_string(without_triangles_.size()) + " scene files has triangles");
    }
    scene_.name = folder_.path().parent_path().filename().string();
    if (!without_triangles_.empty()) {
      constexpr std::size_t most_names = 8;
      std::string names;
      for (std::size_t i = 0; i < std::min(without_triangles_.size(), most_names); ++i) {
        names += (i == 0 ? "" : ", ") + without_triangles_[i];
      }
      scene_.notes.push_back("Left out: " + std::to_string(without_triangles_.size()) +
                             " files without triangles: " + names +
                             (without_triangles_.size() > most_names ? ", ..." : "") + ".");
    }
    set_view(scene_, folder_.options());
    return AnimatedScene(std::move(scene_), std::move(use_));
  }

 private:
  void add(const FileUse& use) {
    for (const PartUse& part : use.parts) {
      const auto same = std::find_if(use_.parts.begin(), use_.parts.end(),
                                     [&](const PartUse& known) { return known.name == part.name; });
      if (same == use_.parts.end()) {
        use_.parts.push_back(part);
      } else {
        same->all += part.all;
        same->used += part.used;
      }
    }
    use_.unread_bytes += use.unread_bytes;
  }

  const SourceFile& folder_;
  Scene scene_;
  FileUse use_;
  std::vector<std::string> without_triangles_;
};

}  // namespace

AnimatedScene open_folder(const std::filesystem::path& path, const FileOptions& options,
                          const ImageDecoder& decode) {
  const SourceFile folder(path, options);
  FolderScene scene(folder);
  for (const std::filesystem::path& file : scene_files(folder)) {
    OpenOptions part{{}, options};
    part.file.view = {};
    part.file.sky = {};
    part.file.default_light = DefaultLight::never;
    part.file.animation = "none";
    part.file.time = 0.0;
    part.file.memory = folder.memory();
    const std::string name = sim::shown(file.filename().string());
    try {
      const AnimatedScene opened = open_animated(file.string(), part, decode);
      scene.add(opened.at(0.0), opened.file_use(), name);
    } catch (const NoTriangles&) {
      scene.left_out(name);
    }
  }
  return std::move(scene).finish();
}

}  // namespace marti::scenes
