#include "scenes/gltf_draco.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "scenes/file_access.h"
#include "scenes/gltf_extensions.h"
#include "scenes/gltf_material.h"
#include "scenes/gltf_vertices.h"

#ifdef MARTI_DRACO
#include <draco/mesh/mesh.h>

#include "scenes/draco_mesh.h"
#endif

namespace marti::scenes::gltf {

#ifdef MARTI_DRACO

namespace {

/// The component type of glTF for a type of Draco; 0 when there is none.
int component_type(draco::DataType type) {
  switch (type) {
    case draco::DT_INT8:
      return TINYGLTF_COMPONENT_TYPE_BYTE;
    case draco::DT_UINT8:
      return TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE;
    case draco::DT_INT16:
      return TINYGLTF_COMPONENT_TYPE_SHORT;
    case draco::DT_UINT16:
      return TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
    case draco::DT_UINT32:
      return TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    case draco::DT_FLOAT32:
      return TINYGLTF_COMPONENT_TYPE_FLOAT;
    default:
      return 0;
  }
}

class PrimitiveDecompressor {
 public:
  PrimitiveDecompressor(const Model& model, tinygltf::Model& file, tinygltf::Primitive& primitive,
                        std::string name)
      : model_(model), file_(file), primitive_(primitive), name_(std::move(name)) {}

  void run() {
    const tinygltf::Value& extension = primitive_.extensions.at("KHR_draco_mesh_compression");
    if (primitive_.mode != TINYGLTF_MODE_TRIANGLES && primitive_.mode != -1) {
      fail("can be read for lists of triangles only");
    }
    const int view = needed_index(extension, "bufferView");
    const std::span<const std::byte> bytes = model_.view_bytes(view, name_);
    if (!extension.Has("attributes") || !extension.Get("attributes").IsObject()) {
      fail("name no attributes");
    }
    const tinygltf::Value& attributes = extension.Get("attributes");
    const DracoCounts expected = expect(attributes);
    model_.require_memory(expected.memory, "its compressed data take");
    std::string refusal;
    const std::unique_ptr<draco::Mesh> mesh = decode_draco(bytes, expected, refusal);
    if (mesh == nullptr) {
      fail(refusal);
    }
    store_indices(*mesh);
    for (const std::string& semantic : attributes.Keys()) {
      if (attribute(primitive_.attributes, semantic) >= 0) {
        store_attribute(*mesh, semantic, needed_index(attributes, semantic.c_str()));
      }
    }
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    model_.fail(name_ + ": its compressed data " + what);
  }

  [[nodiscard]] int needed_index(const tinygltf::Value& object, const char* key) const {
    const std::optional<int> index = index_in(object, key);
    if (!index) {
      fail("need a whole number as " + double_quoted(key));
    }
    return *index;
  }

  /// An accessor that the data are for. It must have no bytes yet.
  [[nodiscard]] tinygltf::Accessor& empty_accessor(int index) const {
    static_cast<void>(model_.at(file_.accessors, index, "accessor", name_));
    tinygltf::Accessor& accessor = file_.accessors[static_cast<std::size_t>(index)];
    if (accessor.bufferView >= 0 || accessor.sparse.isSparse) {
      fail("are for accessor " + std::to_string(index) +
           ", which has data of its own or from another primitive");
    }
    return accessor;
  }

  /// Checks the accessors and sums up what they declare.
  [[nodiscard]] DracoCounts expect(const tinygltf::Value& attributes) const {
    if (primitive_.indices < 0) {
      fail("need an accessor for indices, which the primitive does not have");
    }
    const tinygltf::Accessor& indices = empty_accessor(primitive_.indices);
    const std::uint64_t most = model_.options().max_triangles;
    if (indices.count == 0 || indices.count % 3 != 0 || indices.count / 3 > most) {
      fail("are for " + std::to_string(indices.count) + " corners, which do not make 1 to " +
           std::to_string(most) + " triangles");
    }
    DracoCounts expected;
    expected.faces = static_cast<std::uint32_t>(indices.count / 3);
    std::optional<std::uint64_t> points;
    for (const std::string& semantic : attributes.Keys()) {
      const int index = attribute(primitive_.attributes, semantic);
      if (index < 0) {
        continue;
      }
      const std::uint64_t count = empty_accessor(index).count;
      if (points && count != *points) {
        fail("are for attributes of " + std::to_string(*points) + " and of " + std::to_string(count) +
             " vertices");
      }
      points = count;
    }
    if (!points || *points == 0 || *points > most) {
      fail("are for " + std::to_string(points.value_or(0)) + " vertices; 1 to " + std::to_string(most) +
           " are accepted");
    }
    expected.points = static_cast<std::uint32_t>(*points);
    // Generous: 64 bytes for each value of an attribute, and Draco's own tables of corners.
    expected.memory =
        *points * 64 * (attributes.Keys().size() + 1) + std::uint64_t{expected.faces} * 3 * 64 + (1U << 16U);
    return expected;
  }

