// PLY files of Gaussians: what is read, the proxies that stand about them, and how broken ones are refused.
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>

#include "loaded_scene.h"
#include "ply_text.h"
#include "scenes/procedural.h"
#include "text_scene.h"

namespace marti::scenes {
namespace {

using testing::has_note;
using testing::ply_file;
using testing::PlyBody;
using testing::PlyOrder;
using testing::SceneFolder;

/// A file of Gaussians, each a value for each property; 0 for those that are not given.
class SplatFile {
 public:
  explicit SplatFile(unsigned rest = 0) {
    names_ = {"x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2"};
    for (unsigned i = 0; i < rest; ++i) {
      names_.push_back("f_rest_" + std::to_string(i));
    }
    for (const char* const name :
         {"opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"}) {
      names_.emplace_back(name);
    }
  }
  SplatFile& without(const std::string& name) {
    std::erase(names_, name);
    return *this;
  }
  SplatFile& add(std::map<std::string, float> values) {
    values.try_emplace("rot_0", 1.0F);
    entries_.push_back(std::move(values));
    return *this;
  }
  [[nodiscard]] std::string bytes(PlyOrder order = PlyOrder::little) const {
    std::string declarations = "element vertex " + std::to_string(entries_.size()) + "\n";
    for (const std::string& name : names_) {
      declarations += "property float " + name + "\n";
    }
    PlyBody body(order);
    for (const std::map<std::string, float>& entry : entries_) {
      for (const std::string& name : names_) {
        const auto found = entry.find(name);
        body.add(found == entry.end() ? 0.0F : found->second);
      }
      body.end();
    }
    return ply_file(order, declarations, body);
  }

