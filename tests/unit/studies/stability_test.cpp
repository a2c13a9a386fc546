// `marti study stability` passes on scenes and machines of every kind; and its oracles can fail.
#include "studies/stability/stability.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "accel/brute_force.h"
#include "scenes/procedural.h"
#include "sim/error.h"
#include "studies/stability/mesh_edges.h"
#include "studies/stability/moved_scene.h"
#include "tests/contract/hostile.h"

namespace marti::studies {

using namespace stability;
using namespace tables;

namespace {

/// The study of a shipped configuration, made small.
StudyOutput study_of(const std::string& file, std::vector<std::string> assignments,
                     const std::vector<StabilityCase>& cases = stability_cases()) {
  assignments.insert(assignments.begin(), {"scene.source=gears:1", "stability.rays=100", "stability.side=6",
                                           "stability.nodes=64", "image.max_depth=2"});
  sim::Config config = sim::Config::from_file(
      stability_schema(), std::filesystem::path(MARTI_SOURCE) / "configs" / file, assignments);
  return run_stability(config, cases);
}

/// The cases that say something about the scene, or about the machine.
std::vector<StabilityCase> cases_of(CaseGroup group) {
  std::vector<StabilityCase> cases = stability_cases();
  std::erase_if(cases, [group](const StabilityCase& one) { return one.group != group; });
  return cases;
}

TEST(StabilityStudy, EveryShippedMachinePasses) {
  for (const char* const file :
       {"marti.toml", "replicated.toml", "distributed.toml", "second-level.toml", "contexts.toml",
        "dram.toml", "today.toml", "dynamic.toml", "pipeline.toml", "space.toml"}) {
    EXPECT_EQ(study_of(file, {}, cases_of(CaseGroup::machine)).fault, "") << file;
  }
}

TEST(StabilityStudy, ScenesOfEveryKindPassInEveryStructure) {
  for (const char* const scene : {"gears:1", "teapot:2", "balls:2", "tetra:2"}) {
    for (const char* const structure : {"octree", "bsp", "grid", "bvh", "none"}) {
      EXPECT_EQ(study_of("marti.toml",
                         {std::string("scene.source=") + scene, std::string("structure.kind=") + structure},
                         cases_of(CaseGroup::scene))
                    .fault,
                "")
          << scene << " in " << structure;
    }
  }
}

TEST(StabilityStudy, WhatTheSubjectDoesNotHaveIsNotMeasured) {
  const StudyOutput output = study_of("naive-pixel.toml", {"stability.only=[\"caches\"]"});
  EXPECT_EQ(output.fault, "");
  EXPECT_EQ(std::get<std::string>(output.tables[0].at(0, "verdict")), "not measured");
  EXPECT_NE(output.report.find("1 case, 0 passed, 0 failed, 1 not measured"), std::string::npos);
}

TEST(StabilityStudy, AFailureIsInTheTableAndAFaultOfTheProgram) {
  const std::vector<StabilityCase> cases = {
      {"good", CaseGroup::scene, "nothing", "anything", [](const Subject&) { return CaseOutcome{"x"}; }},
      {"bad", CaseGroup::machine, "all", "nothing",
       [](const Subject&) {
         return CaseOutcome{"y", 2.0};
       }},
      {"ends", CaseGroup::machine, "it ends", "it does not",
       [](const Subject&) -> CaseOutcome { throw std::runtime_error("no such luck"); }}};
  const StudyOutput output = study_of("marti.toml", {}, cases);
  EXPECT_EQ(output.fault, "2 of 3 cases failed: bad, ends");
  const Table& table = output.tables[0];
  EXPECT_EQ(std::get<std::string>(table.at(0, "verdict")), "pass");
  EXPECT_EQ(std::get<std::string>(table.at(1, "verdict")), "FAIL");
  EXPECT_EQ(std::get<std::string>(table.at(1, "group")), "machine");
  EXPECT_EQ(std::get<std::string>(table.at(2, "figure")), "ended by: no such luck");
  EXPECT_NE(output.report.find("3 cases, 1 passed, 2 failed: bad, ends"), std::string::npos);
}

TEST(StabilityStudy, CasesHaveNamesOfTheirOwn) {
  std::set<std::string> ids;
  for (const StabilityCase& one : stability_cases()) {
    EXPECT_TRUE(ids.insert(one.id).second) << one.id;
  }
}

TEST(StabilityOracles, AnOutcomePassesOnlyWithoutAnObjection) {
  EXPECT_FALSE((CaseOutcome{"", 1e-300}.passed()));
  EXPECT_FALSE((CaseOutcome{"", std::numeric_limits<double>::quiet_NaN()}.passed()));
  EXPECT_FALSE(none_wrong({}, "rays").passed()) << "nothing was tried";
  EXPECT_FALSE(none_wrong({1, 1000}, "rays").passed());
  EXPECT_EQ(none_wrong({1, 1234567}, "rays lost").figure, "1 of 1,234,567 rays lost");
}

/// Brute force with something changed in its hits.
template <class Change>
class Broken final : public accel::Structure {
 public:
  Broken(std::shared_ptr<const accel::TriangleSet> triangles, Change change)
      : brute_(std::move(triangles)), change_(change) {}
  [[nodiscard]] std::string_view kind() const override { return "broken"; }
  [[nodiscard]] const accel::TriangleSet& triangles() const override { return brute_.triangles(); }
  [[nodiscard]] const accel::Topology& topology() const override { return brute_.topology(); }
  [[nodiscard]] const scenes::Bounds& bounds() const override { return brute_.bounds(); }
  [[nodiscard]] accel::Hit closest(const accel::Ray& ray) const override {
    accel::NullVisitor visitor;
    return change_(brute_.closest(ray, visitor));
  }
  [[nodiscard]] bool occluded(const accel::Ray& ray) const override {
    accel::NullVisitor visitor;
    return brute_.occluded(ray, visitor);
  }

