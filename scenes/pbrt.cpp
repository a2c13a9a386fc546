#include "scenes/pbrt.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/gtc/matrix_inverse.hpp>
#include <glm/mat4x4.hpp>

#include "scenes/append_geometry.h"
#include "scenes/default_view.h"
#include "scenes/merged_instances.h"
#include "scenes/open.h"
#include "scenes/pbrt_attributes.h"
#include "scenes/pbrt_camera.h"
#include "scenes/pbrt_color.h"
#include "scenes/pbrt_light.h"
#include "scenes/pbrt_material.h"
#include "scenes/pbrt_shape.h"
#include "scenes/pbrt_text.h"
#include "scenes/pbrt_transform.h"
#include "scenes/placement.h"
#include "scenes/source_file.h"
#include "scenes/tessellate.h"
#include "scenes/text_lines.h"
#include "scenes/vertex_values.h"

namespace marti::scenes {

namespace pbrt {
namespace {

/// Statements with a kind and parameters that say how pbrt renders, or what it does while it reads.
constexpr std::array<std::string_view, 5> rendering = {"Sampler", "Integrator", "PixelFilter", "Accelerator",
                                                       "Option"};

constexpr std::size_t most_states = 1024;
constexpr std::uint64_t bytes_of_name = 512;  // of what has a name, at least

/// What a shape has that is not its own.
struct State {
  glm::dmat4 transform{1.0};
  std::size_t material = 0;
  glm::dvec3 emission{0.0};
  bool reversed = false;
  bool at_end = false;  // transforms are those at the end of a motion, which is left out
  Attributes attributes;
};

/// What is there again at the end of an attribute or an object.
struct Begun {
  State state;
  std::string begun;  // "FILE:LINE: the AttributeBegin"
};

/// The geometry between ObjectBegin and ObjectEnd, in the coordinates of the world.
struct Object {
  Scene scene;
  std::uint64_t bytes = 0;
  bool shines = false;
  std::vector<InstancePlace> kept;  // where it stands without being copied
};

/// Thrown when copies of objects become so many that they should be kept.
struct ManyCopies {};
/// Thrown when round shapes have been replaced for the sake of instances, and there are none.
struct NothingKept {};

class Reader {
 public:
  /// Objects are kept if `instances` says so, else copied; automatic: until there are many copies.
  Reader(const SourceFile& file, const ImageDecoder& decode, Instances instances)
      : file_(file), instances_(instances), text_(file), materials_(file, text_, decode, scene_, left_out_) {
    left_out_.strict = file.options().strict;
  }

  AnimatedScene read() {
    while (const std::optional<std::string> name = text_.next()) {
      statement(*name);
    }
    if (!states_.empty()) {
      throw sim::UserError(states_.back().begun + " has no end");
    }
    if (object_ != nullptr) {
      file_.fail("an ObjectBegin has no ObjectEnd");
    }
    return finish();
  }

 private:
  void statement(const std::string& name) {
    if (is_transform(name)) {
      const glm::dmat4 after = transform_by(name, text_, state_.transform);
      state_.transform = state_.at_end ? state_.transform : after;
    } else if (name == "AttributeBegin" || name == "TransformBegin") {
      if (states_.size() == most_states) {
        text_.fail("more than " + std::to_string(most_states) +
                   " statements AttributeBegin lie in each other");
      }
      states_.push_back({state_, text_.place() + ": the " + name});
    } else if (name == "AttributeEnd" || name == "TransformEnd") {
      if (states_.empty()) {
        text_.fail(name + " without its begin");
      }
      state_ = states_.back().state;
      states_.pop_back();
    } else if (name == "Include" || name == "Import") {
      text_.include(text_.text());
    } else if (name == "WorldBegin") {
      state_ = {};
      named_transforms_["world"] = state_.transform;
    } else if (name == "ReverseOrientation") {
      state_.reversed = !state_.reversed;
    } else if (name == "CoordinateSystem") {
      file_.take_memory(bytes_of_name, "its names take");
      named_transforms_[text_.text()] = state_.transform;
    } else if (name == "CoordSysTransform") {
      choose_transform(text_.text());
    } else if (name == "ActiveTransform") {
      const std::string when = text_.word();
      if (when != "All" && when != "StartTime" && when != "EndTime") {
        text_.fail("ActiveTransform is All, StartTime or EndTime, not " + in_quotes(when));
      }
      state_.at_end = when == "EndTime";
      left_out_.features["motions"] += state_.at_end ? 1U : 0U;
    } else if (!object_statement(name) && !material_statement(name)) {
      other_statement(name);
    }
  }

