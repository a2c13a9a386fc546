#include "scenes/ply.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scenes/default_view.h"
#include "scenes/gaussian_proxies.h"
#include "scenes/ply_gaussians.h"
#include "scenes/ply_header.h"
#include "scenes/ply_values.h"
#include "scenes/polygon_mesh.h"
#include "scenes/source_file.h"
#include "scenes/text_lines.h"
#include "scenes/vertex_values.h"
#include "sim/shown.h"

namespace marti::scenes {

namespace {

constexpr std::array<const char*, 3> position_names = {"x", "y", "z"};
constexpr std::array<const char*, 3> normal_names = {"nx", "ny", "nz"};
// The format has no names for these; programs use any of them.
constexpr std::array<std::array<const char*, 2>, 4> coordinate_names = {
    {{"u", "v"}, {"s", "t"}, {"texture_u", "texture_v"}, {"texture_s", "texture_t"}}};
constexpr int not_used = -1;

/// The corners of all faces, which may come before the vertices that they refer to.
struct Faces {
  std::vector<std::uint32_t> sizes;
  std::vector<std::uint32_t> corners;
};

class PlyReader {
 public:
  explicit PlyReader(const SourceFile& file)
      : file_(file),
        text_(file.read(1)),
        lines_(text_, sim::shown(file.path().string()), TextLines::Style::plain),
        left_out_{.strict = file.options().strict, .features = {}, .replaced = {}, .first = {}},
        header_(read_ply_header(lines_, text_.size(), left_out_)),
        values_(text_, sim::shown(file.path().string()), header_.format, lines_),
        mesh_(file, scene_),
        memory_(file, "its geometry takes") {}

  AnimatedScene read() {
    const PlyElement* const vertex = element("vertex");
    if (vertex == nullptr) {
      file_.fail("it has no element 'vertex'");
    }
    const bool gaussians = holds_gaussians(*vertex);
    if (element("face") == nullptr && !gaussians) {
      file_.fail_empty("it has no element 'face'");
    }
    vertices_ = vertex->count;
    if (vertices_ > file_.options().max_triangles) {
      file_.fail("it has " + std::to_string(vertices_) + " vertices; at most " +
                 std::to_string(file_.options().max_triangles) + " are accepted");
    }
    for (const PlyElement& element : header_.elements) {
      properties_ += element.properties.size();
      if (element.name == "vertex" && gaussians) {
        take_gaussians(element);
      } else if (element.name == "vertex") {
        read_vertices(element);
      } else if (element.name == "face" && !gaussians) {
        read_faces(element);
      } else {
        skip(element);
      }
    }
    values_.finish();
    if (gaussians) {
      finish_gaussians();
    } else {
      make_triangles();
      mesh_.finish(left_out_);
    }
    scene_.notes.insert(scene_.notes.end(), notes_.begin(), notes_.end());
    FileUse use;
    use.parts = {{"elements", header_.elements.size(), gaussians ? 1U : 2U},
                 {"properties", properties_, properties_used_}};
    return AnimatedScene(std::move(scene_), std::move(use));
  }

 private:
  /// The element of this name; nullptr if the file has none.
  [[nodiscard]] const PlyElement* element(std::string_view name) const {
    const auto found = std::find_if(header_.elements.begin(), header_.elements.end(),
                                    [&](const PlyElement& e) { return e.name == name; });
    return found == header_.elements.end() ? nullptr : &*found;
  }

  /// Reads a property of an entry that nothing is done with.
  void pass_over(const PlyProperty& property) {
    for (std::uint64_t left = property.count ? values_.length(property) : 1; left > 0; --left) {
      if (left_out_.strict) {
        static_cast<void>(values_.value(property.type));
      } else {
        values_.pass_over(property.type);
      }
    }
  }

  void note_unused(const PlyElement& element, const std::vector<std::string>& names) {
    constexpr std::size_t most_names = 8;
    constexpr std::size_t longest_name = 40;
    std::string text;
    for (std::size_t i = 0; i < std::min(names.size(), most_names); ++i) {
      text += (text.empty() ? "" : ", ") + sim::shown(names[i], longest_name);
    }
    notes_.push_back("Left out: " + std::to_string(names.size()) + " properties of the element '" +
                     sim::shown(element.name, longest_name) + "': " + text +
                     (names.size() > most_names ? ", ..." : "") + ".");
  }

  void skip(const PlyElement& element) {
    for (std::uint64_t i = 0; i < element.count; ++i) {
      values_.begin(element, i);
      for (const PlyProperty& property : element.properties) {
        pass_over(property);
      }
      values_.end();
    }
    notes_.push_back("Left out: " + std::to_string(element.count) + " entries of the element '" +
                     sim::shown(element.name, 40) + "'.");
  }

  /// For each property of the vertices the place of its value: 0 to 2 in the position, 3 to 5 in the normal,
  /// 6 and 7 in the texture coordinates.
  std::vector<int> places_of(const PlyElement& element) {
    std::vector<int> places(element.properties.size(), not_used);
    const auto give_places = [&](const auto& names, int first) {
      std::vector<std::size_t> at;
      for (const char* const name : names) {
        const auto found = element.find(name);
        if (!found || element.properties[*found].count) {
          return false;
        }
        at.push_back(*found);
      }
      for (std::size_t axis = 0; axis < at.size(); ++axis) {
        places[at[axis]] = first + static_cast<int>(axis);
      }
      return true;
    };
    if (!give_places(position_names, 0)) {
      file_.fail("its vertices lack one of the properties x, y and z, or it is a list");
    }
    has_normals_ = give_places(normal_names, 3);
    has_coordinates_ = std::any_of(coordinate_names.begin(), coordinate_names.end(),
                                   [&](const auto& names) { return give_places(names, 6); });
    properties_used_ += 3 + (has_normals_ ? 3U : 0U) + (has_coordinates_ ? 2U : 0U);
    std::vector<std::string> unused;
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (places[i] == not_used) {
        unused.push_back(element.properties[i].name);
      }
    }
    if (!unused.empty()) {
      note_unused(element, unused);
    }
    return places;
  }

