// Cases of input that is no geometry: not numbers, infinities, directions of no length.
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "accel/precision.h"
#include "scenes/gltf_export.h"
#include "scenes/open.h"
#include "scenes/procedural.h"
#include "sim/error.h"
#include "sim/files.h"
#include "studies/stability/geometry_oracles.h"

namespace marti::studies::stability {

namespace {

using accel::Ray;
using accel::TriangleSet;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

CaseOutcome bad_vertex(double value) {
  return refuses(
      [value] {
        std::vector<accel::TriangleCorners> soup = hostile_soup(0.0, 61);
        soup[7][4] = value;
        (void)TriangleSet(std::move(soup));
      },
      "triangle 7 has a coordinate that is not a number");
}

/// A directory of its own among the temporary files, removed with this object.
class OwnDirectory {
 public:
  OwnDirectory() : path_((std::filesystem::temp_directory_path() / "marti-stability-XXXXXX").string()) {
    if (::mkdtemp(path_.data()) == nullptr) {
      throw sim::UserError(path_ + ": cannot make a temporary directory: " + std::strerror(errno));
    }
  }
  OwnDirectory(const OwnDirectory&) = delete;
  OwnDirectory& operator=(const OwnDirectory&) = delete;
  ~OwnDirectory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

  [[nodiscard]] std::filesystem::path path() const { return path_; }

 private:
  std::string path_;
};

/// The scene as a file has it, in floats; with `value` for one coordinate of triangle `bad`.
scenes::Scene through_a_file(const scenes::Scene& scene, std::size_t bad = 0,
                             std::optional<float> value = {}) {
  const OwnDirectory directory;
  const std::filesystem::path path = directory.path() / "case.glb";
  scenes::export_glb(scene, path);
  if (value) {
    const glm::vec3 corner(scene.positions[3 * bad + 1]);
    std::string bytes = sim::read_file(path, std::int64_t{1} << 30);
    const std::size_t at = bytes.find(std::string(reinterpret_cast<const char*>(&corner), sizeof corner));
    std::memcpy(bytes.data() + at + sizeof(float), &*value, sizeof(float));
    sim::write_file(path, bytes);
  }
  return scenes::open_scene(path.string(), {}, {});
}

/// One corner of 10,000 triangles has a coordinate that is not finite: the scene is the other 9,999, with one
/// note.
CaseOutcome gltf_with(float value, const CaseSize& size) {
  constexpr std::size_t triangles = 10'000;
  constexpr std::size_t bad = 1234;
  Random random(62);
  scenes::Scene all;
  all.materials.emplace_back();
  for (std::uint32_t k = 0; k < triangles; ++k) {
    const glm::dvec3 a = random.in_box(glm::dvec3(0.05), glm::dvec3(0.95));
    for (const glm::dvec3& p : {a, a + 0.02 * random.direction(), a + 0.02 * random.direction()}) {
      all.positions.push_back(p);
    }
    all.triangles.push_back({{3 * k, 3 * k + 1, 3 * k + 2}, 0, k});
  }
  all.polygons = triangles;
  scenes::Scene rest = all;
  rest.triangles.erase(rest.triangles.begin() + bad);
  const scenes::Scene scene = through_a_file(all, bad, value);
  const scenes::Scene expected = through_a_file(rest);
  const auto a = std::make_shared<const TriangleSet>(scene);
  const auto b = std::make_shared<const TriangleSet>(expected);
  const accel::Octree with = accel::Octree::build(a);
  const accel::Octree without = accel::Octree::build(b);
  RayMaker maker(*b, without.bounds(), 63);
  Tally tally;
  for (std::uint32_t k = 0; k < size.rays; ++k) {
    const Ray ray = maker.make(all_aims[k % all_aims.size()]);
    accel::NullVisitor visitor;
    tally.add(same_hit(with.closest(ray, visitor), without.closest(ray, visitor)));
  }
  std::size_t notes = 0;
  for (const std::string& note : scene.notes) {
    notes += note.find("not finite") != std::string::npos ? 1U : 0U;
  }
  CaseOutcome outcome = none_wrong(tally, "rays differ");
  outcome.value += a->size() == triangles - 1 && notes == 1 ? 0.0 : 1.0;
  outcome.figure += fmt::format("; {} triangles left, {} note", tables::grouped(a->size()), notes);
  return outcome;
}

/// Every structure must refuse the ray, and not walk for ever.
CaseOutcome bad_ray(const Ray& ray) {
  const auto triangles = std::make_shared<const TriangleSet>(hostile_soup(0.0, 64));
  Tally tally;
  for (const auto& structure : build_structures(triangles)) {
    bool refused = false;
    try {
      (void)structure->closest(ray);
    } catch (const sim::InternalError&) {
      refused = true;
    }
    tally.add(refused);
  }
  return none_wrong(tally, "structures took it");
}

/// Double precision must be recommended just where triangles collapse in floats.
CaseOutcome recommendation() {
  const scenes::Scene teapot = scenes::make_procedural("teapot:4");
  std::string asked;
  Tally tally;
  for (const double offset : {0.0, 1e3, 1e6, 1e9}) {
    scenes::Scene moved = teapot;
    for (glm::dvec3& p : moved.positions) {
      p += glm::dvec3(offset);
    }
    const accel::PrecisionNeed need = accel::precision_need(TriangleSet(moved));
    tally.add(need.wants_double() == (offset >= 1e6));
    asked += fmt::format("{} at {:g}", need.collapsed, offset) + (offset < 1e9 ? ", " : "");
  }
  CaseOutcome outcome = none_wrong(tally, "places advised wrongly");
  outcome.figure += "; triangles that collapse in floats: " + asked;
  return outcome;
}

}  // namespace

void add_input_cases(std::vector<StabilityCase>& cases) {
  const CaseAdder add(cases, CaseGroup::geometry);
  add("nan-vertex", "a coordinate that is no number poisons the bounds of the whole tree",
      "refused, with the triangle's number", [] { return bad_vertex(not_a_number); });
  add("infinite-vertex", "an infinite coordinate makes every cell infinite",
      "refused, with the triangle's number", [] { return bad_vertex(-infinity); });
  add("gltf-nan", "one NaN among 10,000 triangles of a file", "hits of the file without it, and one note",
      [](const CaseSize& size) { return gltf_with(std::numeric_limits<float>::quiet_NaN(), size); });
  add("gltf-infinity", "one infinity among 10,000 triangles of a file",
      "hits of the file without it, and one note",
      [](const CaseSize& size) { return gltf_with(std::numeric_limits<float>::infinity(), size); });
  add("direction-zero", "a ray that goes nowhere walks for ever", "an error, in every structure", [] {
    return bad_ray({{0, 0, 0}, {0, -0.0, 0}});
  });
  add("direction-nan", "a direction that is no number walks for ever", "an error, in every structure", [] {
    return bad_ray({{0, 0, 0}, {1, not_a_number, 0}});
  });
  add("origin-infinite", "an origin at infinity walks for ever", "an error, in every structure", [] {
    return bad_ray({{infinity, 0, 0}, {1, 0, 0}});
  });
  add("advice", "doubles are advised where floats would do, or not where they lose triangles",
      "teapot at 0 and 1e3: no; at 1e6 and 1e9: yes", recommendation);
}

}  // namespace marti::studies::stability