  void choose_transform(const std::string& name) {
    const auto found = named_transforms_.find(name);
    if (found == named_transforms_.end()) {
      text_.fail("there is no coordinate system " + in_quotes(name) + " before it");
    }
    state_.transform = state_.at_end ? state_.transform : found->second;
  }

  bool object_statement(const std::string& name) {
    if (name == "ObjectBegin") {
      if (object_ != nullptr) {
        text_.fail("an object lies in another one");
      }
      states_.push_back({state_, text_.place() + ": the " + name});
      file_.take_memory(bytes_of_name + sizeof(Object), "its names take");
      object_ = &objects_.emplace_back();
      object_of_name_[text_.text()] = object_;
    } else if (name == "ObjectEnd") {
      if (object_ == nullptr || states_.empty()) {
        text_.fail("ObjectEnd without its begin");
      }
      object_->bytes = host_bytes(object_->scene);
      object_ = nullptr;
      state_ = states_.back().state;
      states_.pop_back();
    } else if (name == "ObjectInstance") {
      add_instance(text_.text());
    } else {
      return false;
    }
    return true;
  }

  bool material_statement(const std::string& name) {
    if (name == "Material") {
      std::string type = text_.text();
      state_.material = materials_.add(std::move(type), parameters_of("material"));
    } else if (name == "MakeNamedMaterial") {
      const std::string material = text_.text();
      materials_.add_named(material, parameters_of("material"));
    } else if (name == "NamedMaterial") {
      state_.material = materials_.named(text_.text());
    } else if (name == "Texture") {
      std::string texture = text_.text();
      static_cast<void>(text_.text());  // of floats or spectra
      std::string kind = text_.text();
      materials_.add_texture(std::move(texture), std::move(kind), parameters_of("texture"));
    } else {
      return false;
    }
    return true;
  }

  void other_statement(const std::string& name) {
    if (name == "Shape") {
      const std::string kind = text_.text();
      add_shape(kind, parameters_of("shape"));
    } else if (name == "LightSource") {
      const std::string kind = text_.text();
      add_light_source(kind, parameters_of("light"));
    } else if (name == "AreaLightSource") {
      static_cast<void>(text_.text());  // all are diffuse
      const Parameters parameters = parameters_of("light");
      state_.emission = color_in(parameters, "L", glm::dvec3(1.0), largest_emission, left_out_) *
                        parameters.number("scale", 1.0, 0.0, largest_emission);
      state_.emission = glm::min(state_.emission, glm::dvec3(largest_emission));
      if (parameters.text("twosided") != "true") {
        ++left_out_.replaced["area lights of one side, by ones of both"];
      }
      parameters.leave_out_rest(left_out_);
    } else if (name == "Camera") {
      const std::string kind = text_.text();
      static_cast<void>(placement_of(state_.transform, text_));
      const glm::dmat4 to_world = glm::affineInverse(state_.transform);
      named_transforms_["camera"] = to_world;
      camera_.set(kind, placement_of(to_world, text_), text_.parameters(), left_out_);
    } else if (name == "Film") {
      static_cast<void>(text_.text());
      camera_.set_film(text_.parameters());
    } else if (name == "MediumInterface") {
      while (text_.text_if_given()) {
      }
    } else if (name == "Attribute") {
      const std::string made = text_.text();
      state_.attributes.add(made, text_.parameters(), file_);
    } else if (name == "MakeNamedMedium") {
      static_cast<void>(text_.text());
      static_cast<void>(text_.parameters());
      left_out_.features["media"] += 1;
    } else if (name == "ColorSpace") {
      static_cast<void>(text_.text());
    } else if (name == "TransformTimes") {
      static_cast<void>(text_.numbers(2));
    } else if (std::find(rendering.begin(), rendering.end(), name) != rendering.end()) {
      if (name != "Option") {
        static_cast<void>(text_.text());
      }
      static_cast<void>(text_.parameters());
    } else if (name != "WorldEnd") {
      text_.fail(in_quotes(name) + " is no statement of a pbrt file");
    }
  }

