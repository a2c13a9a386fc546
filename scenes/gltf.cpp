#include "scenes/gltf.h"

#include <algorithm>
#include <cstddef>
#include <new>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

#include "scenes/animated.h"
#include "scenes/default_view.h"
#include "scenes/gltf_animation.h"
#include "scenes/gltf_extensions.h"
#include "scenes/gltf_instances.h"
#include "scenes/gltf_kept.h"
#include "scenes/gltf_material.h"
#include "scenes/gltf_mesh.h"
#include "scenes/gltf_model.h"
#include "scenes/gltf_nodes.h"
#include "scenes/gltf_skin.h"
#include "scenes/gltf_use.h"
#include "scenes/gltf_vertices.h"
#include "scenes/gltf_view.h"
#include "scenes/merged_instances.h"
#include "scenes/scene_notes.h"
#include "sim/error.h"
#include "sim/shown.h"

namespace marti::scenes {

namespace {

using gltf::Model;
using gltf::Pose;

void note_extensions(const Model& model, Scene& scene) {
  const std::string names = gltf::ignored_extensions(model.data());
  if (!names.empty()) {
    scene.notes.push_back("Optional glTF extensions are ignored: " + names + ".");
  }
}

/// Reads what the exporter stores in `extras`: background, ambient light, and whether any light is missing.
void read_own_surroundings(const Model& model, Scene& scene) {
  if (const tinygltf::Value* own = gltf::own_extras(model.data().extras)) {
    scene.background = gltf::color_in(*own, "background", 0.0, 1e9).value_or(scene.background);
    scene.ambient = gltf::color_in(*own, "ambient", 0.0, 1e9).value_or(scene.ambient);
    scene.lights_are_all = own->Has("lights_are_all") && own->Get("lights_are_all").IsBool() &&
                           own->Get("lights_are_all").Get<bool>();
  }
}

std::string seconds_text(double seconds) {
  std::ostringstream text;
  text << seconds << " s";
  return text.str();
}

/// Shrinks triangles with a bad corner to a good corner, if need be another triangle's; returns how many.
std::uint64_t shrink_bad_triangles(const Model& model, const std::vector<char>& bad, Scene& scene) {
  const auto good_corner = [&bad](const Triangle& triangle) {
    return std::find_if(triangle.vertex.begin(), triangle.vertex.end(),
                        [&bad](std::uint32_t vertex) { return bad[vertex] == 0; });
  };
  const auto is_good = [&bad](const Triangle& triangle) {
    return std::all_of(triangle.vertex.begin(), triangle.vertex.end(),
                       [&bad](std::uint32_t vertex) { return bad[vertex] == 0; });
  };
  const auto good = std::find_if(scene.triangles.begin(), scene.triangles.end(), is_good);
  if (good == scene.triangles.end()) {
    model.fail("none of its triangles has finite positions");
  }
  const std::uint32_t anywhere = good->vertex[0];
  std::uint64_t count = 0;
  for (Triangle& triangle : scene.triangles) {
    if (!is_good(triangle)) {
      const auto* const corner = good_corner(triangle);
      triangle.vertex.fill(corner == triangle.vertex.end() ? anywhere : *corner);
      ++count;
    }
  }
  return count;
}

/// A glTF file as a scene over time. The static pose decides which triangles there are; the pose at time 0
/// decides where the default camera or light is placed if the file has none.
class GltfPoses : public PoseSource {
 public:
  GltfPoses(const std::filesystem::path& path, const FileOptions& options, const ImageDecoder& decode)
      : model_(path, options) {
    guarded([&] { build(decode); });
  }

  [[nodiscard]] bool moves() const override { return animation_.has_value(); }

  [[nodiscard]] Scene at(double seconds) const override {
    Scene scene;
    guarded([&] {
      if (!animation_) {
        scene = still_;
        return;
      }
      try {
        scene = posed(seconds);
      } catch (const sim::UserError& error) {
        throw sim::UserError(std::string(error.what()) + " (at " + seconds_text(seconds) + " of animation '" +
                             sim::shown(animation_->name()) + "')");
      }
    });
    return scene;
  }

