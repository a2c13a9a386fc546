#include "scenes/obj.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <cstdint>
#include <limits>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "scenes/obj_materials.h"
#include "scenes/obj_statements.h"
#include "scenes/polygon_mesh.h"
#include "scenes/source_file.h"
#include "scenes/text_lines.h"
#include "scenes/vertex_values.h"
#include "sim/error.h"
#include "sim/shown.h"

namespace marti::scenes {

namespace {

constexpr std::uint32_t not_given = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint32_t out_of_range = not_given - 1;  // no list is as long

/// A corner of a face; it becomes a vertex of the scene together with all equal ones.
struct Corner {
  std::uint32_t position = not_given;
  std::uint32_t coordinates = not_given;
  std::uint32_t normal = not_given;
  auto operator<=>(const Corner&) const = default;
};

class ObjReader {
 public:
  ObjReader(const SourceFile& file, const ImageDecoder& decode)
      : file_(file),
        text_(text_of(file)),
        lines_(text_, sim::shown(file.path().string()), TextLines::Style::wavefront),
        mesh_(file, scene_),
        materials_(file, decode, scene_, left_out_),
        memory_(file, "its geometry takes") {
    left_out_.strict = file.options().strict;
  }

  AnimatedScene read() {
    while (lines_.next()) {
      statement();
    }
    if (file_.options().read_unused) {
      materials_.check_unused();
    }
    make_vertices();
    mesh_.finish(left_out_);
    FileUse use;
    use.parts = {{"materials", materials_.known(), materials_.used()}};
    return AnimatedScene(std::move(scene_), std::move(use));
  }

 private:
  /// The file's text; one in UTF-16 is converted, which takes up to 1.5 times as much.
  static std::string text_of(const SourceFile& file) {
    std::string text = file.read(1);
    if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff")) {
      file.take_memory(2 * text.size(), "it takes");
    }
    return in_utf8(std::move(text));
  }

  void statement() {
    const std::string_view word = lines_.words().front();
    if (word == "v") {
      add_position();
    } else if (word == "vn") {
      normals_.push_back(unit_or_zero(vector(3)));
      grow(normals_);
    } else if (word == "vt") {
      const glm::dvec3 given = vector(1);
      coordinates_.push_back(turned_coordinates(given.x, given.y));
      grow(coordinates_);
    } else if (word == "f" || word == "fo") {
      add_face();
    } else if (word == "usemtl") {
      materials_.choose(lines_);
    } else if (word == "mtllib") {
      materials_.add_libraries(lines_);
    } else if (!is_without_effect(word)) {
      const char* const kind = left_out_kind(word);
      if (kind == nullptr) {
        lines_.fail(in_quotes(word) + " is no statement of an OBJ file");
      }
      left_out_.features[kind] += 1;
    }
  }

  template <class T>
  void grow(const std::vector<T>& list) {
    if (list.size() > file_.options().max_triangles) {
      lines_.fail("the scene has more than " + std::to_string(file_.options().max_triangles) +
                  " vertices, which is more than is accepted");
    }
    memory_.grow(sizeof(T));
  }

  /// The numbers of a statement, of which `least` to 3 must be given.
  glm::dvec3 vector(std::size_t least) {
    lines_.drop_comment();
    const std::size_t count = lines_.words().size() - 1;
    if (count < least || count > 3) {
      lines_.fail(in_quotes(lines_.words().front()) + " needs " +
                  (least < 3 ? std::to_string(least) + " to 3" : "3") + " numbers, not " +
                  std::to_string(count));
    }
    glm::dvec3 result(0.0);
    for (std::size_t i = 0; i < count; ++i) {
      result[static_cast<int>(i)] = lines_.number(i + 1);
    }
    return result;
  }