  /// The parameters of a statement that makes this, those of attributes among them.
  Parameters parameters_of(std::string_view made) {
    Parameters parameters = text_.parameters();
    state_.attributes.append_to(parameters, made);
    return parameters;
  }

  void add_shape(const std::string& kind, const Parameters& parameters) {
    CutOut cut_out = materials_.cut_out_of(parameters);
    if (cut_out.everywhere()) {
      left_out_.features["shapes that are cut out as a whole"] += 1;
      return;
    }
    if (!cut_out.asks()) {
      cut_out = {};
    }
    std::optional<std::uint32_t> material = materials_.in_scene(state_.material, state_.emission, cut_out);
    const bool textured = material && (cut_out.asks() || scene_.materials[*material].texture != no_texture);
    std::optional<Scene> shape = scene_of_shape(kind, parameters, textured, file_, text_, left_out_);
    if (!shape) {
      return;
    }
    parameters.leave_out_rest(left_out_);
    if (cut_out.asks() && shape->uvs.empty()) {
      left_out_.features["cut-outs of shapes without texture coordinates"] += 1;
      material = materials_.in_scene(state_.material, state_.emission, {});
    }
    if (!material) {
      left_out_.features["surfaces of media"] += 1;
      return;
    }
    left_out_.features["textures on shapes without texture coordinates"] +=
        scene_.materials[*material].texture != no_texture && shape->uvs.empty() ? 1U : 0U;
    const bool shines = state_.emission != glm::dvec3(0.0);
    if (object_ != nullptr) {
      object_->shines = object_->shines || shines;
    }
    if (instances_ == Instances::kept && !shape->quadrics.empty()) {
      left_out_.replaced["spheres and cylinders, by triangles, because instances are kept"] +=
          shape->quadrics.size();
      replaced_round_ = true;
    }
    if (shines || instances_ == Instances::kept) {
      tessellate(*shape);  // paths find triangles that emit light, and instances are of triangles
    }
    if (state_.reversed) {
      for (Triangle& triangle : shape->triangles) {
        std::swap(triangle.vertex[1], triangle.vertex[2]);
      }
      for (glm::dvec3& normal : shape->normals) {
        normal = -normal;
      }
    }
    add(*shape, state_.transform, *material);
  }

  void add_instance(const std::string& name) {
    if (object_ != nullptr) {
      text_.fail("an instance lies in an object");
    }
    const auto named = object_of_name_.find(name);
    if (named == object_of_name_.end()) {
      text_.fail("there is no object " + in_quotes(name) + " before it");
    }
    Object& object = *named->second;
    if (instances_ == Instances::kept && !object.shines && !object.scene.triangles.empty()) {
      const Placement placement = placement_of(state_.transform, text_);
      InstancePlace place;
      place.linear = placement.linear;
      place.shift = placement.offset;
      if (why_not_kept(place).empty()) {
        file_.take_memory(2 * sizeof place, "its instances take");
        object.kept.push_back(place);
        return;
      }
    }
    copied_ += object.scene.triangles.size();
    if (instances_ == Instances::automatic && copied_ > many_copies) {
      throw ManyCopies();
    }
    check_size(object.scene);
    file_.require_memory(object.bytes, "an instance takes");
    Scene copy = object.scene;
    add(copy, state_.transform, 0);
  }

