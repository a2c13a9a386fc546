// Broken and malicious OBJ files and material libraries: each is refused with file, line and a reason.
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "scenes/obj.h"
#include "sim/shown.h"
#include "text_scene.h"

namespace marti::scenes {
namespace {

using testing::SceneFolder;

// Lines 1 to 6; a fault is added as line 7, and a face follows as line 8.
const std::string good = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\nmtllib a.mtl\n";
const std::string face = "f 1 2 3\n";

struct Fault {
  const char* line;
  const char* reason;
};

FileOptions strict() {
  FileOptions options;
  options.strict = true;
  return options;
}

TEST(ObjHostile, EveryFaultIsRefusedWithFileLineAndReason) {
  const std::vector<Fault> faults = {
      {"v 1 2", "'v' needs 3 numbers"},
      {"v 1 2 3 4 5", "not 5"},
      {"v 1 2 3 4 5 6 7 8", "not 8"},
      {"v 1 2 x", "'x' is no number"},
      {"v 1 2 3x", "'3x' is no number"},
      {"v 1 2 0x10", "'0x10' is no number"},
      {"v 1 2 1,5", "'1,5' is no number"},
      {"v 1 2 +-1", "'+-1' is no number"},
      {"v 1 2 1e999", "beyond the range of numbers"},
      {"vn 1 0", "'vn' needs 3 numbers"},
      {"vn 1 0 0 0", "'vn' needs 3 numbers"},
      {"vt", "'vt' needs 1 to 3 numbers"},
      {"f 1 2", "3 to 1024 corners, this one 2"},
      {"f", "3 to 1024 corners, this one 0"},
      {"f 1 2 0", "position 0, but 3 are given before it"},
      {"f 1 2 4", "position 4, but 3 are given before it"},
      {"f 1 2 -4", "position -4, but 3 are given before it"},
      {"f 1 2 -9223372036854775808", "3 are given before it"},
      {"f 1 2 9223372036854775807", "3 are given before it"},
      {"f 1 2 9223372036854775808", "no whole number of 64 bits"},
      {"f 1 2 3.0", "'3.0' is no whole number"},
      {"f 1 2 3/", "'3/' is no corner"},
      {"f 1 2 /3", "'/3' is no corner"},
      {"f 1/1/1 2/1/1 3/1/", "'3/1/' is no corner"},
      {"f 1/1/1/1 2 3", "'1/1/1/1' is no corner"},
      {"f 1/1 2/1 3", "different parts: '1/1' and '3'"},
      {"f 1//1 2/1/1 3//1", "different parts"},
      {"f 1/2 2/1 3/1", "texture coordinate 2, but 1 are given"},
      {"f 1//2 2//1 3//1", "normal 2, but 1 are given"},
      {"usemtl", "there is no material ''"},
      {"usemtl none", "there is no material 'none'"},
      {"mtllib", "mtllib needs the name"},
      {"mtllib none.mtl", "'none.mtl' cannot be read: there is no such file"},
      {"mtllib a.mtl none.mtl", "'none.mtl' cannot be read"},
      {"mtllib .", "cannot be read"},
      {"vertex 1 2 3", "'vertex' is no statement of an OBJ file"},
      {"V 1 2 3", "'V' is no statement"},
      {"\x1b[31mred", "\\u001b[31mred' is no statement"},
      {"v 1 2 \xff", "'\\xff' is no number"},
      {"call other.obj", "'call' is no statement"},
  };
  const SceneFolder folder;
  folder.write("a.mtl", "newmtl a\n");
  EXPECT_EQ(folder.refusal("a.obj", good + face), "no UserError");
  for (const Fault& fault : faults) {
    const std::string message = folder.refusal("a.obj", good + fault.line + "\n" + face, strict());
    EXPECT_EQ(message.rfind("a.obj:7: ", 0), 0U) << fault.line << ": " << message;
    EXPECT_NE(message.find(fault.reason), std::string::npos) << fault.line << ": " << message;
    EXPECT_EQ(sim::shown(message, sim::all_shown), message);
  }
}

TEST(ObjHostile, EveryFaultOfALibraryIsRefusedWithFileLineAndReason) {
  const std::vector<Fault> faults = {
      {"newmtl", "newmtl needs a name"},
      {"newmtl a", "'a' is defined a second time; the first is at "},
      {"Kd", "'Kd' needs 3 values"},
      {"Kd 1 1", "'Kd' needs 3 values"},
      {"Kd 1 1 1 1", "'Kd' needs 3 values"},
      {"Kd 1 1 2", "'Kd' is 2; it must lie in 0 to 1"},
      {"Kd -1 1 1", "'Kd' is -1"},
      {"Kd nan 1 1", "'Kd' is nan"},
      {"Kd spectral a.rfl", "not with 'spectral'"},
      {"Ks xyz 1 1 1", "not with 'xyz'"},
      {"Ke inf 0 0", "'Ke' is inf"},
      {"Tf 1 1 1.5", "'Tf' is 1.5"},
      {"Ns -1", "'Ns' is -1"},
      {"Ns 1e6", "must lie in 0 to 100000"},
      {"Ni 101", "'Ni' is 101"},
      {"Ni 1 2", "'Ni' needs 1 value"},
      {"d 1.5", "'d' is 1.5"},
      {"d -halo", "'d' needs 1 value"},
      {"Tr", "'Tr' needs 1 value"},
      {"illum 11", "no illumination model 11"},
      {"illum -1", "no illumination model -1"},
      {"illum 2.0", "'2.0' is no whole number"},
      {"map_Kd", "map_Kd needs the name"},
      {"map_Kd -clamp", "map_Kd needs the name"},
      {"map_Kd -o 1", "map_Kd needs the name"},
      {"map_Kd -what a.png", "no option '-what'"},
      {"Kdd 1 1 1", "'Kdd' is no statement of a material library"},
  };
  const SceneFolder folder;
  for (const Fault& fault : faults) {
    folder.write("a.mtl", std::string("# one\nnewmtl a\n") + fault.line + "\n");
    const std::string message = folder.refusal("a.obj", good + "usemtl a\n" + face, strict());
    EXPECT_EQ(message.rfind("a.mtl:3: ", 0), 0U) << fault.line << ": " << message;
    EXPECT_NE(message.find(fault.reason), std::string::npos) << fault.line << ": " << message;
  }
  folder.write("a.mtl", "Kd 1 1 1\n");
  EXPECT_EQ(folder.refusal("a.obj", good + face), "a.mtl:1: 'Kd' before the first newmtl");
}

TEST(ObjHostile, FilesThatAreNoObj) {
  const SceneFolder folder;
  EXPECT_EQ(folder.refusal("a.obj", ""), "a.obj: the scene has no triangles");
  EXPECT_EQ(folder.refusal("a.obj", "v nan 0 0\nf 1 1 1\n"),
            "a.obj: none of its polygons has positions that are finite and not beyond 1e30");
  EXPECT_EQ(folder.refusal("a.obj", std::string(100, '\0')).rfind("a.obj:1: ", 0), 0U);
  EXPECT_EQ(folder.refusal("a.obj", std::string(100'000, '\\')).rfind("a.obj:1: ", 0), 0U);
  std::filesystem::create_directories(folder.path() / "folder.obj");
  const std::string message =
      test::user_error_of([&] { static_cast<void>(open_obj(folder.path() / "folder.obj", {}, {})); });
  EXPECT_EQ(message.rfind((folder.path() / "folder.obj").string(), 0), 0U) << message;
}

TEST(ObjHostile, LimitsHold) {
  const SceneFolder folder;
  FileOptions few;
  few.max_triangles = 3;
  EXPECT_EQ(folder.refusal("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 3\nf 1 2 3\n", few),
            "no UserError");
  EXPECT_EQ(folder.refusal("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 3\nf 1 2 3 1\n", few),
            "a.obj:6: the scene has more than 3 triangles, which is more than is accepted");
  EXPECT_EQ(folder.refusal("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 1 0\n", few),
            "a.obj:4: the scene has more than 3 vertices, which is more than is accepted");
  std::string corners = "f";
  for (int i = 0; i < 1025; ++i) {
    corners += " 1";
  }
  EXPECT_EQ(folder.refusal("a.obj", "v 0 0 0\n" + corners + "\n"),
            "a.obj:2: a polygon has 3 to 1024 corners, this one 1025");

  std::string many = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (int i = 0; i < 20'000; ++i) {
    many += "f 1 2 3\n";
  }
  FileOptions tight;
  tight.memory = sim::MemoryBudget(many.size() + (1U << 20U));
  EXPECT_NE(folder.refusal("a.obj", many, tight).find("its geometry takes"), std::string::npos);
  tight.memory = sim::MemoryBudget(1000);
  EXPECT_NE(folder.refusal("a.obj", many, tight).find("it takes"), std::string::npos);
  std::string materials;
  for (int i = 0; i < 5000; ++i) {
    materials += "newmtl " + std::to_string(i) + "\n";
  }
  folder.write("a.mtl", materials);
  tight.memory = sim::MemoryBudget(2 * materials.size() + (1U << 20U));
  EXPECT_NE(folder.refusal("a.obj", "mtllib a.mtl\n" + good + face, tight).find("its materials take"),
            std::string::npos);
  const std::string blank(std::size_t{1} << 20U, ' ');
  EXPECT_EQ(folder.refusal("a.obj", good + "f" + blank + "1 2 3\n"),
            "a.obj:7: the line is longer than 1 MiB");
  EXPECT_EQ(folder.refusal("a.obj", good + face + "f" + blank.substr(10) + "1 2 \\\n" + blank + "3\n"),
            "a.obj:8: the line is longer than 1 MiB");
  FileOptions small;
  small.max_file_bytes = 1000;
  EXPECT_EQ(folder.refusal("a.obj", many, small).rfind("a.obj", 0), 0U);
}

// The largest polygons that cannot be cut at once do not take long.
TEST(ObjHostile, CutPolygonsAreBounded) {
  const SceneFolder folder;
  std::mt19937 random(3);
  std::string text;
  for (int i = 0; i < 1024; ++i) {
    text += "v " + std::to_string(random() % 1000) + " " + std::to_string(random() % 1000) + " 0\n";
  }
  for (int n = 0; n < 3; ++n) {
    text += "f";
    for (int i = 0; i < 1024; ++i) {
      text += " " + std::to_string(1 + (i * (2 * n + 1)) % 1024);
    }
    text += "\n";
  }
  EXPECT_EQ(folder.open("a.obj", text).triangles.size(), 3U * 1022U);
}

}  // namespace
}  // namespace marti::scenes