  /// Gives the accessor these bytes, in a buffer and a view of their own.
  void store(tinygltf::Accessor& accessor, std::vector<unsigned char> bytes) const {
    model_.take_memory(bytes.size(), "its decompressed data take");
    tinygltf::BufferView view;
    view.buffer = static_cast<int>(file_.buffers.size());
    view.byteLength = bytes.size();
    tinygltf::Buffer buffer;
    buffer.data = std::move(bytes);
    accessor.bufferView = static_cast<int>(file_.bufferViews.size());
    accessor.byteOffset = 0;
    file_.buffers.push_back(std::move(buffer));
    file_.bufferViews.push_back(std::move(view));
  }

  void store_indices(const draco::Mesh& mesh) const {
    tinygltf::Accessor& accessor = empty_accessor(primitive_.indices);
    const int size = tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType));
    if (accessor.type != TINYGLTF_TYPE_SCALAR || (size != 1 && size != 2 && size != 4) ||
        (size < 4 && mesh.num_points() > (1U << (8U * static_cast<unsigned>(size))))) {
      fail("are for indices of component type " + std::to_string(accessor.componentType) +
           ", which cannot hold " + std::to_string(mesh.num_points()) + " vertices");
    }
    std::vector<unsigned char> bytes;
    bytes.reserve(std::size_t{mesh.num_faces()} * 3 * static_cast<std::size_t>(size));
    for (draco::FaceIndex face(0); face < mesh.num_faces(); ++face) {
      for (const draco::PointIndex& corner : mesh.face(face)) {
        std::array<unsigned char, 4> value{};
        const std::uint32_t index = corner.value();
        std::memcpy(value.data(), &index, sizeof index);  // little-endian, as this machine
        bytes.insert(bytes.end(), value.begin(), value.begin() + size);
      }
    }
    store(accessor, std::move(bytes));
  }

  void store_attribute(const draco::Mesh& mesh, const std::string& semantic, int id) const {
    const draco::PointAttribute* const from = mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(id));
    if (from == nullptr) {
      fail("have no attribute " + std::to_string(id) + " for " + double_quoted(semantic));
    }
    tinygltf::Accessor& accessor = empty_accessor(attribute(primitive_.attributes, semantic));
    const int components = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
    if (component_type(from->data_type()) != accessor.componentType || from->num_components() != components) {
      fail("have " + std::to_string(from->num_components()) + " components of Draco's type " +
           std::to_string(from->data_type()) + " for " + double_quoted(semantic) + ", whose accessor has " +
           std::to_string(components) + " of component type " + std::to_string(accessor.componentType));
    }
    const auto element = static_cast<std::size_t>(from->byte_stride());
    if (element != static_cast<std::size_t>(components) *
                       static_cast<std::size_t>(draco::DataTypeLength(from->data_type()))) {
      fail("have gaps between the values for " + double_quoted(semantic));
    }
    std::vector<unsigned char> bytes(std::size_t{mesh.num_points()} * element);
    for (draco::PointIndex point(0); point < mesh.num_points(); ++point) {
      const draco::AttributeValueIndex value = from->mapped_index(point);
      if (value.value() >= from->size() ||
          (std::size_t{value.value()} + 1) * element > from->buffer()->data_size()) {
        fail("are damaged: a value for " + double_quoted(semantic) + " is missing");
      }
      std::memcpy(bytes.data() + std::size_t{point.value()} * element,
                  from->buffer()->data() + std::size_t{value.value()} * element, element);
    }
    store(accessor, std::move(bytes));
  }

  const Model& model_;
  tinygltf::Model& file_;
  tinygltf::Primitive& primitive_;
  std::string name_;
};

}  // namespace

bool has_draco() { return true; }

void decompress_primitives(const Model& model, tinygltf::Model& file) {
  for (std::size_t m = 0; m < file.meshes.size(); ++m) {
    for (std::size_t p = 0; p < file.meshes[m].primitives.size(); ++p) {
      tinygltf::Primitive& primitive = file.meshes[m].primitives[p];
      if (!compression_of_primitive(file, primitive).empty()) {
        PrimitiveDecompressor(model, file, primitive,
                              "mesh " + std::to_string(m) + ", primitive " + std::to_string(p))
            .run();
      }
    }
  }
}

#else

bool has_draco() { return false; }

void decompress_primitives(const Model& /*model*/, tinygltf::Model& /*file*/) {}

#endif

}  // namespace marti::scenes::gltf
