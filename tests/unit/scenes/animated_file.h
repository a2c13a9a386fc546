// Small animated glTF files made by the tests.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "gltf_file.h"

namespace marti::scenes::testing {

inline constexpr int gl_float = 5126;

/// Adds a channel with a sampler of its own to the first animation; `type` of one output element.
inline void animate(GltfFile& file, int node, const char* path, const std::vector<float>& times,
                    const std::vector<float>& values, const char* interpolation = "LINEAR") {
  const std::string what = path;
  const char* type = what == "rotation" ? "VEC4" : what == "weights" ? "SCALAR" : "VEC3";
  const std::size_t width = what == "rotation" ? 4 : what == "weights" ? 1 : 3;
  const int input = file.add_accessor(times, gl_float, "SCALAR", 1);
  const int output = file.add_accessor(values, gl_float, type, width);
  nlohmann::json& animation = file.json["animations"][0];
  const std::size_t sampler = animation["samplers"].size();
  animation["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", interpolation}});
  animation["channels"].push_back({{"sampler", sampler}, {"target", {{"node", node}, {"path", path}}}});
}

/// The square with two morph targets: the first lifts all corners by 1, the second moves corner 2 alone by
/// (1, 2, 3), given as a sparse accessor.
inline GltfFile morphing_square() {
  GltfFile file = GltfFile::square();
  const int lift = file.add_positions({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
  const int where = file.add_view<std::uint8_t>({2});
  const int what = file.add_view<float>({1, 2, 3});
  file.json["accessors"].push_back({{"componentType", gl_float},
                                    {"type", "VEC3"},
                                    {"count", 4},
                                    {"sparse",
                                     {{"count", 1},
                                      {"indices", {{"bufferView", where}, {"componentType", 5121}}},
                                      {"values", {{"bufferView", what}}}}}});
  const int pull = static_cast<int>(file.json["accessors"].size() - 1);
  file.primitive()["targets"] = {{{"POSITION", lift}}, {{"POSITION", pull}}};
  return file;
}

/// The square hung on two joints, nodes 1 and its child 2: the corners at y = 0 on the first, those at y = 1
/// on the second, whose bind pose is at y = 1.
inline GltfFile skinned_square() {
  GltfFile file = GltfFile::square();
  file.primitive()["attributes"]["JOINTS_0"] =
      file.add_accessor<std::uint8_t>({0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, 5121, "VEC4", 4);
  file.primitive()["attributes"]["WEIGHTS_0"] =
      file.add_accessor<float>({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, gl_float, "VEC4", 4);
  const std::vector<float> inverse_bind = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,  0, 1,
                                           1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1};
  const int matrices = file.add_accessor(inverse_bind, gl_float, "MAT4", 16);
  file.json["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", matrices}}};
  file.json["nodes"] = {{{"mesh", 0}, {"skin", 0}}, {{"children", {2}}}, {{"translation", {0, 1, 0}}}};
  file.json["scenes"][0]["nodes"] = {0, 1};
  return file;
}

}  // namespace marti::scenes::testing