  /// x y z, then a weight or a colour.
  void add_position() {
    lines_.drop_comment();
    const std::size_t count = lines_.words().size() - 1;
    if (count != 3 && count != 4 && count != 6 && count != 7) {
      lines_.fail("'v' needs 3 numbers, or more of them for a weight (4), a colour (6) or both (7), not " +
                  std::to_string(count));
    }
    positions_.emplace_back(lines_.number(1), lines_.number(2), lines_.number(3));
    grow(positions_);
    for (std::size_t i = 4; i <= count; ++i) {
      const double value = lines_.number(i);
      left_out_.features["weights of vertices"] += (count == 4 || count == 7) && i == 4 && value != 1.0;
    }
    left_out_.features["colours of vertices"] += count >= 6 ? 1U : 0U;
  }

  void add_face() {
    lines_.drop_comment();
    const std::size_t count = lines_.words().size() - 1;
    if (const std::string reason = mesh_.refusal(count); !reason.empty()) {
      lines_.fail(reason);
    }
    const std::uint32_t material = materials_.current();
    const CutOut& cut_out = scene_.materials[material].cut_out;
    const bool textured = scene_.materials[material].texture != no_texture || cut_out.asks();
    const std::size_t first = corners_.size();
    face_.clear();
    numbers_.clear();
    Corner given;
    bool usable_normals = true;
    bool usable_coordinates = true;
    for (std::size_t i = 0; i < count; ++i) {
      Corner corner = corner_of(lines_.words()[i + 1]);
      if (i > 0 && ((corner.coordinates == not_given) != (given.coordinates == not_given) ||
                    (corner.normal == not_given) != (given.normal == not_given))) {
        lines_.fail("its corners have different parts: " + in_quotes(lines_.words()[1]) + " and " +
                    in_quotes(lines_.words()[i + 1]));
      }
      given = corner;
      usable_normals = usable_normals && corner.normal != out_of_range;
      usable_coordinates = usable_coordinates && corner.coordinates != out_of_range;
      // Without a texture, corners that differ in their coordinates only are one vertex.
      corner.coordinates = textured ? corner.coordinates : not_given;
      corners_.push_back(corner);
      face_.push_back(positions_[corner.position]);
      numbers_.push_back(static_cast<std::uint32_t>(first + i));
    }
    for (std::size_t i = first; i < corners_.size(); ++i) {
      corners_[i].normal = usable_normals ? corners_[i].normal : not_given;
      corners_[i].coordinates = usable_coordinates ? corners_[i].coordinates : not_given;
    }
    given.normal = usable_normals ? given.normal : not_given;
    given.coordinates = usable_coordinates ? given.coordinates : not_given;
    if (cut_out.asks() && given.coordinates == not_given) {
      left_out_.replace("texture coordinates of cut-outs that are not given, by (0, 0)",
                        lines_.refusal("a face whose material has map_d needs texture coordinates"));
    }
    if (cut_out.everywhere()) {
      left_out_.features["faces that are cut out as a whole"] += 1;
      corners_.resize(first);
      return;
    }
    if (!mesh_.add(numbers_, face_, material)) {
      corners_.resize(first);
      return;
    }
    has_coordinates_ |= textured && given.coordinates != not_given;
    has_normals_ |= given.normal != not_given;
    left_out_.features["textures on faces without texture coordinates"] +=
        textured && given.coordinates == not_given ? 1U : 0U;
    memory_.grow(count * (sizeof(Corner) + sizeof(Triangle) + sizeof(glm::dvec3)));
  }