  [[nodiscard]] double duration() const override { return animation_ ? animation_->duration() : 0.0; }

  [[nodiscard]] MotionFacts facts() const override {
    MotionFacts facts;
    facts.chosen = chosen_;
    facts.skins = skins_->size();
    facts.morph_targets = morph_targets_;
    std::uint64_t numbers = 0;
    guarded([&] {
      for (std::size_t i = 0; i < model_.data().animations.size(); ++i) {
        const gltf::Animation animation(model_, static_cast<int>(i));
        numbers += animation.size();
        if (numbers > model_.options().max_triangles) {
          model_.fail("its animations have more than " + std::to_string(model_.options().max_triangles) +
                      " key frames and values, which is more than is described");
        }
        facts.animations.push_back({animation.name(), animation.duration(), animation.channels()});
      }
    });
    return facts;
  }

  [[nodiscard]] FileUse file_use() const override { return use_; }

 private:
  template <typename Work>
  void guarded(const Work& work) const {
    try {
      work();
    } catch (const std::bad_alloc&) {
      model_.fail("there is not enough memory for its scene");
    }
  }

  void build(const ImageDecoder& decode) {
    chosen_ = gltf::chosen_animation(model_);
    if (chosen_ >= 0) {
      animation_.emplace(model_, chosen_);
    }
    still_.name = model_.path().filename().string();
    LeftOut left_out = model_.replaced();
    nodes_ = gltf::nodes_of_scene(model_, left_out);
    skins_.emplace(model_, nodes_);
    Pose pose;
    pose.nodes = gltf::place_nodes(model_, nodes_, {});
    gltf::KeptMeshes& kept = kept_.emplace(model_, nodes_, pose);
    const gltf::Expanded expanded = gltf::expanded_instances(model_, kept.distinct(nodes_));
    model_.take_memory(expanded.bytes(), "its instances take");
    still_.positions.reserve(expanded.vertices);
    still_.triangles.reserve(expanded.triangles);
    gltf::Materials materials(model_, decode, still_, left_out);
    gltf::MeshReader meshes(model_, materials, *skins_, still_, left_out);
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      if (nodes_[i].mesh >= 0 && !kept.keeps(i)) {
        meshes.add(i, pose);
      }
    }
    if (animation_) {
      instances_ = meshes.instances();
      ranges_ = meshes.ranges();
    }
    kept.add(meshes, pose, still_);
    if (still_.triangles.empty()) {
      if (meshes.bad_triangles() == 0) {
        model_.fail_empty();
      }
      model_.fail("none of its triangles has finite positions");
    }
    if (!still_.normals.empty()) {
      still_.normals.resize(still_.positions.size(), glm::dvec3(0.0));
    }
    if (!still_.uvs.empty()) {
      still_.uvs.resize(still_.positions.size(), glm::dvec2(0.0));
    }
    morph_targets_ = meshes.morph_targets();
    read_own_surroundings(model_, still_);
    if (animation_) {
      pose = pose_at(0.0);
    }
    look(pose, left_out);
    use_ = gltf::use_of(model_, nodes_, materials,
                        {skins_->size(), animation_ ? 1U : 0U, has_camera_ ? 1U : 0U});
    if (model_.options().read_unused) {
      gltf::read_unused(model_, materials);
    }
    note_extensions(model_, still_);
    note_instances(still_);
    note_left_out(left_out, still_);
    note_bad_positions(meshes.bad_triangles(), "triangles", still_);
    if (animation_) {
      still_.notes.push_back("Animation '" + sim::shown(animation_->name()) + "' plays for " +
                             seconds_text(animation_->duration()) + ".");
    } else {
      if (!model_.data().animations.empty()) {
        still_.notes.emplace_back("The file is animated; this is its static pose.");
      }
      note_degenerate(still_);
    }
  }

