// Every case of `marti study stability` by itself, at a small size; and that its oracles can fail.
#include "studies/stability/stability.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <ostream>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "sim/error.h"
#include "studies/stability/geometry_oracles.h"
#include "studies/stability/machines.h"
#include "studies/stability/precision_table.h"
#include "studies/stability/stability_keys.h"
#include "tests/support/long_tests.h"

namespace marti::studies::stability {

void PrintTo(const StabilityCase& one, std::ostream* out) { *out << one.id << ": " << one.risk; }

}  // namespace marti::studies::stability

namespace marti::studies {

using namespace stability;
using namespace tables;

namespace {

/// The size at which the tests run a case; in a long run at least that of the study. Leaks are rare, so what
/// looks for them takes more rays: with the five structures of each case more than a million.
CaseSize test_size(const std::string& id) {
  const CaseSize full;
  const std::size_t rays =
      id.starts_with("leaks") ? test::stride(40'000, 210'000) : test::stride(full.rays / 50, full.rays);
  return {static_cast<std::uint32_t>(rays), static_cast<std::uint32_t>(test::stride(256, full.nodes))};
}

class Stability : public ::testing::TestWithParam<StabilityCase> {};

TEST_P(Stability, Holds) {
  const CaseOutcome outcome = run_case(GetParam(), test_size(GetParam().id));
  EXPECT_TRUE(outcome.passed()) << outcome.figure << "\noracle: " << GetParam().oracle;
  EXPECT_FALSE(outcome.figure.empty());
}

INSTANTIATE_TEST_SUITE_P(Cases, Stability, ::testing::ValuesIn(stability_cases()), [](const auto& tested) {
  std::string name = tested.param.id;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == '-' || c == '.'; }, '_');
  return name;
});

TEST(StabilityCases, HaveNamesOfTheirOwnAndSayWhatTheyAreAbout) {
  std::set<std::string> ids;
  for (const StabilityCase& one : stability_cases()) {
    EXPECT_TRUE(ids.insert(one.id).second) << one.id;
    EXPECT_FALSE(one.risk.empty()) << one.id;
    EXPECT_FALSE(one.oracle.empty()) << one.id;
  }
  EXPECT_GE(ids.size(), 57U);
}

