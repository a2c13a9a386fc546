#include "scenes/procedural.h"

#include <array>
#include <string>
#include <vector>

#include "scenes/gaussian_proxies.h"
#include "scenes/spd.h"
#include "sim/error.h"
#include "sim/nearest.h"
#include "sim/parse_number.h"
#include "sim/shown.h"

namespace marti::scenes {

namespace {

// While a scene is made: a triangle with its share of vertices and their index, or a sphere, cylinder or
// cone, in lists that grow by doubling.
constexpr std::uint64_t bytes_a_primitive = 160;
// With the teapot's triangle from which it is made.
constexpr std::uint64_t bytes_a_gaussian = sizeof(Gaussian) + 48 * sizeof(float) + bytes_a_primitive;

constexpr std::array<ProceduralVariant, 1> teapot_variants = {
    ProceduralVariant{"pot", "the pot alone, without the chequered board"}};

/// The n-th power of a whole number.
constexpr std::uint64_t power(std::uint64_t base, std::uint64_t n) {
  std::uint64_t product = 1;
  for (; n > 0; --n) {
    product *= base;
  }
  return product;
}

// The largest sizes give at most about 17 million triangles, or 1.1 million spheres, cylinders and cones.
constexpr std::array<ProceduralScene, 14> registry = {
    ProceduralScene{"balls",
                    0,
                    6,
                    4,
                    "a flake of spheres, n generations of them, on a floor; (9^(n+1) - 1) / 8 spheres",
                    {},
                    [](std::uint64_t n) { return (power(9, n + 1) - 1) / 8 + 2; }},
    ProceduralScene{
        "gaussians",
        2,
        160,
        12,
        "the surface of teapot:n:pot as Gaussians, with baked light; 64 n^2 - 8 n of them, each in a "
        "proxy of 20 triangles",
        {},
        [](std::uint64_t n) { return proxy_triangles * (64 * n * n - 8 * n); }},
    ProceduralScene{"gears",
                    1,
                    30,
                    4,
                    "n x n x n meshing gears over a ground, some of glass; 146 n^3 + 1 polygons",
                    {},
                    [](std::uint64_t n) { return 572 * n * n * n + 2; }},
    ProceduralScene{"jacks",
                    1,
                    6,
                    4,
                    "a toy jack with eight of half its size in its corners, n generations; "
                    "3 (8^n - 1) / 7 cylinders and twice as many spheres",
                    {},
                    [](std::uint64_t n) { return 9 * (power(8, n) - 1) / 7; }},
    ProceduralScene{"large",
                    1,
                    1,
                    1,
                    "gears:2 and two teapots of 12 without boards; 19,409 polygons",
                    {},
                    [](std::uint64_t /*n*/) { return std::uint64_t{22'818}; }},
    ProceduralScene{"lattice",
                    1,
                    50,
                    12,
                    "spheres on an n x n x n lattice joined by rods; (n+1)^3 spheres, 3 n (n+1)^2 cylinders",
                    {},
                    [](std::uint64_t n) { return (n + 1) * (n + 1) * (4 * n + 1); }},
    ProceduralScene{"mount",
                    1,
                    7,
                    6,
                    "a fractal mountain and four glass balls; 2 * 4^n triangles, 4 spheres",
                    {},
                    [](std::uint64_t n) { return 2 * power(4, n) + 4; }},
    ProceduralScene{"rings",
                    1,
                    30,
                    7,
                    "interlocking rings in a pyramid of n layers before a wall; 5 n (n+1) (2n+1) "
                    "spheres and as many cylinders",
                    {},
                    [](std::uint64_t n) { return 10 * n * (n + 1) * (2 * n + 1) + 2; }},
    ProceduralScene{
        "room",
        2,
        500,
        12,
        "a matt teapot of n x n cuts a patch and a mirrored ball in a closed white room with one red "
        "and one green wall, lit by an emissive panel; without lights, for path tracing",
        {},
        [](std::uint64_t n) { return 64 * n * n - 8 * n + 21; }},
    ProceduralScene{"shells",
                    0,
                    10,
                    1,
                    "a sea shell; 180 * 2^n + 1 spheres",
                    {},
                    [](std::uint64_t n) { return 180 * power(2, n) + 1; }},
    ProceduralScene{"sombrero",
                    1,
                    6,
                    2,
                    "a ripple as a height field, its side doubled n - 1 times; 2 (16 * 2^n - 1)^2 triangles",
                    {},
                    [](std::uint64_t n) { return 2 * power(power(2, n + 4) - 1, 2); }},
    ProceduralScene{"teapot", 2, 500, 12,
                    "the Utah teapot on a board of n x n squares, each of its 32 patches cut n x n; "
                    "64 n^2 - 8 n triangles without the board",
                    teapot_variants, [](std::uint64_t n) { return 66 * n * n - 8 * n; }},
    ProceduralScene{"tetra",
                    1,
                    12,
                    6,
                    "a Sierpinski tetrahedron; 4^n triangles",
                    {},
                    [](std::uint64_t n) { return power(4, n); }},
    ProceduralScene{"tree",
                    0,
                    17,
                    11,
                    "a bare tree that forks n times, on a field; 2^(n+1) - 1 cones and as many spheres",
                    {},
                    [](std::uint64_t n) { return 2 * power(2, n + 1); }}};

Scene make(std::string_view name, std::uint32_t size, bool whole) {
  struct Recipe {
    std::string_view name;
    Scene (*make)(std::uint32_t size);
  };
  static constexpr std::array<Recipe, 12> recipes = {
      Recipe{"balls", spd::make_balls},     Recipe{"gaussians", spd::make_gaussians},
      Recipe{"gears", spd::make_gears},     Recipe{"jacks", spd::make_jacks},
      Recipe{"lattice", spd::make_lattice}, Recipe{"mount", spd::make_mount},
      Recipe{"rings", spd::make_rings},     Recipe{"room", spd::make_room},
      Recipe{"shells", spd::make_shells},   Recipe{"sombrero", spd::make_sombrero},
      Recipe{"tetra", spd::make_tetra},     Recipe{"tree", spd::make_tree}};
  for (const Recipe& recipe : recipes) {
    if (recipe.name == name) {
      return recipe.make(size);
    }
  }
  return name == "teapot" ? spd::make_teapot(size, whole) : spd::make_large();
}

/// The part of the text up to the next colon; removes it from `rest`.
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
                       "; known are " + joined(names) +
                       ", and files ending in .gltf, .glb, .obj, .ply or .pbrt");
}

std::uint32_t parse_size(std::string_view text, const ProceduralScene& scene, const std::string& where) {
  const auto size = sim::parse_number<std::uint32_t>(text);
  if (!size || *size < scene.minimum_size || *size > scene.maximum_size) {
    throw sim::UserError(where + "the size of " + std::string(scene.name) + " must be a whole number from " +
                         std::to_string(scene.minimum_size) + " to " + std::to_string(scene.maximum_size) +
                         ", as in " + std::string(scene.name) + ":" + std::to_string(scene.default_size));
  }
  return *size;
}

}  // namespace

std::span<const ProceduralScene> procedural_scenes() { return registry; }

Scene make_procedural(std::string_view spec, const sim::MemoryBudget& memory, Instances instances) {
  const std::string where = "scene '" + sim::shown(spec) + "': ";
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
  const std::uint64_t primitives = kind.primitives(size);
  const bool gaussians = kind.name == "gaussians";
  memory.require(gaussians ? bytes_of_proxies(primitives / proxy_triangles, instances) +
                                 primitives / proxy_triangles * bytes_a_gaussian
                           : primitives * bytes_a_primitive,
                 "the scene '" + sim::shown(spec) + "' takes", "take a smaller scene");
  Scene scene = make(kind.name, size, !has_variant);
  if (gaussians) {
    stand_proxies(scene, instances, FileOptions().max_triangles);
  }
  scene.name = kind.name;
  scene.lights_are_all = true;
  if (kind.minimum_size != kind.maximum_size) {
    scene.name += ":" + std::to_string(size);
  }
  if (has_variant) {
    scene.name += ':';
    scene.name += rest;
  }
  return scene;
}

}  // namespace marti::scenes
