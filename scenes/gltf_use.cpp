#include "scenes/gltf_use.h"

#include <algorithm>
#include <set>
#include <string>

namespace marti::scenes::gltf {

namespace {

std::uint64_t buffer_bytes(const tinygltf::Model& file, int view) {
  if (view < 0 || static_cast<std::size_t>(view) >= file.bufferViews.size()) {
    return 0;
  }
  const int buffer = file.bufferViews[static_cast<std::size_t>(view)].buffer;
  return buffer < 0 || static_cast<std::size_t>(buffer) >= file.buffers.size()
             ? 0
             : file.buffers[static_cast<std::size_t>(buffer)].data.size();
}

std::uint64_t stated_bytes(const tinygltf::Model& file, const tinygltf::Accessor& accessor) {
  const int component = tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType));
  const int components = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
  if (component <= 0 || components <= 0) {
    return 0;
  }
  const auto element = static_cast<std::uint64_t>(component) * static_cast<std::uint64_t>(components);
  const std::uint64_t most = buffer_bytes(file, accessor.bufferView);
  return accessor.count > most / element ? most : accessor.count * element;
}

std::uint64_t stated_bytes(const tinygltf::Model& file, const tinygltf::Image& image) {
  if (image.bufferView < 0 || static_cast<std::size_t>(image.bufferView) >= file.bufferViews.size()) {
    return image.image.size();
  }
  const std::uint64_t length = file.bufferViews[static_cast<std::size_t>(image.bufferView)].byteLength;
  return std::min(length, buffer_bytes(file, image.bufferView));
}

}  // namespace

FileUse use_of(const Model& model, const std::vector<SceneNode>& nodes, const Materials& materials,
               const Chosen& chosen) {
  const tinygltf::Model& file = model.data();
  std::set<int> meshes;
  std::uint64_t of_file = 0;
  for (const SceneNode& node : nodes) {
    of_file += node.place ? 0U : 1U;
    if (node.mesh >= 0) {
      meshes.insert(node.mesh);
    }
  }
  FileUse use;
  std::uint64_t accessors = 0;
  for (std::size_t i = 0; i < file.accessors.size(); ++i) {
    const bool read = model.was_read(i);
    accessors += read ? 1U : 0U;
    use.unread_bytes += read ? 0 : stated_bytes(file, file.accessors[i]);
  }
  for (std::size_t i = 0; i < file.images.size(); ++i) {
    const bool used = materials.used_images().contains(static_cast<int>(i));
    use.unread_bytes += used ? 0 : stated_bytes(file, file.images[i]);
  }
  use.parts = {{"scenes", file.scenes.size(), std::min<std::uint64_t>(1, file.scenes.size())},
               {"nodes", file.nodes.size(), of_file},
               {"meshes", file.meshes.size(), meshes.size()},
               {"materials", file.materials.size(), materials.used()},
               {"images", file.images.size(), materials.used_images().size()},
               {"skins", file.skins.size(), chosen.skins},
               {"animations", file.animations.size(), chosen.animations},
               {"cameras", file.cameras.size(), chosen.cameras},
               {"accessors", file.accessors.size(), accessors}};
  return use;
}

void read_unused(const Model& model, const Materials& materials) {
  const tinygltf::Model& file = model.data();
  const std::uint64_t most = 64 * model.options().max_triangles;
  std::uint64_t elements = 0;
  for (std::size_t i = 0; i < file.accessors.size(); ++i) {
    const tinygltf::Accessor& accessor = file.accessors[i];
    if (model.was_read(i)) {
      continue;
    }
    // Many accessors may share a large buffer in a small file.
    elements += std::min<std::uint64_t>(accessor.count, most + 1);
    if (elements > most) {
      model.fail("the accessors that its scene does not use have more than " + std::to_string(most) +
                 " elements, which is more than is read");
    }
    const int index = static_cast<int>(i);
    if (accessor.type == TINYGLTF_TYPE_MAT4) {
      static_cast<void>(model.read_matrices(index, accessor.count, "the file"));
    } else if (accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) {
      static_cast<void>(model.read_indices(index, "the file"));
    } else if (accessor.type != TINYGLTF_TYPE_MAT2 && accessor.type != TINYGLTF_TYPE_MAT3) {
      const int components = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
      static_cast<void>(model.read_values(index, components, "the file"));
    }
  }
  for (std::size_t i = 0; i < file.images.size(); ++i) {
    if (!materials.used_images().contains(static_cast<int>(i))) {
      materials.check_image(static_cast<int>(i));
    }
  }
}

}  // namespace marti::scenes::gltf