 private:
  std::vector<std::string> names_;
  std::vector<std::map<std::string, float>> entries_;
};

const std::map<std::string, float> turned = {
    {"x", 1.0F},        {"y", -2.0F},       {"z", 0.5F},      {"opacity", 1.5F}, {"scale_0", -1.0F},
    {"scale_1", -3.0F}, {"scale_2", 0.25F}, {"rot_0", 2.0F},  {"rot_1", 1.0F},   {"rot_2", -0.5F},
    {"rot_3", 0.75F},   {"f_dc_0", 0.3F},   {"f_dc_2", -1.0F}};

// Alpha falls with the distance that the covariance R S S R' gives, and is 1/255 where the inverse gives 1.
TEST(PlyGaussians, AreThoseOfTheirTrainer) {
  const SceneFolder folder;
  for (const PlyOrder order : {PlyOrder::text, PlyOrder::little, PlyOrder::big}) {
    const Scene scene = folder.open("a.ply", SplatFile().add(turned).bytes(order));
    ASSERT_EQ(scene.gaussians->shapes.size(), 1U);
    EXPECT_EQ(scene.gaussians->degree, 0U);
    EXPECT_EQ(scene.gaussians->coefficients, (std::vector<float>{0.3F, 0.0F, -1.0F}));
    const Gaussian& gaussian = scene.gaussians->shapes[0];
    EXPECT_EQ(gaussian.center, glm::dvec3(1.0, -2.0, 0.5));
    EXPECT_NEAR(gaussian.opacity, 1.0 / (1.0 + std::exp(-1.5)), 1e-12);
    const glm::dmat3 rotation = glm::mat3_cast(glm::normalize(glm::dquat(2.0, 1.0, -0.5, 0.75)));
    glm::dmat3 scaled = rotation;
    scaled[0] *= std::exp(-1.0);
    scaled[1] *= std::exp(-3.0);
    scaled[2] *= std::exp(0.25);
    const glm::dmat3 covariance = scaled * glm::transpose(scaled);
    for (const glm::dvec3& way : {glm::dvec3(0.3, 0.1, -0.2), glm::dvec3(0.0, 1.0, 0.0), glm::dvec3(2.0)}) {
      const double distance = glm::dot(way, glm::inverse(covariance) * way);
      const glm::dvec3 y = gaussian.inverse * way;
      EXPECT_NEAR(glm::dot(y, y) * gaussian.falloff * std::log(2.0), 0.5 * distance, 1e-9 * distance);
    }
    EXPECT_NEAR(gaussian.opacity * std::exp2(-gaussian.falloff), 1.0 / 255.0, 1e-12);
    EXPECT_TRUE(scene.framed);
    EXPECT_TRUE(has_note(scene,
                         "1 Gaussians with spherical harmonics of degree 0, each in a proxy of 20 triangles; "
                         "image.integrator = \"gaussians\" shows them."));
  }
}

TEST(PlyGaussians, HarmonicsAreSortedByColour) {
  const SceneFolder folder;
  for (const auto& [rest, degree] : {std::pair(9U, 1U), std::pair(24U, 2U), std::pair(45U, 3U)}) {
    std::map<std::string, float> values;
    for (unsigned i = 0; i < rest; ++i) {
      values["f_rest_" + std::to_string(i)] = static_cast<float>(100 + i);
    }
    for (unsigned i = 0; i < 3; ++i) {
      values["f_dc_" + std::to_string(i)] = static_cast<float>(i);
    }
    const Scene scene = folder.open("a.ply", SplatFile(rest).add(values).add(values).bytes());
    ASSERT_EQ(scene.gaussians->degree, degree);
    for (unsigned channel = 0; channel < 3; ++channel) {
      const auto of = scene.gaussians->of(1, channel);
      ASSERT_EQ(of.size(), rest / 3 + 1);
      EXPECT_EQ(of[0], static_cast<float>(channel));
      EXPECT_EQ(of[1], static_cast<float>(100 + channel * (rest / 3)));
      EXPECT_EQ(of.back(), static_cast<float>(100 + (channel + 1) * (rest / 3) - 1));
    }
  }
}

// Seen from inside, all faces turn the other way and are as far from the centre as they should be; copies are
// where the instances put the mesh.
TEST(PlyGaussians, ProxiesEnclose) {
  const SceneFolder folder;
  const std::string bytes = SplatFile().add({{"x", 3.0F}}).add(turned).bytes();
  const Scene copies = folder.open("a.ply", bytes);
  FileOptions options;
  options.instances = Instances::kept;
  const Scene kept = folder.open("a.ply", bytes, options);
  ASSERT_EQ(copies.triangles.size(), 40U);
  ASSERT_EQ(kept.triangles.size(), 20U);
  ASSERT_EQ(kept.instances.size(), 2U);
  EXPECT_EQ(kept.instances[1].first, 20U);
  EXPECT_TRUE(has_note(kept, "Instances are kept: 2 of 1 mesh stand for 40 triangles."));
  const Scene expanded = copied_instances(kept);
  for (std::size_t t = 0; t < 40; ++t) {
    const Gaussian& gaussian = copies.gaussians->shapes[t / 20];
    std::array<glm::dvec3, 3> y;
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3& corner = copies.positions[copies.triangles[t].vertex[k]];
      EXPECT_EQ(corner, expanded.positions[expanded.triangles[t].vertex[k]]);
      y[k] = gaussian.inverse * (corner - gaussian.center);
    }
    const glm::dvec3 normal = glm::normalize(glm::cross(y[1] - y[0], y[2] - y[0]));
    EXPECT_NEAR(glm::dot(normal, y[0]), proxy_inradius, 1e-12);
    const auto is_normal = [&](const glm::dvec3& n) {
      return std::abs(std::abs(glm::dot(n, normal)) - std::sqrt(3.0)) < 1e-12;
    };
    EXPECT_EQ(std::ranges::count_if(proxy_normals, is_normal), 1);
  }
  options.instances = Instances::automatic;
  EXPECT_TRUE(folder.open("a.ply", bytes, options).instances.empty());
}

TEST(PlyGaussians, WhatNobodySeesIsLeftOut) {
  const SceneFolder folder;
  const Scene scene =
      folder.open("a.ply", SplatFile().add({{"opacity", -5.6F}}).add({}).add({{"opacity", -80.0F}}).bytes());
  EXPECT_EQ(scene.gaussians->shapes.size(), 1U);
  EXPECT_TRUE(has_note(
      scene,
      "Left out: 2 of 3 Gaussians, which are too transparent to be seen (an alpha of at most 1/255)."));
  EXPECT_EQ(folder.refusal("a.ply", SplatFile().add({{"opacity", -80.0F}}).bytes()),
            "a.ply: none of its Gaussians can be seen");
}

TEST(PlyGaussians, BrokenOnesAreRefused) {
  const SceneFolder folder;
  const auto refused = [&](const SplatFile& file, PlyOrder order = PlyOrder::text) {
    return folder.refusal("a.ply", file.bytes(order));
  };
  constexpr float infinity = std::numeric_limits<float>::infinity();
  for (const std::string name : {"x", "opacity", "scale_1", "rot_3", "f_dc_1"}) {
    EXPECT_EQ(refused(SplatFile().without(name).add({})),
              "a.ply: its vertices are Gaussians, and lack the property " + name + ", or it is a list");
  }
  EXPECT_EQ(
      refused(SplatFile(8).add({})),
      "a.ply: its Gaussians have 8 properties f_rest_; spherical harmonics of degree 0 to 3 have 0, 9, 24 "
      "or 45");
  EXPECT_EQ(refused(SplatFile(46).add({})).substr(0, 42), "a.ply: its Gaussians have 46 properties f_");
  EXPECT_EQ(refused(SplatFile().add({}).add({{"rot_0", 0.0F}})),
            "a.ply:23: vertex 1, a Gaussian: its rotation, the quaternion rot_0 to rot_3, has a length below "
            "1e-30 or beyond 1e30");
  EXPECT_EQ(refused(SplatFile().add({{"scale_2", 33.0F}})),
            "a.ply:22: vertex 0, a Gaussian: its scale_2, the logarithm of a size, is not from -32 to 32");
  EXPECT_EQ(refused(SplatFile().add({{"y", 2e30F}})),
            "a.ply:22: vertex 0, a Gaussian: its position is beyond 1e30");
  EXPECT_NE(
      refused(SplatFile().add({{"f_dc_0", infinity}}), PlyOrder::little).find("its f_dc_0 is not finite"),
      std::string::npos);
  EXPECT_NE(refused(SplatFile().add({{"opacity", std::nanf("")}}), PlyOrder::big)
                .find("vertex 0, a Gaussian: its opacity is not finite"),
            std::string::npos);
  std::string shorter = SplatFile().add({}).add({}).bytes(PlyOrder::little);
  shorter.resize(shorter.size() - 3);
  EXPECT_NE(folder.refusal("a.ply", shorter).find("the file ends within entry 1"), std::string::npos);
  FileOptions few;
  few.max_triangles = 30;
  EXPECT_NE(folder.refusal("a.ply", SplatFile().add({}).add({}).bytes(), few)
                .find("the proxies of 2 Gaussians are 40 triangles, and at most 30 are accepted"),
            std::string::npos);
}

TEST(PlyGaussians, StandByThemselves) {
  const SceneFolder folder;
  folder.write("a.ply", SplatFile().add({}).add(turned).bytes());
  folder.write("b.obj", testing::triangle);
  folder.write("c.camera", "0 0 9\n0 0 0\n");
  const auto open = [&](const std::string& list) { return open_scene(list, {folder.path(), {}, {}}, {}); };
  const auto refused = [&](const std::string& list) {
    return test::user_error_of([&] { static_cast<void>(open(list)); });
  };
  const Scene seen = open("[\"c.camera\", \"a.ply\"]");
  EXPECT_EQ(seen.gaussians->shapes.size(), 2U);
  EXPECT_EQ(seen.triangles.size(), 40U);
  EXPECT_EQ(seen.camera.eye, glm::dvec3(0, 0, 9));
  EXPECT_NE(refused("[\"a.ply\", \"b.obj\"]").find("a scene of their own"), std::string::npos);
  EXPECT_NE(refused("[\"b.obj\", \"a.ply\"]").find("a scene of their own"), std::string::npos);
  EXPECT_NE(refused("[{source = \"a.ply\", scale = 2}]").find("cannot be placed"), std::string::npos);
  folder.write("d.pbrt", "WorldBegin\nShape \"plymesh\" \"string filename\" \"a.ply\"\n");
  EXPECT_NE(refused("d.pbrt").find("holds Gaussians, which are no shape"), std::string::npos);
}

TEST(PlyGaussians, RecipeKeepsOrCopies) {
  const Scene copies = make_procedural("gaussians:2");
  const Scene kept = make_procedural("gaussians:2", {}, Instances::kept);
  EXPECT_EQ(copies.gaussians->shapes.size(), 240U);
  EXPECT_EQ(copies.triangles.size(), 4800U);
  EXPECT_EQ(kept.instances.size(), 240U);
  EXPECT_EQ(copies.gaussians->coefficients, kept.gaussians->coefficients);
}

}  // namespace
}  // namespace marti::scenes