  void read_vertices(const PlyElement& element) {
    const std::vector<int> places = places_of(element);
    file_.take_memory(vertices_ * (sizeof(glm::dvec3) * (has_normals_ ? 2 : 1) +
                                   (has_coordinates_ ? sizeof(glm::dvec2) : 0)),
                      "its vertices take");
    scene_.positions.reserve(vertices_);
    scene_.normals.reserve(has_normals_ ? vertices_ : 0);
    scene_.uvs.reserve(has_coordinates_ ? vertices_ : 0);
    for (std::uint64_t i = 0; i < vertices_; ++i) {
      values_.begin(element, i);
      std::array<double, 8> given{};
      for (std::size_t p = 0; p < places.size(); ++p) {
        if (places[p] == not_used) {
          pass_over(element.properties[p]);
        } else {
          const PlyType type = element.properties[p].type;
          given[static_cast<std::size_t>(places[p])] =
              places[p] < 3 ? values_.value(type) : values_.any_number(type, left_out_);
        }
      }
      values_.end();
      scene_.positions.emplace_back(given[0], given[1], given[2]);
      if (has_normals_) {
        scene_.normals.push_back(unit_or_zero({given[3], given[4], given[5]}));
      }
      if (has_coordinates_) {
        scene_.uvs.push_back(turned_coordinates(given[6], given[7]));
      }
    }
  }

  void take_gaussians(const PlyElement& element) {
    std::uint64_t unseen = 0;
    auto gaussians = std::make_shared<Gaussians>(read_gaussians(element, values_, file_, unseen));
    properties_used_ = 11 + 3 * gaussians->terms();
    if (unseen > 0) {
      notes_.push_back("Left out: " + std::to_string(unseen) + " of " + std::to_string(element.count) +
                       " Gaussians, which are too transparent to be seen (an alpha of at most 1/255).");
    }
    scene_.gaussians = std::move(gaussians);
  }

  void finish_gaussians() {
    if (scene_.gaussians->shapes.empty()) {
      file_.fail_empty("none of its Gaussians can be seen");
    }
    stand_proxies(scene_, file_.options().instances, file_.options().max_triangles);
    scene_.name = file_.path().filename().string();
    scene_.framed = true;
    set_view(scene_, file_.options());
    note_left_out(left_out_, scene_);
  }

  void read_faces(const PlyElement& element) {
    auto list = element.find("vertex_indices");
    list = list ? list : element.find("vertex_index");
    if (!list || !element.properties[*list].count || !is_integer(element.properties[*list].type)) {
      file_.fail("its faces have no list of integers vertex_indices or vertex_index");
    }
    ++properties_used_;
    std::vector<std::string> unused;
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      if (p != *list) {
        unused.push_back(element.properties[p].name);
      }
    }
    if (!unused.empty()) {
      note_unused(element, unused);
    }
    for (std::uint64_t i = 0; i < element.count; ++i) {
      values_.begin(element, i);
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        if (p == *list) {
          read_corners(element.properties[p]);
        } else {
          pass_over(element.properties[p]);
        }
      }
      values_.end();
    }
  }

  void read_corners(const PlyProperty& list) {
    const std::uint64_t count = values_.length(list);
    if (const std::string reason = mesh_.refusal(count); !reason.empty()) {
      values_.fail(reason);
    }
    memory_.grow(sizeof(std::uint32_t) * (count + 1) + sizeof(Triangle) * (count - 2));
    faces_.sizes.push_back(static_cast<std::uint32_t>(count));
    for (std::uint64_t i = 0; i < count; ++i) {
      const double corner = values_.value(list.type);
      if (!(corner >= 0.0 && corner < static_cast<double>(vertices_))) {
        values_.fail("a corner refers to vertex " + std::to_string(static_cast<std::int64_t>(corner)) +
                     ", but the file has " + std::to_string(vertices_) + ", from 0");
      }
      faces_.corners.push_back(static_cast<std::uint32_t>(corner));
    }
  }

  void make_triangles() {
    scene_.materials.emplace_back();
    std::vector<glm::dvec3> positions;
    std::size_t first = 0;
    for (const std::uint32_t size : faces_.sizes) {
      const std::span<const std::uint32_t> corners(faces_.corners.data() + first, size);
      positions.clear();
      for (const std::uint32_t corner : corners) {
        positions.push_back(scene_.positions[corner]);
      }
      mesh_.add(corners, positions, 0);
      first += size;
    }
    for (glm::dvec3& position : scene_.positions) {
      position = is_usable(position) ? position : glm::dvec3(0.0);  // no triangle uses it
    }
  }

  const SourceFile& file_;
  std::string text_;
  TextLines lines_;
  LeftOut left_out_;
  PlyHeader header_;
  PlyValues values_;
  Scene scene_;
  PolygonMesh mesh_;
  GrowingMemory memory_;
  std::uint64_t vertices_ = 0;
  std::uint64_t properties_ = 0;
  std::uint64_t properties_used_ = 0;
  bool has_normals_ = false;
  bool has_coordinates_ = false;
  Faces faces_;
  std::vector<std::string> notes_;
};

}  // namespace

AnimatedScene open_ply(const std::filesystem::path& path, const FileOptions& options) {
  const SourceFile file(path, options);
  try {
    return PlyReader(file).read();
  } catch (const std::bad_alloc&) {
    file.fail("there is not enough memory for its scene");
  }
}

}  // namespace marti::scenes
