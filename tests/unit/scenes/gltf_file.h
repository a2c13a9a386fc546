// Small glTF files made by the tests.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace marti::scenes::testing {

inline void write_bytes(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

inline std::string read_bytes(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A glTF file in the making: its JSON, and its one buffer.
struct GltfFile {
  nlohmann::json json;
  std::string bin;

  GltfFile() {
    json["asset"] = {{"version", "2.0"}};
    json["scene"] = 0;
    json["scenes"] = {{{"nodes", {0}}}};
    json["nodes"] = nlohmann::json::array({{{"mesh", 0}}});
  }

  template <typename T>
  int add_view(const std::vector<T>& values) {
    bin.resize((bin.size() + 3) / 4 * 4);
    const std::size_t offset = bin.size();
    const std::size_t bytes = values.size() * sizeof(T);
    bin.resize(offset + bytes);
    std::memcpy(bin.data() + offset, values.data(), bytes);
    json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes}});
    return static_cast<int>(json["bufferViews"].size() - 1);
  }

  template <typename T>
  int add_accessor(const std::vector<T>& values, int component_type, const char* type,
                   std::size_t components) {
    const int view = add_view(values);
    json["accessors"].push_back({{"bufferView", view},
                                 {"componentType", component_type},
                                 {"type", type},
                                 {"count", values.size() / components}});
    return static_cast<int>(json["accessors"].size() - 1);
  }
  int add_positions(const std::vector<float>& values) { return add_accessor(values, 5126, "VEC3", 3); }
  int add_indices(const std::vector<std::uint16_t>& values) {
    return add_accessor(values, 5123, "SCALAR", 1);
  }

  nlohmann::json& primitive(std::size_t i = 0) { return json["meshes"][0]["primitives"][i]; }

  /// Two triangles of a unit square in the xy plane, indexed; accessor 0 positions, accessor 1 indices.
  static GltfFile square() {
    GltfFile file;
    const int positions = file.add_positions({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
    const int indices = file.add_indices({0, 1, 2, 0, 2, 3});
    file.json["meshes"] = {
        {{"primitives", {{{"attributes", {{"POSITION", positions}}}, {"indices", indices}}}}}};
    return file;
  }

  [[nodiscard]] std::string glb() const {
    nlohmann::json whole = json;
    if (!whole.contains("buffers")) {
      whole["buffers"] = nlohmann::json::array({{{"byteLength", bin.size()}}});
    }
    std::string text = whole.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string data = bin;
    data.resize((data.size() + 3) / 4 * 4);
    std::string out = "glTF";
    const auto number = [&out](std::size_t value) {
      const auto n = static_cast<std::uint32_t>(value);
      out.append(reinterpret_cast<const char*>(&n), sizeof n);
    };
    number(2);
    number(12 + 8 + text.size() + 8 + data.size());
    number(text.size());
    number(0x4E4F534A);
    out += text;
    number(data.size());
    number(0x004E4942);
    return out + data;
  }

  /// Writes `name` and `name`.bin.
  [[nodiscard]] std::filesystem::path write_gltf(const std::filesystem::path& directory,
                                                 const std::string& name) const {
    nlohmann::json whole = json;
    if (!whole.contains("buffers")) {
      whole["buffers"] = nlohmann::json::array({{{"byteLength", bin.size()}, {"uri", name + ".bin"}}});
      write_bytes(directory / (name + ".bin"), bin);
    }
    write_bytes(directory / name, whole.dump());
    return directory / name;
  }

  [[nodiscard]] std::filesystem::path write_glb(const std::filesystem::path& directory,
                                                const std::string& name) const {
    write_bytes(directory / name, glb());
    return directory / name;
  }
};

/// One way to damage a file, and a part of the message that must refuse it.
struct Fault {
  const char* name;
  const char* reason;
  std::function<void(GltfFile&)> damage;
};

/// Puts a value at a place of the file's JSON; "-" is the place behind an array's last element.
inline std::function<void(GltfFile&)> put(const char* place, const nlohmann::json& value) {
  return [=](GltfFile& file) { file.json[nlohmann::json::json_pointer(place)] = value; };
}

/// Puts a new accessor of these values there.
template <typename T>
std::function<void(GltfFile&)> put_accessor(const char* place, const std::vector<T>& values,
                                            int component_type, const char* type, std::size_t components) {
  return [=](GltfFile& file) {
    file.json[nlohmann::json::json_pointer(place)] =
        file.add_accessor(values, component_type, type, components);
  };
}
inline std::function<void(GltfFile&)> put_positions(const char* place, const std::vector<float>& values) {
  return put_accessor(place, values, 5126, "VEC3", 3);
}

/// Takes a member out of the file's JSON.
inline std::function<void(GltfFile&)> drop(const char* place) {
  return [pointer = nlohmann::json::json_pointer(place)](GltfFile& file) {
    file.json[pointer.parent_pointer()].erase(pointer.back());
  };
}

}  // namespace marti::scenes::testing