  /// Sets camera and lights, with default ones if the file has none and the options ask for them; those do
  /// not move.
  void look(const Pose& pose, LeftOut& left_out) {
    has_camera_ = gltf::set_camera(model_, pose.nodes, still_);
    if (!has_camera_) {
      Scene first = still_;
      place_vertices(pose, first);
      frame_camera(model_.options().view, first);
      still_.camera = first.camera;
      still_.framed = true;
      if (!model_.options().view.eye) {
        still_.notes.emplace_back(no_camera_note);
      }
    }
    apply_view(model_.options().view, still_);
    gltf::add_lights(model_, pose.nodes, still_, left_out);
    own_lights_ = still_.lights.size();
    add_light(still_, model_.options());
  }

  [[nodiscard]] Pose pose_at(double seconds) const {
    Pose pose;
    pose.changes = animation_->at(seconds);
    pose.nodes = gltf::place_nodes(model_, nodes_, pose.changes);
    for (std::size_t i = 0; i < skins_->size(); ++i) {
      pose.joints.push_back(skins_->matrices(i, pose.nodes));
    }
    return pose;
  }

  /// Places the vertices and instances of a pose. Returns the number of triangles that had to shrink.
  std::uint64_t place_vertices(const Pose& pose, Scene& scene) const {
    std::vector<char> bad(scene.positions.size(), 0);
    for (const gltf::VertexInstance& instance : instances_) {
      gltf::pose_vertices(instance, pose, scene, bad);
    }
    for (const gltf::TriangleRange& range : ranges_) {
      if (gltf::is_mirrored(pose.nodes[range.place].world) != range.mirrored) {
        for (std::uint32_t i = 0; i < range.count; ++i) {
          std::swap(scene.triangles[range.first + i].vertex[1], scene.triangles[range.first + i].vertex[2]);
        }
      }
    }
    kept_->move(pose, scene);
    const bool all_good = std::all_of(bad.begin(), bad.end(), [](char vertex) { return vertex == 0; });
    return all_good ? 0 : shrink_bad_triangles(model_, bad, scene);
  }

  [[nodiscard]] Scene posed(double seconds) const {
    Scene scene = still_;
    const Pose pose = pose_at(seconds);
    const std::uint64_t shrunk = place_vertices(pose, scene);
    if (has_camera_) {
      static_cast<void>(gltf::set_camera(model_, pose.nodes, scene));
      apply_view(model_.options().view, scene);
    }
    if (own_lights_ > 0) {
      scene.lights.clear();
      LeftOut noted_already = model_.replaced();
      gltf::add_lights(model_, pose.nodes, scene, noted_already);
      const auto added = still_.lights.begin() + static_cast<std::ptrdiff_t>(own_lights_);
      scene.lights.insert(scene.lights.end(), added, still_.lights.end());
    }
    if (shrunk > 0) {
      scene.notes.push_back(std::to_string(shrunk) +
                            " triangles are shrunk to a point in this pose, because a position is not finite "
                            "or beyond 1e30.");
    }
    note_degenerate(scene);
    return scene;
  }

  Model model_;
  int chosen_ = -1;
  std::optional<gltf::Animation> animation_;
  std::vector<gltf::SceneNode> nodes_;
  std::optional<gltf::Skins> skins_;
  Scene still_;  // for an animated file, the parts that do not move
  std::optional<gltf::KeptMeshes> kept_;
  std::vector<gltf::VertexInstance> instances_;  // of what is not kept
  std::vector<gltf::TriangleRange> ranges_;
  std::uint64_t morph_targets_ = 0;
  FileUse use_;
  bool has_camera_ = false;
  std::size_t own_lights_ = 0;  // of the file; in still_ others follow them
};

}  // namespace

AnimatedScene open_gltf(const std::filesystem::path& path, const FileOptions& options,
                        const ImageDecoder& decode) {
  return AnimatedScene(std::make_shared<const GltfPoses>(path, options, decode));
}

}  // namespace marti::scenes
