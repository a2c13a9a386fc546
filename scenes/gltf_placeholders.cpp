#include "scenes/gltf_placeholders.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include <nlohmann/json.hpp>

#include "scenes/gltf_extensions.h"

namespace marti::scenes::gltf {

namespace {

using nlohmann::json;

// A member that is a list; if there is none, an empty list.
json& list_in(json& object, const char* name) {
  static thread_local json none;
  none = json::array();
  return object.is_object() && object.contains(name) && object[name].is_array() ? object[name] : none;
}

void set_number(std::string& bytes, std::size_t at, std::size_t value) {
  const auto number = static_cast<std::uint32_t>(value);
  std::memcpy(bytes.data() + at, &number, sizeof number);
}

void give_views(json& file, Placeholders& given) {
  if (list_in(file, "bufferViews").empty()) {
    return;
  }
  std::vector<std::size_t> indices;
  for (json& mesh : list_in(file, "meshes")) {
    for (const json& primitive : list_in(mesh, "primitives")) {
      if (primitive.is_object() && primitive.contains("indices") &&
          primitive["indices"].is_number_unsigned()) {
        indices.push_back(primitive["indices"].get<std::size_t>());
      }
    }
  }
  json& accessors = list_in(file, "accessors");
  for (const std::size_t index : indices) {
    if (index < accessors.size() && accessors[index].is_object() &&
        !accessors[index].contains("bufferView")) {
      accessors[index]["bufferView"] = 0;
      given.accessors.push_back(static_cast<int>(index));
    }
  }
}

void give_bytes(json& file, Placeholders& given) {
  json& buffers = list_in(file, "buffers");
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    json& buffer = buffers[i];
    if (!buffer.is_object() || buffer.contains("uri") || !buffer.contains("extensions")) {
      continue;
    }
    for (const char* name : meshopt_names) {
      if (buffer["extensions"].is_object() && buffer["extensions"].contains(name)) {
        buffer["uri"] = "data:application/octet-stream;base64,AA==";
        buffer["byteLength"] = 1;
        given.buffers.push_back(static_cast<int>(i));
        break;
      }
    }
  }
}

}  // namespace

Placeholders with_placeholders(std::string_view text) {
  Placeholders given;
  json file = json::parse(text, nullptr, false);
  if (file.is_discarded()) {
    return given;
  }
  give_views(file, given);
  give_bytes(file, given);
  if (!given.accessors.empty() || !given.buffers.empty()) {
    given.json = file.dump(-1, ' ', false, json::error_handler_t::replace);
  }
  return given;
}

std::string with_json(std::string_view glb, std::string json) {
  constexpr std::size_t header = 12;
  constexpr std::size_t chunk = 8;
  std::uint32_t old = 0;
  std::memcpy(&old, glb.data() + header, sizeof old);
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string file(glb.substr(0, header + chunk));
  file += json;
  file += glb.substr(std::min(glb.size(), header + chunk + old));
  set_number(file, 8, file.size());
  set_number(file, header, json.size());
  return file;
}

std::string with_padding(std::string_view glb) {
  constexpr std::size_t headers = 20;
  const auto number_at = [glb](std::size_t at) {
    std::uint32_t number = 0;
    std::memcpy(&number, glb.data() + at, sizeof number);
    return std::size_t{number};
  };
  if (glb.size() < headers || number_at(8) != glb.size()) {
    return {};
  }
  const std::size_t json = number_at(12);
  const std::size_t binary = headers + json;
  const bool has_binary = binary + 8 <= glb.size();
  const std::size_t bytes = has_binary ? number_at(binary) : 0;
  const std::size_t end = has_binary ? binary + 8 + bytes : binary;
  if ((json % 4 == 0 && bytes % 4 == 0) || end != glb.size()) {
    return {};
  }
  std::string file = with_json(glb, std::string(glb.substr(headers, json)));
  if (has_binary) {
    file.resize((file.size() + 3) / 4 * 4);
    const std::size_t begin = headers + (json + 3) / 4 * 4;
    set_number(file, begin, file.size() - begin - 8);
    set_number(file, 8, file.size());
  }
  return file;
}

void remove_placeholders(const Placeholders& given, tinygltf::Model& file) {
  for (const int accessor : given.accessors) {
    if (static_cast<std::size_t>(accessor) < file.accessors.size()) {
      file.accessors[static_cast<std::size_t>(accessor)].bufferView = -1;
    }
  }
  for (const int buffer : given.buffers) {
    if (static_cast<std::size_t>(buffer) < file.buffers.size()) {
      file.buffers[static_cast<std::size_t>(buffer)].uri.clear();
      file.buffers[static_cast<std::size_t>(buffer)].data.clear();
    }
  }
}

}  // namespace marti::scenes::gltf
