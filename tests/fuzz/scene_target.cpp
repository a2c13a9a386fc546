#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/given_rays.h"
#include "scenes/open.h"
#include "scenes/texture.h"
#include "sim/error.h"
#include "sim/memory_budget.h"
#include "target.h"
#include "tests/support/temporary_directory.h"

namespace marti::fuzz {

namespace {

constexpr std::uint64_t most_triangles = 4096;

void append(std::vector<std::uint8_t>& to, std::uint32_t word) {
  for (unsigned shift = 0; shift < 32; shift += 8) {
    to.push_back(static_cast<std::uint8_t>(word >> shift));
  }
}

// A chunk, as section 4.4 of the specification of glTF 2.0 describes it, filled up to a multiple of 4.
void append_chunk(std::vector<std::uint8_t>& to, std::uint32_t type, std::span<const std::uint8_t> data,
                  std::uint8_t filling) {
  const std::size_t padded = (data.size() + 3) / 4 * 4;
  append(to, static_cast<std::uint32_t>(padded));
  append(to, type);
  to.insert(to.end(), data.begin(), data.end());
  to.insert(to.end(), padded - data.size(), filling);
}

// Small whole numbers as floats first, then small bytes, so that positions and indices may both be found.
std::vector<std::uint8_t> made_up_buffer() {
  std::vector<std::uint8_t> bytes;
  for (int i = 0; i < 96; ++i) {
    const auto value = static_cast<float>((i * 7) % 5 - 2);
    std::uint32_t word = 0;
    std::memcpy(&word, &value, sizeof word);
    append(bytes, word);
  }
  for (int i = 0; i < 128; ++i) {
    bytes.push_back(static_cast<std::uint8_t>(i % 8));
  }
  return bytes;
}

std::vector<std::uint8_t> file_of(std::span<const std::uint8_t> bytes) {
  if (bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0) {
    return {bytes.begin(), bytes.end()};
  }
  std::vector<std::uint8_t> chunks;
  append_chunk(chunks, 0x4e4f534aU, bytes, ' ');           // "JSON"
  append_chunk(chunks, 0x004e4942U, made_up_buffer(), 0);  // "BIN"
  std::vector<std::uint8_t> file;
  append(file, 0x46546c67U);  // "glTF"
  append(file, 2);
  append(file, static_cast<std::uint32_t>(12 + chunks.size()));
  file.insert(file.end(), chunks.begin(), chunks.end());
  return file;
}

bool finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

void check(const scenes::Scene& scene) {
  promise(scene.triangles.size() + scene.quadrics.size() > 0, "neither triangles nor curved primitives");
  promise(scene.triangles.size() <= most_triangles && scene.quadrics.size() <= most_triangles,
          "too many of them");
  promise(scene.normals.empty() || scene.normals.size() == scene.positions.size(), "number of normals");
  promise(scene.uvs.empty() || scene.uvs.size() == scene.positions.size(), "number of texture coordinates");
  for (const scenes::Triangle& triangle : scene.triangles) {
    promise(triangle.material < scene.materials.size(), "material out of range");
    for (const std::uint32_t vertex : triangle.vertex) {
      promise(vertex < scene.positions.size() && finite(scene.positions[vertex]), "a corner is no point");
      promise(scene.normals.empty() || finite(scene.normals[vertex]), "a normal is not finite");
    }
  }
  for (const scenes::Material& material : scene.materials) {
    for (const std::uint32_t texture : {material.texture, material.cut_out.texture}) {
      promise(texture == scenes::no_texture || texture < scene.textures.size(), "texture");
    }
    promise(material.cut_out.alpha >= 0.0 && material.cut_out.alpha <= 1.0 && material.cut_out.cutoff >= 0.0,
            "holes of a material");
    promise(material.diffuse >= 0.0 && material.reflection >= 0.0 && material.transmission >= 0.0 &&
                material.ior >= 1.0 && material.shininess >= 1.0,
            "weights of a material");
    promise(finite(material.color) && finite(material.emission), "colour of a material");
  }
  for (const scenes::Light& light : scene.lights) {
    promise(finite(light.position) && finite(light.direction) && finite(light.color), "a light");
  }
  (void)scenes::describe(scene);
}

// Every image is one texel: a library decodes images, not the loader.
scenes::Texture decode(std::span<const std::byte> /*file*/, std::string_view name) {
  const std::array<std::uint8_t, 3> colour = {10, 20, 30};
  return scenes::texture_from_samples(name, 1, 1, 3, colour);
}

}  // namespace

namespace {

const std::filesystem::path& folder() {
  static const test::TemporaryDirectory directory;
  return directory.path();
}

void write(const std::string& name, std::span<const std::uint8_t> bytes) {
  std::ofstream out(folder() / name, std::ios::binary | std::ios::trunc);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  promise(out.good(), "the input could not be written to " + (folder() / name).string());
}

/// Opens a file that was written.
void try_file(const std::string& name) {
  try {
    scenes::FileOptions options;
    options.max_triangles = most_triangles;
    options.max_file_bytes = 1U << 20U;
    options.read_unused = true;
    const scenes::AnimatedScene scene = scenes::open_animated(name, {folder(), options}, decode);
    check(scene.at(0.0));
    for (const double part : {0.3, 1.0}) {
      check(scene.at(part * scene.duration()));
    }
    (void)scenes::describe(scene.facts());
  } catch (const sim::UserError& error) {
    promise(std::string_view(error.what()).starts_with(folder().string()),
            "a message without the path: " + std::string(error.what()));
  }
}

}  // namespace

void try_gltf(std::span<const std::uint8_t> bytes) {
  write("fuzz.glb", file_of(bytes));
  try_file("fuzz.glb");
}

void try_obj(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view mark = "\n#mtl\n";
  const auto library = std::search(bytes.begin(), bytes.end(), mark.begin(), mark.end());
  const auto size = static_cast<std::size_t>(library - bytes.begin());
  write("fuzz.obj", bytes.first(size));
  write("a.mtl", bytes.subspan(std::min(size + mark.size(), bytes.size())));
  try_file("fuzz.obj");
}

void try_ply(std::span<const std::uint8_t> bytes) {
  write("fuzz.ply", bytes);
  try_file("fuzz.ply");
}

void try_pbrt(std::span<const std::uint8_t> bytes) {
  write("fuzz.pbrt", bytes);
  try_file("fuzz.pbrt");
}

void try_rays(std::span<const std::uint8_t> bytes) {
  write("fuzz.npy", bytes);
  const std::filesystem::path file = folder() / "fuzz.npy";
  try {
    const std::uint64_t counted = scenes::count_rays(file);
    const scenes::GivenRays given = scenes::read_rays(file, sim::MemoryBudget(1U << 24U));
    promise(counted > 0 && given.rays.size() == counted, "number of rays");
    promise(given.any.empty() || given.any.size() == counted, "number of kinds of rays");
    for (const scenes::GivenRay& ray : given.rays) {
      promise(finite(ray.origin) && finite(ray.direction) && ray.direction != glm::dvec3(0.0), "a ray");
      promise(ray.least >= 0.0 && std::isfinite(ray.least) && ray.greatest >= ray.least, "a ray's distances");
    }
  } catch (const sim::UserError& error) {
    promise(error.place().key == sim::memory_limit_key ||
                std::string_view(error.what()).starts_with(folder().string()),
            "a message without the path: " + std::string(error.what()));
  }
}

}  // namespace marti::fuzz