// Moeller and Trumbore's test in floats, which is known to leak.
bool moller_trumbore(const accel::Ray& ray, const accel::TriangleCorners& t) {
  using Vec = std::array<float, 3>;
  const auto at = [](double x) { return static_cast<float>(x); };
  const auto minus = [](const Vec& a, const Vec& b) { return Vec{a[0] - b[0], a[1] - b[1], a[2] - b[2]}; };
  const auto cross = [](const Vec& a, const Vec& b) {
    return Vec{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  };
  const auto dot = [](const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
  const Vec o{at(ray.origin.x), at(ray.origin.y), at(ray.origin.z)};
  const Vec d{at(ray.direction.x), at(ray.direction.y), at(ray.direction.z)};
  const Vec a{at(t[0]), at(t[1]), at(t[2])};
  const Vec ab = minus({at(t[3]), at(t[4]), at(t[5])}, a);
  const Vec ac = minus({at(t[6]), at(t[7]), at(t[8])}, a);
  const Vec p = cross(d, ac);
  const float det = dot(ab, p);
  if (det == 0.0F) {
    return false;
  }
  const Vec s = minus(o, a);
  const float u = dot(s, p) / det;
  const Vec q = cross(s, ab);
  const float v = dot(d, q) / det;
  return u >= 0.0F && v >= 0.0F && u + v <= 1.0F && dot(ac, q) / det > 0.0F;
}

TEST(StabilityOracles, LeaksOfAnotherKernelAreFound) {
  const PlacedSphere mesh(2, 0.0, 1.0);
  const Tally tally = leaks(
      mesh,
      [&](const accel::Ray& ray) {
        accel::Hit hit;
        for (std::uint32_t id = 0; id < mesh.triangles.size(); ++id) {
          if (moller_trumbore(ray, mesh.triangles[id])) {
            hit.primitive = id;
          }
        }
        return hit;
      },
      3000, 41);
  EXPECT_EQ(tally.of, 3000U);
  EXPECT_GT(tally.wrong, 0U);
  EXPECT_LT(tally.wrong, 1000U);
  EXPECT_FALSE(none_wrong(tally, "rays").passed());
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
Tally compare_with_broken(Change change) {
  const auto triangles = std::make_shared<const accel::TriangleSet>(hostile_soup(0.0, 21));
  const accel::BruteForce brute(triangles);
  std::vector<std::unique_ptr<accel::Structure>> structures;
  structures.push_back(std::make_unique<Broken<Change>>(triangles, change));
  return disagreements(*triangles, tracer_of(brute), structures, brute.bounds(), Aim::vertex, 500, 22);
}

TEST(StabilityOracles, AStructureThatIsNotBruteForceIsFound) {
  const auto unchanged = [](accel::Hit hit) { return hit; };
  EXPECT_EQ(compare_with_broken(unchanged).wrong, 0U);
  const auto one_bit = [](accel::Hit hit) {
    hit.t = hit.found() ? std::nextafter(hit.t, 0.0) : hit.t;
    return hit;
  };
  EXPECT_GT(compare_with_broken(one_bit).wrong, 100U);
  const auto another_id = [](accel::Hit hit) {
    hit.primitive += hit.found() && hit.primitive % 16 == 0 ? 1U : 0U;
    return hit;
  };
  EXPECT_GT(compare_with_broken(another_id).wrong, 0U);
  const auto lost = [](accel::Hit hit) { return hit.t > 1.0 ? accel::Hit{} : hit; };
  EXPECT_GT(compare_with_broken(lost).wrong, 0U);
}

TEST(StabilityOracles, OneTickTooManyIsFound) {
  const processors::machine::MachineConfig machine = machines_of_every_kind().front().machine;
  const processors::replay::MachineResult base = processors::replay::replay(small_log(), machine);
  EXPECT_TRUE(is_stretched(base, base, 1));
  EXPECT_FALSE(is_stretched(base, base, 2));
  processors::replay::MachineResult other = base;
  other.nodes[3].time[0] += 1;
  EXPECT_FALSE(is_stretched(base, other, 1));
  other = base;
  other.events += 1;
  EXPECT_FALSE(is_stretched(base, other, 1));
  other = base;
  other.nodes[2].references.hits[0] += 1;
  EXPECT_FALSE(is_stretched(base, other, 1));
  EXPECT_FALSE(same_references(base, other));
}

TEST(StabilityOracles, AnOutcomePassesOnlyWhenItIsAtMostItsLimit) {
  EXPECT_TRUE((CaseOutcome{"", 0.0, 0.0}.passed()));
  EXPECT_FALSE((CaseOutcome{"", 1e-300, 0.0}.passed()));
  EXPECT_FALSE((CaseOutcome{"", std::numeric_limits<double>::quiet_NaN(), 1.0}.passed()));
  EXPECT_FALSE(none_wrong({}, "rays").passed()) << "nothing was tried";
  EXPECT_FALSE(none_wrong({1, 1000}, "rays").passed());
  EXPECT_EQ(none_wrong({1, 1234567}, "rays lost").figure, "1 of 1,234,567 rays lost");
  EXPECT_FALSE(error_within(2e-3, 1e-3, "error").passed());
  const auto user = [] { throw sim::UserError("the key is wrong"); };
  EXPECT_TRUE(refuses(user, "key").passed());
  EXPECT_FALSE(refuses(user, "value").passed());
  EXPECT_FALSE(refuses([] {}, "key").passed());
}

TEST(StabilityOracles, WhatACaseThrowsIsItsFailure) {
  const StabilityCase broken{
      "broken", CaseGroup::machine, "it ends", "it does not",
      [](const CaseSize&) -> CaseOutcome { throw std::runtime_error("no such luck"); }};
  const CaseOutcome outcome = run_case(broken, test_size(broken.id));
  EXPECT_FALSE(outcome.passed());
  EXPECT_NE(outcome.figure.find("no such luck"), std::string::npos);
}

TEST(StabilityStudy, AFailureIsInTheTableAndAFaultOfTheProgram) {
  const std::vector<StabilityCase> cases = {
      {"good", CaseGroup::geometry, "nothing", "anything",
       [](const CaseSize&) {
         return CaseOutcome{"x", 0.0, 0.0};
       }},
      {"bad", CaseGroup::machine, "all", "nothing", [](const CaseSize&) {
         return CaseOutcome{"y", 2.0, 1.0};
       }}};
  const std::vector<std::string> few = {"stability.rays=100"};
  sim::Config config = sim::Config::from_text(stability_schema(), "", "test", few);
  const StudyOutput output = run_stability(config, cases);
  EXPECT_EQ(output.fault, "1 of 2 cases failed: bad");
  ASSERT_EQ(output.tables.size(), 3U);
  const Table& table = output.tables[0];
  ASSERT_EQ(table.rows().size(), 2U);
  EXPECT_EQ(std::get<std::string>(table.at(0, "verdict")), "pass");
  EXPECT_EQ(std::get<std::string>(table.at(1, "verdict")), "FAIL");
  EXPECT_EQ(std::get<std::string>(table.at(1, "group")), "machine");
  EXPECT_NE(output.report.find("2 cases, 1 passed, 1 failed: bad"), std::string::npos);
  EXPECT_EQ(run_stability(config, std::vector(cases.begin(), cases.begin() + 1)).fault, "");
}

TEST(PrecisionTable, FloatsLoseTheTeapotFarAwayAndDoublesDoNot) {
  const std::vector<PrecisionRow> rows = compare_precisions(400);
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_GT(rows[0].hits, 200U);
  for (const PrecisionRow& row : rows) {
    EXPECT_EQ(row.double_agree, row.rays);
    EXPECT_EQ(row.rays, 400U);
  }
  EXPECT_GT(rows[0].float_agree, 390U);
  EXPECT_LT(rows[3].float_agree, 250U);
  EXPECT_FALSE(rows[0].need.wants_double());
  EXPECT_TRUE(rows[2].need.wants_double());
  EXPECT_TRUE(rows[3].need.wants_double());
  EXPECT_EQ(rows[3].need.collapsed, rows[3].need.primitives) << "6 units across where floats are 64 apart";
}

}  // namespace
}  // namespace marti::studies