  /// Puts the objects that are kept behind all other geometry.
  void add_kept() {
    MergedInstances all;
    for (Object& object : objects_) {
      if (!object.kept.empty()) {
        object.scene.meshes = {{0, static_cast<std::uint32_t>(object.scene.triangles.size())}};
        object.scene.instances = std::move(object.kept);
        check_size(object.scene);
        all.append(scene_, object.scene, 0);
      }
    }
    all.finish(scene_);
  }

  void check_size(const Scene& part) const {
    const std::uint64_t most = file_.options().max_triangles;
    if (!fit_together(object_ != nullptr ? object_->scene : scene_, part, most)) {
      text_.fail("the scene has more than " + std::to_string(most) +
                 " triangles or vertices, which is more than is accepted");
    }
  }

  void add(Scene& part, const glm::dmat4& transform, std::uint32_t material) {
    to_triangles_if_stretched(part, transform);
    check_size(part);
    file_.take_memory(host_bytes(part), "its geometry takes");
    part.framed = true;
    place(placement_of(transform, text_), text_.place(), part);
    append_geometry(object_ != nullptr ? object_->scene : scene_, part, material);
  }

  void add_light_source(const std::string& kind, const Parameters& parameters) {
    const std::optional<Light> light = light_source(kind, parameters, scene_, left_out_);
    parameters.leave_out_rest(left_out_);
    if (!light) {
      return;
    }
    Scene alone;
    alone.framed = true;
    alone.lights.push_back(*light);
    place(placement_of(state_.transform, text_), text_.place(), alone);
    if (scene_.lights.size() == most_lights) {
      text_.fail("the scene has more than " + std::to_string(most_lights) + " lights");
    }
    scene_.lights.push_back(alone.lights.front());
  }

  AnimatedScene finish() {
    add_kept();
    if (replaced_round_ && scene_.instances.empty()) {
      throw NothingKept();
    }
    if (scene_.triangles.empty() && scene_.quadrics.empty()) {
      file_.fail_empty();
    }
    scene_.name = file_.path().filename().string();
    scene_.framed = !camera_.given();
    if (camera_.given()) {
      camera_.use(file_.path(), scene_);
    }
    set_view(scene_, file_.options());
    note_instances(scene_);
    materials_.leave_out_rest();
    note_left_out(left_out_, scene_);
    note_degenerate(scene_);
    FileUse use;
    use.parts = {{"materials", materials_.known(), materials_.used()}};
    return AnimatedScene(std::move(scene_), std::move(use));
  }

  static constexpr std::size_t most_lights = 65536;

  const SourceFile& file_;
  const Instances instances_;
  Scene scene_;
  LeftOut left_out_;
  Text text_;
  PbrtMaterials materials_;
  State state_;
  std::vector<Begun> states_;
  std::map<std::string, glm::dmat4> named_transforms_;
  std::deque<Object> objects_;  // of which a later one may take the name of an earlier one
  std::map<std::string, Object*> object_of_name_;
  Object* object_ = nullptr;  // that is being read
  std::uint64_t copied_ = 0;  // triangles of objects
  bool replaced_round_ = false;
  FilmCamera camera_;
};

}  // namespace
}  // namespace pbrt

AnimatedScene open_pbrt(const std::filesystem::path& path, const FileOptions& options,
                        const ImageDecoder& decode) {
  const auto read = [&](Instances instances) {
    const SourceFile file(path, options);
    try {
      return pbrt::Reader(file, decode, instances).read();
    } catch (const std::bad_alloc&) {
      file.fail("there is not enough memory for its scene");
    }
  };
  try {
    return read(options.instances);
  } catch (const pbrt::ManyCopies&) {
    return read(Instances::kept);
  } catch (const pbrt::NothingKept&) {
    return read(Instances::copied);
  }
}

}  // namespace marti::scenes