 private:
  accel::BruteForce brute_;
  Change change_;
};

template <class Change>
std::uint64_t wrong_with(Change change) {
  const auto triangles = std::make_shared<const accel::TriangleSet>(tests::hostile_soup(0.0, 21));
  RayMaker maker(*triangles, triangles->bounds(), 22);
  std::vector<accel::Ray> rays;
  for (int k = 0; k < 500; ++k) {
    rays.push_back(maker.make(Aim::vertex));
  }
  return differences(Broken<Change>(triangles, change), rays).wrong;
}

TEST(StabilityOracles, AStructureThatIsNotBruteForceIsFound) {
  EXPECT_EQ(wrong_with([](accel::Hit hit) { return hit; }), 0U);
  EXPECT_GT(wrong_with([](accel::Hit hit) {
              hit.t = hit.found() ? std::nextafter(hit.t, 0.0) : hit.t;
              return hit;
            }),
            100U);
  EXPECT_GT(wrong_with([](accel::Hit hit) {
              hit.primitive += hit.found() && hit.primitive % 16 == 0 ? 1U : 0U;
              return hit;
            }),
            0U);
  EXPECT_GT(wrong_with([](accel::Hit hit) { return hit.t > 1.0 ? accel::Hit{} : hit; }), 0U);
}

// Where triangles are made a little smaller, rays at their common edges pass between them.
TEST(StabilityOracles, CracksAreFound) {
  const accel::TriangleSet whole(scenes::make_procedural("teapot:4"));
  std::vector<accel::TriangleCorners> apart;
  for (std::uint32_t id = 0; id < whole.triangles(); ++id) {
    const glm::dvec3 middle = (whole.corner(id, 0) + whole.corner(id, 1) + whole.corner(id, 2)) / 3.0;
    const auto moved = [&](unsigned k) {
      return whole.corner(id, k) + 0x1p-40 * (middle - whole.corner(id, k));
    };
    apart.push_back(tests::corners(moved(0), moved(1), moved(2)));
  }
  const auto set = std::make_shared<const accel::TriangleSet>(std::move(apart));
  const auto lost = [&](const accel::TriangleSet& seen, const std::vector<accel::Ray>& rays) {
    const accel::BruteForce those(std::make_shared<const accel::TriangleSet>(seen));
    return tally_of(rays, [&](const accel::Ray& ray) {
      accel::NullVisitor visitor;
      return those.closest(ray, visitor).found();
    });
  };
  const std::vector<accel::Ray> rays = MeshEdges(whole).rays_at_edges(500, 0x1p-53, 1);
  ASSERT_EQ(rays.size(), 500U);
  EXPECT_EQ(lost(whole, rays).wrong, 0U);
  EXPECT_GT(lost(*set, rays).wrong, 400U);
}

TEST(StabilityOracles, OneTickTooManyIsFound) {
  processors::replay::MachineResult base;
  base.end = 7;
  base.events = 3;
  base.nodes.resize(2);
  base.clusters.resize(1);
  const auto other = [&](const auto& change) {
    processors::replay::MachineResult result = base;
    change(result);
    return is_stretched(base, result, 1, true);
  };
  EXPECT_TRUE(other([](auto&) {}));
  EXPECT_FALSE(is_stretched(base, base, 2, true));
  EXPECT_FALSE(other([](auto& result) { result.nodes[1].time[0] += 1; }));
  EXPECT_FALSE(other([](auto& result) { result.events += 1; }));
  EXPECT_FALSE(other([](auto& result) { result.nodes[1].references.hits[0] += 1; }));
  EXPECT_FALSE(other([](auto& result) { result.clusters[0].interconnect.busy += 1; }));
}

TEST(StabilityStudy, FloatsLoseASceneFarAwayAndDoublesDoNot) {
  const Table table = study_of("marti.toml", {"scene.source=teapot:4"}, {}).tables[1];
  ASSERT_EQ(table.rows().size(), places.size());
  for (std::size_t row = 0; row < places.size(); ++row) {
    EXPECT_EQ(std::get<std::string>(table.at(row, "advice")), row == 0 ? "floats would do" : "doubles");
  }
  EXPECT_GT(std::get<double>(table.at(0, "float_agrees")), 0.98);
  EXPECT_LT(std::get<double>(table.at(3, "float_agrees")), 0.9);
  EXPECT_GT(std::get<double>(table.at(3, "double_agrees")), 0.98);
}

}  // namespace
}  // namespace marti::studies
