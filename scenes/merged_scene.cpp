#include "scenes/merged_scene.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <utility>

#include "scenes/append_geometry.h"
#include "scenes/camera_file.h"
#include "scenes/default_view.h"
#include "scenes/pbrt.h"

namespace marti::scenes {

namespace {

template <class T>
void append(std::vector<T>& to, std::vector<T>&& from) {
  to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
}

}  // namespace

MergedScene::MergedScene(const SourceFile& whole) : whole_(whole), part_{{}, whole.options()} {
  scene_.framed = true;
  part_.file.view = {};
  part_.file.sky = {};
  part_.file.default_light = DefaultLight::never;
  part_.file.animation = "none";
  part_.file.time = 0.0;
}

void MergedScene::open(std::string_view spec, const std::filesystem::path& base_directory,
                       const ImageDecoder& decode, const std::string& name, const Placement* placement) {
  part_.base_directory = base_directory;
  part_.file.memory = whole_.memory();  // what the parts before have left of it
  Scene part;
  FileUse use;
  if (names_a_camera(spec)) {
    part.camera = read_camera_file(base_directory / std::filesystem::path(spec), part_.file);
  } else {
    try {
      const AnimatedScene opened = open_animated(spec, part_, decode);
      part = opened.at(0.0);
      use = opened.file_use();
    } catch (const NoTriangles&) {
      without_triangles_.push_back(name);
      return;
    }
  }
  if (spec.ends_with(".pbrt")) {
    const bool mirrored = std::find(part.notes.begin(), part.notes.end(), mirrored_note) != part.notes.end();
    (mirrored ? mirrored_ : not_mirrored_).push_back(name);
  }
  if (placement != nullptr) {
    if (part.gaussians != nullptr) {
      whole_.fail(name + ": Gaussians cannot be placed, because their colours would not turn with them");
    }
    place(*placement, name, part);
  }
  add(std::move(part), name);
  add(use);
}

void MergedScene::add(Scene part, const std::string& name) {
  const auto materials = static_cast<std::uint32_t>(scene_.materials.size());
  const auto textures = static_cast<std::uint32_t>(scene_.textures.size());
  const std::uint64_t most = whole_.options().max_triangles;
  if (!fit_together(scene_, part, most)) {
    whole_.fail("its parts have more than " + std::to_string(most) +
                " primitives of a kind or vertices, which is more than is accepted");
  }
  const auto has_primitives = [](const Scene& scene) {
    return !scene.triangles.empty() || !scene.quadrics.empty();
  };
  if ((part.gaussians != nullptr && (has_primitives(scene_) || !instances_.empty())) ||
      (scene_.gaussians != nullptr && has_primitives(part))) {
    whole_.fail("Gaussians stand in a scene of their own, beside which a list may have a camera only");
  }
  scene_.gaussians = part.gaussians != nullptr ? part.gaussians : scene_.gaussians;
  whole_.take_memory(host_bytes(part), "its parts take");
  for (Material& material : part.materials) {
    for (std::uint32_t* texture : {&material.texture, &material.cut_out.texture}) {
      *texture += *texture == no_texture ? 0 : textures;
    }
  }
  if (scene_.framed && !part.framed) {
    scene_.framed = false;
    scene_.camera = part.camera;
    scene_.background = part.background;
    scene_.ambient = part.ambient;
  }
  scene_.lights_are_all = scene_.lights_are_all || part.lights_are_all;
  instances_.append(scene_, part, materials);
  append(scene_.materials, std::move(part.materials));
  append(scene_.textures, std::move(part.textures));
  append(scene_.lights, std::move(part.lights));
  for (const std::string& note : part.notes) {
    if (note != no_camera_note) {
      scene_.notes.push_back(name + ": " + note);
    }
  }
  ++parts_;
}

AnimatedScene MergedScene::finish(std::string name) && {
  if (scene_.triangles.empty() && scene_.quadrics.empty() && instances_.empty()) {
    whole_.fail("none of its " + std::to_string(parts_ + without_triangles_.size()) + " parts has triangles");
  }
  instances_.finish(scene_);
  scene_.name = std::move(name);
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
  if (!mirrored_.empty() && !not_mirrored_.empty()) {
    scene_.notes.push_back(mirrored_.front() + " is mirrored, and " + not_mirrored_.front() +
                           " is not: they fit together where this one has scale = [-1, 1, 1].");
  }
  set_view(scene_, whole_.options());
  return AnimatedScene(std::move(scene_), std::move(use_));
}

void MergedScene::add(const FileUse& use) {
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

}  // namespace marti::scenes
