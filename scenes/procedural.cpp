#include "scenes/procedural.h"

#include <array>
#include <charconv>
#include <string>
#include <system_error>
#include <vector>

#include "scenes/spd.h"
#include "sim/error.h"
#include "sim/nearest.h"

namespace marti::scenes {

namespace {

constexpr std::array<ProceduralVariant, 1> teapot_variants = {
    ProceduralVariant{"pot", "the pot alone, without the chequered board"}};

// The largest sizes give about 16 million triangles.
constexpr std::array<ProceduralScene, 3> registry = {
    ProceduralScene{
        "gears", 1, 30, 4, "n x n x n meshing gears over a ground, some of glass; 146 n^3 + 1 polygons", {}},
    ProceduralScene{"teapot", 2, 500, 12,
                    "the Utah teapot on a board of n x n squares, each of its 32 patches cut n x n; "
                    "64 n^2 - 8 n triangles without the board",
                    teapot_variants},
    ProceduralScene{"tetra", 1, 12, 6, "a Sierpinski tetrahedron; 4^n triangles", {}}};

/// `text` up to the next colon, which is taken off `rest` as well.
std::string_view next_part(std::string_view& rest) {
  const std::size_t colon = rest.find(':');
  const std::string_view part = rest.substr(0, colon);
  rest = colon == std::string_view::npos ? std::string_view{} : rest.substr(colon + 1);
  return part;
}

template <typename Range>
std::vector<std::string> names_of(const Range& range) {
  std::vector<std::string> names;
  for (const auto& item : range) {
    names.emplace_back(item.name);
  }
  return names;
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) {
    text += text.empty() ? "" : ", ";
    text += name;
  }
  return text;
}

const ProceduralScene& find_scene(std::string_view name, const std::string& where) {
  for (const ProceduralScene& scene : registry) {
    if (scene.name == name) {
      return scene;
    }
  }
  const std::vector<std::string> names = names_of(registry);
  throw sim::UserError(where + "there is no procedural scene of this name" + sim::did_you_mean(name, names) +
                       "; known are " + joined(names) + ", and files ending in .gltf or .glb");
}

std::uint32_t parse_size(std::string_view text, const ProceduralScene& scene, const std::string& where) {
  std::uint32_t size = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), size);
  const bool is_number = error != std::errc::invalid_argument && end == text.data() + text.size();
  if (!is_number || error != std::errc{} || size < scene.minimum_size || size > scene.maximum_size) {
    throw sim::UserError(where + "the size of " + std::string(scene.name) + " must be a whole number from " +
                         std::to_string(scene.minimum_size) + " to " + std::to_string(scene.maximum_size) +
                         ", as in " + std::string(scene.name) + ":" + std::to_string(scene.default_size));
  }
  return size;
}

}  // namespace

std::span<const ProceduralScene> procedural_scenes() { return registry; }

Scene make_procedural(std::string_view spec) {
  const std::string where = "scene '" + std::string(spec) + "': ";
  std::string_view rest = spec;
  const ProceduralScene& kind = find_scene(next_part(rest), where);
  const bool has_size = kind.name.size() < spec.size();
  const bool has_variant = has_size && rest.find(':') != std::string_view::npos;
  const std::uint32_t size = has_size ? parse_size(next_part(rest), kind, where) : kind.default_size;
  if (has_variant) {
    const std::vector<std::string> names = names_of(kind.variants);
    bool known = false;
    for (const std::string& name : names) {
      known = known || name == rest;
    }
    if (!known) {
      throw sim::UserError(where + std::string(kind.name) +
                           (names.empty() ? " has no variants"
                                          : " has no such variant" + sim::did_you_mean(rest, names) +
                                                "; known are " + joined(names)));
    }
  }
  Scene scene;
  if (kind.name == "gears") {
    scene = spd::make_gears(size);
  } else if (kind.name == "teapot") {
    scene = spd::make_teapot(size, !has_variant);
  } else {
    scene = spd::make_tetra(size);
  }
  scene.name = std::string(kind.name) + ":" + std::to_string(size);
  if (has_variant) {
    scene.name += ':';
    scene.name += rest;
  }
  return scene;
}

}  // namespace marti::scenes
