// PLY files as text and in binary, and how broken and malicious ones are refused.
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "loaded_scene.h"
#include "ply_text.h"
#include "scenes/ply.h"
#include "sim/shown.h"
#include "text_scene.h"

namespace marti::scenes {
namespace {

using testing::corner;
using testing::has_note;
using testing::name_of;
using testing::ply_file;
using testing::PlyBody;
using testing::PlyOrder;
using testing::SceneFolder;

constexpr std::array<PlyOrder, 3> orders = {PlyOrder::text, PlyOrder::little, PlyOrder::big};

// A unit square with whatever else a file may have around the parts that are used.
template <class Count, class Index>
std::string decorated(PlyOrder order, const char* count, const char* index) {
  const std::string declarations =
      "comment made by a test\nobj_info nothing\nelement camera 1\nproperty double f\nproperty list uchar "
      "short l\n"
      "element face 2\nproperty uchar red\nproperty list " +
      std::string(count) + " " + index +
      " vertex_index\nproperty list char float uv\nelement vertex 4\nproperty float z\nproperty uchar alpha\n"
      "property double x\nproperty float ny\nproperty short y\nproperty float nz\nproperty float nx\n";
  PlyBody body(order);
  body.add(2.5).add(std::uint8_t{3}).add(std::int16_t{-1}).add(std::int16_t{2}).add(std::int16_t{3}).end();
  body.add(std::uint8_t{255}).add(Count{4});
  for (const int i : {0, 1, 2, 3}) {
    body.add(static_cast<Index>(i));
  }
  body.add(std::int8_t{0}).end();
  body.add(std::uint8_t{0}).add(Count{3});
  for (const int i : {2, 1, 0}) {
    body.add(static_cast<Index>(i));
  }
  body.add(std::int8_t{1}).add(0.5F).end();
  constexpr std::array<std::array<int, 2>, 4> places = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  for (const auto& [x, y] : places) {
    body.add(0.1F).add(std::uint8_t{7}).add(x + 0.3).add(0.0F);
    body.add(static_cast<std::int16_t>(y)).add(-2.0F).add(0.0F).end();
  }
  return ply_file(order, declarations, body);
}

void expect_square(const Scene& scene) {
  ASSERT_EQ(scene.triangles.size(), 3U);
  EXPECT_EQ(scene.polygons, 2U);
  EXPECT_EQ(scene.triangles[1].polygon, 0U);
  EXPECT_EQ(corner(scene, 0, 1), glm::dvec3(1.3, 0.0, static_cast<double>(0.1F)));
  EXPECT_EQ(corner(scene, 2, 0), glm::dvec3(1.3, 1.0, static_cast<double>(0.1F)));
  ASSERT_EQ(scene.normals.size(), 4U);
  EXPECT_EQ(scene.normals[2], glm::dvec3(0, 0, -1));
  EXPECT_EQ(scene.materials.size(), 1U);
  EXPECT_TRUE(has_note(scene, "Left out: 1 entries of the element 'camera'."));
  EXPECT_TRUE(has_note(scene, "Left out: 2 properties of the element 'face': red, uv."));
  EXPECT_TRUE(has_note(scene, "Left out: 1 properties of the element 'vertex': alpha."));
}

TEST(Ply, PropertiesOfEachTypeInAnyOrder) {
  const SceneFolder folder;
  for (const PlyOrder order : orders) {
    SCOPED_TRACE(name_of(order));
    expect_square(folder.open("a.ply", decorated<std::uint8_t, std::int8_t>(order, "uchar", "char")));
    expect_square(folder.open("a.ply", decorated<std::int8_t, std::uint8_t>(order, "int8", "uint8")));
    expect_square(folder.open("a.ply", decorated<std::int16_t, std::uint16_t>(order, "short", "ushort")));
    expect_square(folder.open("a.ply", decorated<std::uint16_t, std::int16_t>(order, "uint16", "int16")));
    expect_square(folder.open("a.ply", decorated<std::int32_t, std::uint32_t>(order, "int", "uint")));
    expect_square(folder.open("a.PLY", decorated<std::uint32_t, std::int32_t>(order, "uint32", "int32")));
  }
}

TEST(Ply, TheFileSaysHowMuchOfItIsUsed) {
  const SceneFolder folder;
  FileUse use;
  const auto path =
      folder.write("a.ply", decorated<std::uint8_t, std::int8_t>(PlyOrder::little, "uchar", "char"));
  static_cast<void>(open_scene(path.string(), {}, {}, &use));
  ASSERT_EQ(use.parts.size(), 2U);
  EXPECT_EQ(use.parts[0].all, 3U);
  EXPECT_EQ(use.parts[0].used, 2U);
  EXPECT_EQ(use.parts[1].all, 12U);
  EXPECT_EQ(use.parts[1].used, 7U);
}

const std::string declared =
    "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 2\nproperty list uchar int vertex_indices\n";

PlyBody two_triangles(PlyOrder order, float last) {
  PlyBody body(order);
  for (const float z : {0.0F, 1.0F, last}) {
    body.add(z).add(z * 2.0F).add(1.0F - z * z).end();
  }
  for (int n = 0; n < 2; ++n) {
    body.add(std::uint8_t{3})
        .add(std::int32_t{0})
        .add(std::int32_t{1})
        .add(std::int32_t{n == 0 ? 1 : 2})
        .end();
  }
  return body;
}

TEST(Ply, TrianglesWithoutAPlaceAreLeftOut) {
  const SceneFolder folder;
  for (const PlyOrder order : orders) {
    for (const float bad :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 2e30F}) {
      const Scene scene = folder.open("a.ply", ply_file(order, declared, two_triangles(order, bad)));
      EXPECT_EQ(scene.triangles.size(), 1U);
      EXPECT_TRUE(
          has_note(scene, "Left out: 1 of 2 polygons, because a position is not finite or beyond 1e30."));
      EXPECT_TRUE(has_note(scene, "1 of 1 triangles have no area"));
      EXPECT_EQ(scene.positions[2], glm::dvec3(0.0));
    }
  }
}

TEST(PlyHostile, EveryFaultOfAHeaderIsRefusedWithItsLine) {
  struct Fault {
    const char* text;
    int line;
    const char* reason;
  };
  const std::vector<Fault> faults = {
      {"", 1, "does not begin with the line 'ply'"},
      {"\nply\n", 2, "does not begin with the line 'ply'"},
      {"plyx\n", 1, "does not begin with the line 'ply'"},
      {"ply\n", 1, "ends before the line 'end_header'"},
      {"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n", 4, "ends before the line 'end_header'"},
      {"ply\nend_header\n", 2, "the header says no format"},
      {"ply\nformat ascii\n", 2, "must be 'format NAME 1.0'"},
      {"ply\nformat ascii 2.0\n", 2, "version '2.0' is not supported"},
      {"ply\nformat text 1.0\n", 2, "no format 'text', only ascii, "},
      {"ply\nformat ascii 1.0\nformat ascii 1.0\n", 3, "second time"},
      {"ply\nformat ascii 1.0\nfarmat\n", 3, "'farmat' is no statement of a PLY header"},
      {"ply\nformat ascii 1.0\nproperty float x\n", 3, "before the first element"},
      {"ply\nformat ascii 1.0\nelement vertex\n", 3, "must be 'element NAME COUNT'"},
      {"ply\nformat ascii 1.0\nelement vertex three\n", 3, "'three' is no whole number"},
      {"ply\nformat ascii 1.0\nelement vertex -3\n", 3, "cannot be -3 entries of the element 'vertex'"},
      {"ply\nformat ascii 1.0\nelement vertex 4000000000\n", 3, "cannot be 4000000000 entries"},
      {"ply\nformat ascii 1.0\nelement vertex 9223372036854775807\n", 3,
       "cannot be 9223372036854775807 entries"},
      {"ply\nformat ascii 1.0\nelement vertex 99999999999999999999\n", 3, "no whole number of 64 bits"},
      {"ply\nformat ascii 1.0\nelement a 1\nelement b 1\n", 4, "the element 'a' has no properties"},
      {"ply\nformat ascii 1.0\nelement a 1\nend_header\n", 4, "the element 'a' has no properties"},
      {"ply\nformat ascii 1.0\nelement a 1\nproperty int x\nelement a 1\n", 5,
       "'a' is declared a second time"},
      {"ply\nformat ascii 1.0\nelement a 1\nproperty int x\nproperty int x\n", 5,
       "'x' is declared a second time"},
      {"ply\nformat ascii 1.0\nelement a 1\nproperty half x\n", 4, "'half' is no type of PLY"},
      {"ply\nformat ascii 1.0\nelement a 1\nproperty float\n", 4, "must be 'property TYPE NAME'"},
      {"ply\nformat ascii 1.0\nelement a 1\nproperty list uchar int\n", 4,
       "must be 'property list TYPE TYPE NAME'"},
      {"ply\nformat ascii 1.0\nelement a 1\nproperty list float int x\n", 4,
       "must be of an integer type, not 'float'"},
      {"ply\nformat ascii 1.0\nelement a 1\nproperty list int \x1b[1m x\n", 4, "'\\u001b[1m' is no type"}};
  const SceneFolder folder;
  FileOptions strict;
  strict.strict = true;
  for (const Fault& fault : faults) {
    const std::string message = folder.refusal("a.ply", fault.text, strict);
    EXPECT_EQ(message.rfind("a.ply:" + std::to_string(fault.line) + ": ", 0), 0U) << fault.text << message;
    EXPECT_NE(message.find(fault.reason), std::string::npos) << fault.text << message;
    EXPECT_EQ(sim::shown(message, sim::all_shown), message);
  }
  std::string many = "ply\nformat ascii 1.0\nelement a 1\n";
  for (int i = 0; i < 1000; ++i) {
    many += "property int p" + std::to_string(i) + "\n";
  }
  EXPECT_EQ(folder.refusal("a.ply", many).rfind("a.ply:1002: the header has more than 1000", 0), 0U);
}

TEST(PlyHostile, FilesWithoutWhatASceneNeeds) {
  struct Fault {
    const char* declarations;
    const char* reason;
  };
  const std::vector<Fault> faults = {
      {"element face 0\nproperty list uchar int vertex_indices\n", "it has no element 'vertex'"},
      {"element vertex 0\nproperty float x\n", "it has no element 'face'"},
      {"element vertex 0\nproperty float x\nproperty float y\nelement face 0\nproperty int a\n",
       "its vertices lack one of the properties x, y and z"},
      {"element vertex 0\nproperty float x\nproperty float y\nproperty list uchar float z\nelement face "
       "0\nproperty "
       "int a\n",
       "or it is a list"},
      {"element vertex 0\nproperty float x\nproperty float y\nproperty float z\nelement face 0\nproperty int "
       "vertex_indices\n",
       "no list of integers vertex_indices or vertex_index"},
      {"element vertex 0\nproperty float x\nproperty float y\nproperty float z\nelement face 0\nproperty "
       "list uchar "
       "float vertex_indices\n",
       "no list of integers vertex_indices or vertex_index"},
      {"element vertex 0\nproperty float x\nproperty float y\nproperty float z\nelement face 0\nproperty "
       "list uchar "
       "int vertex_indices\n",
       "the scene has no triangles"}};
  const SceneFolder folder;
  for (const Fault& fault : faults) {
    const std::string message =
        folder.refusal("a.ply", ply_file(PlyOrder::text, fault.declarations, PlyBody(PlyOrder::text)));
    EXPECT_EQ(message.rfind("a.ply: ", 0), 0U) << message;
    EXPECT_NE(message.find(fault.reason), std::string::npos) << message;
  }
}

TEST(PlyHostile, EveryFaultOfATextIsRefusedWithItsLine) {
  struct Fault {
    const char* vertex;  // line 10
    const char* face;    // line 13
    int line;
    const char* reason;
  };
  const std::vector<Fault> faults = {
      {"0 0", "3 0 1 2", 10, "the line ends within entry 0 of the element 'vertex'"},
      {"0 0 0 0", "3 0 1 2", 10, "the line goes on after entry 0 of the element 'vertex', with '0'"},
      {"0 0 a", "3 0 1 2", 10, "'a' is no number"},
      {"0 0 1e39", "3 0 1 2", 10, "'1e39' is beyond the range of a float"},
      {"0 0 1e999", "3 0 1 2", 10, "beyond the range of numbers"},
      {"0 0 0", "3 0 1 3", 13, "refers to vertex 3, but the file has 3, from 0"},
      {"0 0 0", "3 0 1 -1", 13, "refers to vertex -1"},
      {"0 0 0", "3 0 1 2147483648", 13, "2147483648 is beyond the range of its type"},
      {"0 0 0", "3 0 1 1.5", 13, "'1.5' is no whole number"},
      {"0 0 0", "3 0 1", 13,
       "a list of 3 values in entry 0 of the element 'face', for which 2 are left in the line"},
      {"0 0 0", "2 0 1", 13, "a polygon has 3 to 1024 corners, this one 2"},
      {"0 0 0", "0", 13, "this one 0"},
      {"0 0 0", "-1 0", 13, "-1 is beyond the range of its type"},
      {"0 0 0", "256 0", 13, "256 is beyond the range of its type"},
      {"0 0 0", "3 0 1 2 0", 13, "the line goes on after entry 0 of the element 'face'"},
      {"0 0 0", "3 0 1 2\n3 0 1 2\n3 0 1 2", 15, "the file goes on after its last element"},
      {"0 0 0", "3 0 1 2", 13, "the file ends before entry 1 of the element 'face'"}};
  const SceneFolder folder;
  const std::string header = ply_file(PlyOrder::text, declared, PlyBody(PlyOrder::text));
  for (const Fault& fault : faults) {
    const std::string message =
        folder.refusal("a.ply", header + fault.vertex + "\n1 0 0\n0 1 0\n" + fault.face + "\n");
    EXPECT_EQ(message.rfind("a.ply:" + std::to_string(fault.line) + ": ", 0), 0U)
        << fault.face << ": " << message;
    EXPECT_NE(message.find(fault.reason), std::string::npos) << fault.face << ": " << message;
  }
}

TEST(PlyHostile, EveryFaultOfBytesIsRefusedWithItsPlace) {
  const SceneFolder folder;
  for (const PlyOrder order : {PlyOrder::little, PlyOrder::big}) {
    const std::string whole = ply_file(order, declared, two_triangles(order, 2.0F));
    EXPECT_EQ(folder.refusal("a.ply", whole), "no UserError");
    const std::size_t header = ply_file(order, declared, PlyBody(order)).size();
    for (std::size_t length = header; length < whole.size(); ++length) {
      const std::string message = folder.refusal("a.ply", whole.substr(0, length));
      EXPECT_EQ(message.rfind("a.ply: byte ", 0), 0U) << message;
    }
    EXPECT_EQ(folder.refusal("a.ply", whole + "x"),
              "a.ply: byte " + std::to_string(whole.size()) + ": the file goes on after its last element");
    // The first corner of the first face, after its length.
    const std::size_t at = header + 36 + 1;
    std::string wrong = whole;
    wrong[at + (order == PlyOrder::little ? 0 : 3)] = 3;
    EXPECT_EQ(
        folder.refusal("a.ply", wrong),
        "a.ply: byte " + std::to_string(at) + ": a corner refers to vertex 3, but the file has 3, from 0");
    wrong[at + (order == PlyOrder::little ? 3 : 0)] = '\xff';
    EXPECT_NE(folder.refusal("a.ply", wrong).find("a corner refers to vertex -"), std::string::npos);
    wrong = whole;
    wrong[at - 1] = '\xff';
    EXPECT_EQ(
        folder.refusal("a.ply", wrong),
        "a.ply: byte " + std::to_string(at - 1) +
            ": a list of 255 values in entry 0 of the element 'face', for which 6 are left in the file");
  }
}

TEST(PlyHostile, LimitsHold) {
  const SceneFolder folder;
  const std::string whole = ply_file(PlyOrder::little, declared, two_triangles(PlyOrder::little, 2.0F));
  FileOptions few;
  few.max_triangles = 2;
  EXPECT_EQ(folder.refusal("a.ply", whole, few), "a.ply: it has 3 vertices; at most 2 are accepted");
  std::string many =
      "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 5\nproperty list uchar int vertex_indices\n";
  PlyBody body = two_triangles(PlyOrder::text, 2.0F);
  for (int i = 0; i < 3; ++i) {
    body.add(std::uint8_t{3}).add(0).add(1).add(2).end();
  }
  few.max_triangles = 4;
  EXPECT_EQ(folder.refusal("a.ply", ply_file(PlyOrder::text, many, body), few),
            "a.ply:17: the scene has more than 4 triangles, which is more than is accepted");
  FileOptions tight;
  tight.memory = sim::MemoryBudget(whole.size() + 10);
  EXPECT_NE(folder.refusal("a.ply", whole, tight).find("its vertices take"), std::string::npos);
}

}  // namespace
}  // namespace marti::scenes
