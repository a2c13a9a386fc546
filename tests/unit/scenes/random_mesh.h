// A mesh that tests write in several formats, with coordinates that each of them holds exactly.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "gltf_file.h"
#include "ply_text.h"

namespace marti::scenes::testing {

struct RandomMesh {
  std::vector<float> positions;  ///< multiples of 1/64
  std::vector<std::uint16_t> indices;

  /// A height field of n x n squares, each of two triangles, with uneven places and heights.
  RandomMesh(std::uint32_t seed, std::uint16_t n) {
    std::mt19937 random(seed);
    const auto part = [&random] { return static_cast<float>(random() % 48) / 64.0F; };
    for (int y = 0; y <= n; ++y) {
      for (int x = 0; x <= n; ++x) {
        const float dx = part();
        const float dy = part();
        positions.insert(positions.end(), {static_cast<float>(x) + dx, part(), static_cast<float>(y) + dy});
      }
    }
    for (int y = 0; y < n; ++y) {
      for (int x = 0; x < n; ++x) {
        const auto at = static_cast<std::uint16_t>(y * (n + 1) + x);
        const auto below = static_cast<std::uint16_t>(at + n + 1);
        const auto next = static_cast<std::uint16_t>(at + 1);
        indices.insert(indices.end(), {at, below, next, next, below, static_cast<std::uint16_t>(below + 1)});
      }
    }
  }

  [[nodiscard]] std::size_t vertices() const { return positions.size() / 3; }
  [[nodiscard]] std::size_t triangles() const { return indices.size() / 3; }

  [[nodiscard]] std::string obj() const {
    std::ostringstream text;
    text.precision(17);
    for (std::size_t i = 0; i < positions.size(); i += 3) {
      text << "v " << positions[i] << " " << positions[i + 1] << " " << positions[i + 2] << "\n";
    }
    for (std::size_t i = 0; i < indices.size(); i += 3) {
      text << "f " << indices[i] + 1 << " " << indices[i + 1] + 1 << " " << indices[i + 2] + 1 << "\n";
    }
    return text.str();
  }

  [[nodiscard]] std::string ply(PlyOrder order) const {
    PlyBody body(order);
    for (std::size_t i = 0; i < positions.size(); i += 3) {
      body.add(positions[i]).add(positions[i + 1]).add(positions[i + 2]).end();
    }
    for (std::size_t i = 0; i < indices.size(); i += 3) {
      body.add(std::uint8_t{3}).add(indices[i]).add(indices[i + 1]).add(indices[i + 2]).end();
    }
    return ply_file(order,
                    "element vertex " + std::to_string(vertices()) +
                        "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                        std::to_string(triangles()) + "\nproperty list uchar ushort vertex_indices\n",
                    body);
  }

  /// Accessor 0 has the positions, accessor 1 the indices. The material is that of files without one.
  [[nodiscard]] GltfFile gltf() const {
    GltfFile file;
    const int at = file.add_positions(positions);
    const int corners = file.add_indices(indices);
    const nlohmann::json own = {{"color", {0.8, 0.8, 0.8}},
                                {"specular_color", {1, 1, 1}},
                                {"emission", {0, 0, 0}},
                                {"diffuse", 1.0},
                                {"reflection", 0.0},
                                {"transmission", 0.0},
                                {"ior", 1.0},
                                {"highlight", 0.0},
                                {"shininess", 1.0}};
    file.json["materials"] = nlohmann::json::array({{{"extras", {{"marti", own}}}}});
    file.json["meshes"] = {
        {{"primitives", {{{"attributes", {{"POSITION", at}}}, {"indices", corners}, {"material", 0}}}}}};
    return file;
  }
};

}  // namespace marti::scenes::testing
