#include "scenes/gltf_export.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <new>
#include <numeric>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <tiny_gltf.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "scenes/tessellate.h"
#include "sim/error.h"
#include "sim/files.h"
#include "sim/shown.h"

namespace marti::scenes {

namespace {

using tinygltf::Value;

constexpr std::size_t most_primitives = 4096;

Value array_of(const glm::dvec3& v) { return Value(Value::Array{Value(v.x), Value(v.y), Value(v.z)}); }

std::vector<double> numbers_of(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

Value own_extras(Value::Object members) { return Value(Value::Object{{"marti", Value(std::move(members))}}); }

/// Builds the glTF model of one scene, all data in one buffer.
class Exporter {
 public:
  Exporter(const Scene& scene, const std::filesystem::path& path, const ImageEncoder& encode)
      : scene_(scene), path_(path), encode_(encode) {
    model_.buffers.emplace_back();
    model_.scenes.emplace_back();
    model_.scenes[0].name = scene.name;
    model_.defaultScene = 0;
    model_.asset.generator = "marti";
  }

  std::string run() {
    if (scene_.triangles.empty()) {
      fail("a scene without triangles cannot be written");
    }
    add_textures();
    for (const Material& material : scene_.materials) {
      add_material(material);
    }
    add_mesh();
    add_camera();
    for (const Light& light : scene_.lights) {
      add_light(light);
    }
    model_.extras = own_extras({{"background", array_of(scene_.background)},
                                {"ambient", array_of(scene_.ambient)},
                                {"lights_are_all", Value(scene_.lights_are_all)}});
    if (model_.buffers[0].data.size() > std::numeric_limits<std::uint32_t>::max() - (1U << 30)) {
      fail("the scene is too large for binary glTF, which ends at 4 GiB");
    }
    std::ostringstream out;
    tinygltf::TinyGLTF writer;
    if (!writer.WriteGltfSceneToStream(&model_, out, false, true)) {
      fail("the scene cannot be written as glTF");
    }
    return std::move(out).str();
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw sim::UserError(path_.string() + ": " + what);
  }

 private:
  /// Appends bytes as a buffer view, on a multiple of four.
  int add_view(const void* bytes, std::size_t size, int target) {
    std::vector<unsigned char>& data = model_.buffers[0].data;
    data.resize((data.size() + 3) / 4 * 4);
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = data.size();
    view.byteLength = size;
    view.target = target;
    data.resize(data.size() + size);
    std::memcpy(data.data() + view.byteOffset, bytes, size);
    model_.bufferViews.push_back(view);
    return static_cast<int>(model_.bufferViews.size() - 1);
  }

  int add_accessor(int view, int component_type, int type, std::size_t count) {
    tinygltf::Accessor accessor;
    accessor.bufferView = view;
    accessor.componentType = component_type;
    accessor.type = type;
    accessor.count = count;
    model_.accessors.push_back(accessor);
    return static_cast<int>(model_.accessors.size() - 1);
  }

  /// Adds an attribute of 32-bit floats, from vectors of `N` doubles; the doubles too, if they are not equal.
  template <int N, typename Vector>
  void add_attribute(const char* name, const std::vector<Vector>& values, int type, bool with_bounds) {
    bool equal = true;
    std::vector<float> floats;
    floats.reserve(values.size() * N);
    std::vector<double> lowest(N, std::numeric_limits<double>::infinity());
    std::vector<double> highest(N, -std::numeric_limits<double>::infinity());
    for (const Vector& value : values) {
      for (int i = 0; i < N; ++i) {
        const auto narrow = static_cast<float>(value[i]);
        if (!std::isfinite(narrow)) {
          fail("a coordinate is too large for glTF's 32-bit numbers");
        }
        floats.push_back(narrow);
        equal = equal && static_cast<double>(narrow) == value[i];
        const auto at = static_cast<std::size_t>(i);
        lowest[at] = std::min(lowest[at], static_cast<double>(narrow));
        highest[at] = std::max(highest[at], static_cast<double>(narrow));
      }
    }
    const int view = add_view(floats.data(), floats.size() * sizeof(float), TINYGLTF_TARGET_ARRAY_BUFFER);
    attributes_[name] = add_accessor(view, TINYGLTF_COMPONENT_TYPE_FLOAT, type, values.size());
    if (with_bounds) {
      model_.accessors.back().minValues = lowest;
      model_.accessors.back().maxValues = highest;
    }
    if (!equal) {
      exact_[name] = Value(add_view(values.data(), values.size() * sizeof(Vector), 0));
    }
  }

  /// The order in which triangles are written: unchanged, unless they form too many runs of one material.
  std::vector<std::uint32_t> triangle_order() const {
    std::vector<std::uint32_t> order(scene_.triangles.size());
    std::iota(order.begin(), order.end(), 0U);
    std::size_t runs = 1;
    for (std::size_t i = 1; i < order.size(); ++i) {
      runs += scene_.triangles[i].material != scene_.triangles[i - 1].material ? 1U : 0U;
    }
    if (runs > most_primitives) {
      std::stable_sort(order.begin(), order.end(), [this](std::uint32_t a, std::uint32_t b) {
        return scene_.triangles[a].material < scene_.triangles[b].material;
      });
    }
    return order;
  }

  void add_mesh() {
    add_attribute<3>("POSITION", scene_.positions, TINYGLTF_TYPE_VEC3, true);
    if (!scene_.normals.empty()) {
      add_attribute<3>("NORMAL", scene_.normals, TINYGLTF_TYPE_VEC3, false);
    }
    if (!scene_.uvs.empty()) {
      add_attribute<2>("TEXCOORD_0", scene_.uvs, TINYGLTF_TYPE_VEC2, false);
    }
    tinygltf::Mesh mesh;
    mesh.name = scene_.name;
    const std::vector<std::uint32_t> order = triangle_order();
    std::vector<std::uint32_t> indices;
    for (std::size_t i = 0; i < order.size(); ++i) {
      const Triangle& triangle = scene_.triangles[order[i]];
      indices.insert(indices.end(), triangle.vertex.begin(), triangle.vertex.end());
      if (i + 1 == order.size() || scene_.triangles[order[i + 1]].material != triangle.material) {
        const int view = add_view(indices.data(), indices.size() * sizeof(std::uint32_t),
                                  TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
        tinygltf::Primitive primitive;
        primitive.attributes = attributes_;
        if (!exact_.empty()) {
          primitive.extras = own_extras(exact_);
        }
        primitive.indices =
            add_accessor(view, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR, indices.size());
        primitive.material = static_cast<int>(triangle.material);
        primitive.mode = TINYGLTF_MODE_TRIANGLES;
        mesh.primitives.push_back(primitive);
        indices.clear();
      }
    }
    model_.meshes.push_back(mesh);
    tinygltf::Node node;
    node.mesh = 0;
    add_node(node);
  }

  void add_node(const tinygltf::Node& node) {
    model_.scenes[0].nodes.push_back(static_cast<int>(model_.nodes.size()));
    model_.nodes.push_back(node);
  }

  void add_textures() {
    if (!scene_.textures.empty() && !encode_) {
      fail("the scene has textures, and no image encoder is at hand");
    }
    for (const Texture& source : scene_.textures) {
      if (!source.srgb) {
        fail("texture '" + sim::shown(source.name) +
             "' holds linear colours, which glTF has no base colour texture for");
      }
      const std::vector<std::byte> file = encode_(source);
      tinygltf::Image image;
      image.name = source.name;
      image.mimeType = "image/png";
      image.bufferView = add_view(file.data(), file.size(), 0);
      tinygltf::Sampler sampler;
      sampler.wrapS = source.repeat_u ? TINYGLTF_TEXTURE_WRAP_REPEAT : TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
      sampler.wrapT = source.repeat_v ? TINYGLTF_TEXTURE_WRAP_REPEAT : TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
      tinygltf::Texture texture;
      texture.source = static_cast<int>(model_.images.size());
      texture.sampler = static_cast<int>(model_.samplers.size());
      model_.images.push_back(image);
      model_.samplers.push_back(sampler);
      model_.textures.push_back(texture);
    }
  }

  void use_extension(tinygltf::Material& material, const char* name, const char* member, double value) {
    material.extensions[name] = Value(Value::Object{{member, Value(value)}});
    std::vector<std::string>& used = model_.extensionsUsed;
    if (std::find(used.begin(), used.end(), name) == used.end()) {
      used.emplace_back(name);
    }
  }

  void add_material(const Material& source) {
    tinygltf::Material material;
    material.name = source.name;
    tinygltf::PbrMetallicRoughness& pbr = material.pbrMetallicRoughness;
    const glm::dvec3 color = glm::clamp(source.color, 0.0, 1.0);
    pbr.baseColorFactor = {color.r, color.g, color.b, 1.0};
    // An approximation for other programs: a mirror of some weight becomes a metal of that weight.
    pbr.metallicFactor = std::clamp(source.reflection, 0.0, 1.0);
    pbr.roughnessFactor = source.reflection > 0.0 ? 0.0
                          : source.highlight > 0.0
                              ? std::clamp(std::pow(2.0 / (source.shininess + 2.0), 0.25), 0.0, 1.0)
                              : 1.0;
    if (source.texture != no_texture) {
      pbr.baseColorTexture.index = static_cast<int>(source.texture);
    }
    if (const CutOut& cut_out = source.cut_out; cut_out.asks()) {
      if (cut_out.texture != source.texture || scene_.textures[cut_out.texture].grey_is_alpha) {
        fail("material '" + sim::shown(source.name) +
             "' is cut out by another image than its colours', which glTF cannot say");
      }
      material.alphaMode = "MASK";
      material.alphaCutoff = cut_out.cutoff;
      pbr.baseColorFactor[3] = cut_out.alpha;
    }
    if (source.transmission > 0.0) {
      use_extension(material, "KHR_materials_transmission", "transmissionFactor",
                    std::clamp(source.transmission / (source.transmission + source.diffuse), 0.0, 1.0));
    }
    if (source.ior > 1.0) {
      use_extension(material, "KHR_materials_ior", "ior", source.ior);
    }
    const double brightest = std::max({source.emission.r, source.emission.g, source.emission.b, 1.0});
    material.emissiveFactor = numbers_of(source.emission / brightest);
    if (brightest > 1.0) {
      use_extension(material, "KHR_materials_emissive_strength", "emissiveStrength", brightest);
    }
    material.extras = own_extras({{"color", array_of(source.color)},
                                  {"specular_color", array_of(source.specular_color)},
                                  {"emission", array_of(source.emission)},
                                  {"diffuse", Value(source.diffuse)},
                                  {"reflection", Value(source.reflection)},
                                  {"transmission", Value(source.transmission)},
                                  {"ior", Value(source.ior)},
                                  {"highlight", Value(source.highlight)},
                                  {"shininess", Value(source.shininess)}});
    model_.materials.push_back(material);
  }

  /// A node's matrix at `place` with the node's -z axis along `forward`.
  static std::vector<double> placed(const glm::dvec3& place, const glm::dvec3& forward,
                                    const glm::dvec3& up) {
    const glm::dvec3 right = glm::normalize(glm::cross(forward, up));
    const glm::dvec3 upward = glm::cross(right, forward);
    return {right.x,    right.y,    right.z,    0.0, upward.x, upward.y, upward.z, 0.0,
            -forward.x, -forward.y, -forward.z, 0.0, place.x,  place.y,  place.z,  1.0};
  }

  void add_camera() {
    static_cast<void>(scene_.camera.image_plane(1, 1));  // throws for a camera without a frame
    const Bounds bounds = bounds_of(scene_);
    tinygltf::Camera camera;
    camera.type = "perspective";
    camera.perspective.yfov = scene_.camera.vertical_fov;
    camera.perspective.zfar =
        2.0 * (glm::length(bounds.hi - bounds.lo) + glm::length(scene_.camera.eye - bounds.lo)) + 1.0;
    camera.perspective.znear = camera.perspective.zfar * 1e-5;
    camera.extras = own_extras({{"at", array_of(scene_.camera.at)}, {"up", array_of(scene_.camera.up)}});
    model_.cameras.push_back(camera);
    tinygltf::Node node;
    node.camera = 0;
    node.matrix =
        placed(scene_.camera.eye, glm::normalize(scene_.camera.at - scene_.camera.eye), scene_.camera.up);
    add_node(node);
  }

  void add_light(const Light& source) {
    tinygltf::Light light;
    light.type = source.kind == LightKind::point  ? "point"
                 : source.kind == LightKind::spot ? "spot"
                                                  : "directional";
    const double brightest = std::max({source.color.r, source.color.g, source.color.b});
    light.intensity = brightest;
    light.color = numbers_of(brightest > 0.0 ? source.color / brightest : glm::dvec3(1.0));
    light.range = source.range;
    if (source.kind == LightKind::spot) {
      light.spot.innerConeAngle = std::acos(std::clamp(source.cos_inner_cone, -1.0, 1.0));
      light.spot.outerConeAngle = std::acos(std::clamp(source.cos_outer_cone, -1.0, 1.0));
    }
    light.extras = own_extras({{"color", array_of(source.color)},
                               {"direction", array_of(source.direction)},
                               {"cos_inner_cone", Value(source.cos_inner_cone)},
                               {"cos_outer_cone", Value(source.cos_outer_cone)},
                               {"inverse_square", Value(source.inverse_square)}});
    tinygltf::Node node;
    if (source.kind == LightKind::point) {
      node.translation = numbers_of(source.position);
    } else {
      const glm::dvec3 forward = glm::normalize(source.direction);
      const glm::dvec3 aside = std::abs(forward.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
      node.matrix = placed(source.position, forward, aside);
    }
    node.extensions["KHR_lights_punctual"] =
        Value(Value::Object{{"light", Value(static_cast<int>(model_.lights.size()))}});
    model_.lights.push_back(light);
    add_node(node);
  }

  const Scene& scene_;
  const std::filesystem::path& path_;
  const ImageEncoder& encode_;
  tinygltf::Model model_;
  std::map<std::string, int> attributes_;
  Value::Object exact_;  // by attribute, the buffer view of its doubles
};

}  // namespace

void export_glb(const Scene& source, const std::filesystem::path& path, const ImageEncoder& encode) {
  Scene scene = source;
  tessellate(scene);
  Exporter exporter(scene, path, encode);
  if (scene.gaussians != nullptr) {
    exporter.fail("glTF has no Gaussians, only their proxies");
  }
  std::string content;
  try {
    content = exporter.run();
  } catch (const sim::UserError&) {
    throw;
  } catch (const std::bad_alloc&) {
    exporter.fail("there is not enough memory to write the scene");
  } catch (const std::exception& error) {
    // For example, a name that is not UTF-8.
    exporter.fail(std::string("the scene cannot be written: ") + error.what());
  }
  sim::write_file(path, content);
}

}  // namespace marti::scenes