  /// "7", "7/3", "7//2" or "7/3/2".
  [[nodiscard]] Corner corner_of(std::string_view word) {
    std::array<std::string_view, 3> parts;
    const auto slashes = static_cast<std::size_t>(std::count(word.begin(), word.end(), '/'));
    std::string_view rest = word;
    for (std::size_t i = 0; i < std::min(slashes + 1, parts.size()); ++i) {
      parts[i] = rest.substr(0, rest.find('/'));
      rest.remove_prefix(std::min(parts[i].size() + 1, rest.size()));
    }
    if (slashes > 2 || parts[0].empty() || (slashes > 0 && parts[slashes].empty())) {
      lines_.fail(in_quotes(word) + " is no corner of a face; one is v, v/vt, v//vn or v/vt/vn");
    }
    Corner corner;
    std::string refusal;
    corner.position = index(parts[0], positions_.size(), "position", refusal);
    if (corner.position == out_of_range) {
      throw sim::UserError(refusal);
    }
    if (!parts[1].empty()) {
      corner.coordinates = index(parts[1], coordinates_.size(), "texture coordinate", refusal);
      if (corner.coordinates == out_of_range) {
        left_out_.replace("texture coordinates of corners that are not given, by none of the face", refusal);
      }
    }
    if (slashes == 2) {
      corner.normal = index(parts[2], normals_.size(), "normal", refusal);
      if (corner.normal == out_of_range) {
        left_out_.replace("normals of corners that are not given, by the face's own", refusal);
      }
    }
    return corner;
  }

  /// The place in a list of a number from 1, or counted back from -1, the last so far. `out_of_range`, and
  /// the reason in `refusal`, if there is no such place.
  [[nodiscard]] std::uint32_t index(std::string_view text, std::size_t size, const char* kind,
                                    std::string& refusal) const {
    const std::int64_t given = lines_.integer(text);
    const std::int64_t place = given < 0 ? given + static_cast<std::int64_t>(size) : given - 1;
    if (place < 0 || place >= static_cast<std::int64_t>(size)) {
      refusal = lines_.refusal("a corner refers to " + std::string(kind) + " " + std::to_string(given) +
                               ", but " + std::to_string(size) + " are given before it");
      return out_of_range;
    }
    return static_cast<std::uint32_t>(place);
  }

  /// Replaces the corners in the scene's triangles by vertices.
  void make_vertices() {
    std::vector<Corner> vertices = corners_;
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    for (Triangle& triangle : scene_.triangles) {
      for (std::uint32_t& vertex : triangle.vertex) {
        const auto found = std::lower_bound(vertices.begin(), vertices.end(), corners_[vertex]);
        vertex = static_cast<std::uint32_t>(found - vertices.begin());
      }
    }
    file_.take_memory(
        vertices.size() * (sizeof(Corner) + sizeof(glm::dvec3) + (has_normals_ ? sizeof(glm::dvec3) : 0) +
                           (has_coordinates_ ? sizeof(glm::dvec2) : 0)),
        "its geometry takes");
    for (const Corner& vertex : vertices) {
      scene_.positions.push_back(positions_[vertex.position]);
      if (has_normals_) {
        scene_.normals.push_back(vertex.normal == not_given ? glm::dvec3(0.0) : normals_[vertex.normal]);
      }
      if (has_coordinates_) {
        scene_.uvs.push_back(vertex.coordinates == not_given ? glm::dvec2(0.0)
                                                             : coordinates_[vertex.coordinates]);
      }
    }
  }

  const SourceFile& file_;
  std::string text_;
  TextLines lines_;
  Scene scene_;
  LeftOut left_out_;
  PolygonMesh mesh_;
  ObjMaterials materials_;
  GrowingMemory memory_;
  std::vector<glm::dvec3> positions_;
  std::vector<glm::dvec3> normals_;
  std::vector<glm::dvec2> coordinates_;
  std::vector<Corner> corners_;         // of all faces, numbered in the scene's triangles
  std::vector<glm::dvec3> face_;        // positions of the face that is read
  std::vector<std::uint32_t> numbers_;  // of its corners
  bool has_coordinates_ = false;
  bool has_normals_ = false;
};

}  // namespace

AnimatedScene open_obj(const std::filesystem::path& path, const FileOptions& options,
                       const ImageDecoder& decode) {
  const SourceFile file(path, options);
  try {
    return ObjReader(file, decode).read();
  } catch (const std::bad_alloc&) {
    file.fail("there is not enough memory for its scene");
  }
}

}  // namespace marti::scenes
