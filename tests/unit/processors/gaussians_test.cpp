// Gaussians along rays: against all of them sorted, against closed forms, and on machines of every kind.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "gaussian_scene.h"
#include "processors/cost/operation_mix.h"
#include "processors/program/gaussian_color.h"
#include "processors/program/log_rules.h"
#include "processors/replay/replay.h"
#include "tests/support/first_difference.h"
#include "tests/support/naive_simt.h"
#include "tests/support/random_simt.h"
#include "tests/support/user_error.h"

namespace marti::processors {

using namespace program;

namespace {

using test::Built;
using test::random_gaussians;

constexpr auto kept = scenes::Instances::kept;
constexpr auto copied = scenes::Instances::copied;

RenderOptions looking_through(std::uint32_t k, std::uint32_t side = 24) {
  RenderOptions options{.width = side, .height = side, .integrator = Integrator::gaussians};
  options.nearest_hits = k;
  options.record = true;
  return options;
}

accel::Ray camera_ray_at(const scenes::Scene& scene, const RenderOptions& options, std::uint32_t x,
                         std::uint32_t y) {
  const scenes::ImagePlane plane = image_plane(scene.camera, options);
  const auto direction = normalized(Vec3<double>(plane.corner) + Vec3<double>(plane.step_x) * (x + 0.5) +
                                    Vec3<double>(plane.step_y) * (y + 0.5));
  return {plane.origin, {direction.x, direction.y, direction.z}};
}

/// Gaussians that begin nearer to the eye are not met.
double least_entry(const scenes::Scene& scene) {
  const glm::dvec3 extent = scenes::bounds_of(scene).hi - scenes::bounds_of(scene).lo;
  return accel::NearestGaussians(*scene.gaussians, 1, std::max({extent.x, extent.y, extent.z})).least_entry();
}

/// The colour of a ray when all Gaussians are looked at, sorted and composed.
glm::vec3 composed_of_all(const scenes::Scene& scene, const accel::Ray& ray, double least) {
  const scenes::Gaussians& all = *scene.gaussians;
  std::vector<accel::GaussianHit> met;
  for (std::uint32_t g = 0; g < all.shapes.size(); ++g) {
    const accel::GaussianHit hit{accel::proxy_entry(all.shapes[g], ray), g,
                                 accel::least_squared<double>(all.shapes[g], ray)};
    if (hit.squared <= 1.0 && hit.entry >= least) {
      met.push_back(hit);
    }
  }
  std::ranges::sort(met, [](const auto& a, const auto& b) {
    return std::pair(a.entry, a.gaussian) < std::pair(b.entry, b.gaussian);
  });
  Collected<double> light;
  for (const accel::GaussianHit& hit : met) {
    if (light.through < least_through) {
      break;
    }
    collect(all, hit, Vec3<double>(ray.direction), light);
  }
  const auto pixel = [&](double seen, double background) {
    return static_cast<float>(linear_of_screen(seen) + background * light.through);
  };
  return {pixel(light.color.x, scene.background.x), pixel(light.color.y, scene.background.y),
          pixel(light.color.z, scene.background.z)};
}

// Whatever the structure, whether proxies are kept, and however many Gaussians a round finds: the image is
// that of all of them sorted.
RC_GTEST_PROP(GaussiansOfRays, ImageIsThatOfAllOfThemSorted, ()) {
  const auto seed = *rc::gen::arbitrary<std::uint64_t>();
  const auto count = *rc::gen::inRange(1U, 70U);
  const auto degree = *rc::gen::inRange(0U, 4U);
  const scenes::Scene copies = random_gaussians(seed, count, degree, copied);
  const scenes::Scene instances = random_gaussians(seed, count, degree, kept);
  const double least = least_entry(copies);
  std::optional<std::uint64_t> hash;
  for (const std::string_view kind : {"kept", "bvh", "octree", "bsp", "grid", "none"}) {
    const Built built(kind == "kept" ? instances : copies, kind == "kept" ? "bvh" : kind);
    for (const std::uint32_t k : {1U, 2U, 16U, 64U}) {
      RenderOptions options = looking_through(k, 7);
      options.mailboxes = kind == "octree" && k == 2;
      const Frame frame = built.render(options);
      RC_ASSERT(fault_of(*frame.log).empty());
      RC_ASSERT(fault_of_order(*frame.log).empty());
      RC_ASSERT(hash.value_or(frame.hit_hash) == frame.hit_hash);
      hash = frame.hit_hash;
      for (std::uint32_t y = 0; y < options.height; ++y) {
        for (std::uint32_t x = 0; x < options.width; ++x) {
          RC_ASSERT(frame.image.at(x, y) ==
                    composed_of_all(copies, camera_ray_at(copies, options, x, y), least));
        }
      }
    }
  }
}

/// By the determinants of Möller and Trumbore: whether the ray enters the front of the triangle.
bool enters_front(const scenes::Scene& scene, const scenes::Triangle& triangle, const accel::Ray& ray) {
  const glm::dvec3 a = scene.positions[triangle.vertex[0]];
  const glm::dvec3 ab = scene.positions[triangle.vertex[1]] - a;
  const glm::dvec3 ac = scene.positions[triangle.vertex[2]] - a;
  const glm::dvec3 normal = glm::cross(ab, ac);
  const double det = -glm::dot(ray.direction, normal);
  const glm::dvec3 from = ray.origin - a;
  const glm::dvec3 across = glm::cross(from, ray.direction);
  const double u = glm::dot(ac, across);
  const double v = -glm::dot(ab, across);
  return det > 0.0 && u >= 0.0 && v >= 0.0 && u + v <= det && glm::dot(from, normal) >= 0.0;
}

// With room for all, each front face on the way is asked about once, and those that are met are composed.
TEST(GaussiansOfRays, EachFrontFaceIsAskedAboutOnce) {
  scenes::Scene scene = random_gaussians(7, 150, 3, copied);
  for (const std::string_view kind : {"bvh", "none"}) {
    const RenderOptions options = looking_through(max_nearest_hits);
    const Frame frame = Built(scene, kind).render(options);
    std::uint64_t asked = 0;
    for (std::uint32_t y = 0; y < options.height; ++y) {
      for (std::uint32_t x = 0; x < options.width; ++x) {
        const accel::Ray ray = camera_ray_at(scene, options, x, y);
        asked += static_cast<std::uint64_t>(std::ranges::count_if(
            scene.triangles, [&](const scenes::Triangle& t) { return enters_front(scene, t, ray); }));
      }
    }
    const LogTotals totals = totals_of(*frame.log);
    EXPECT_EQ(totals.any_hits, asked);
    EXPECT_GT(asked, 1000U);
    EXPECT_EQ(totals.rays[0], 24U * 24U);
    EXPECT_EQ(totals.all_rays(), totals.rays[0]);
    EXPECT_EQ(totals.shades % 3, 0U) << "three records of each";
    EXPECT_EQ(frame.log->materials, 150U * 4);
    // With less room a ray asks about more, in more rounds, and composes the same.
    const LogTotals rounds = totals_of(*Built(scene, kind).render(looking_through(4)).log);
    EXPECT_GT(rounds.rays[static_cast<std::size_t>(RayKind::refraction)], 100U);
    EXPECT_EQ(rounds.shades, totals.shades);
  }
}

// What is computed of a ray and a Gaussian, from its covariance and from its proxy's triangles.
RC_GTEST_PROP(GaussiansOfRays, MeetingsAreThoseOfCovarianceAndProxy, ()) {
  const auto seed = *rc::gen::arbitrary<std::uint64_t>();
  const scenes::Scene scene = random_gaussians(seed, 1, 0, copied);
  const scenes::Gaussian& gaussian = scene.gaussians->shapes[0];
  const Built built(scene);
  std::mt19937_64 random(seed);
  const auto draw = [&] { return static_cast<double>(random() >> 11U) * 0x1p-52 - 1.0; };
  for (int i = 0; i < 50; ++i) {
    accel::Ray ray{5.0 * glm::dvec3(draw(), draw(), draw()), {}};
    const glm::dvec3 target = gaussian.center + 0.3 * glm::dvec3(draw(), draw(), draw());
    ray.direction = glm::normalize(target - ray.origin);
    // Along the line |inverse (o + t d - c)|^2 is a parabola, least where its derivative is zero.
    const auto squared_at = [&](double t) {
      const glm::dvec3 y = gaussian.inverse * (ray.origin + t * ray.direction - gaussian.center);
      return glm::dot(y, y);
    };
    const double f0 = squared_at(0.0);
    const double f1 = squared_at(1.0);
    const double f2 = squared_at(-1.0);
    const double curve = 0.5 * (f1 + f2) - f0;
    const double least = squared_at(-0.25 * (f1 - f2) / curve);
    const double squared = accel::least_squared<double>(gaussian, ray);
    RC_ASSERT(std::abs(squared - least) <= 1e-6 * (1.0 + least));
    const accel::Hit hit = built.structure->closest(ray);
    const double entry = accel::proxy_entry(gaussian, ray);
    RC_ASSERT(squared > 1.0 || entry < 0.0 || hit.found());
    if (squared <= 1.0 && entry >= 0.0) {
      RC_ASSERT(std::abs(hit.t - entry) <= 1e-9 * (1.0 + entry));
      RC_ASSERT(enters_front(scene, scene.triangles[hit.primitive], ray));
    }
  }
}

scenes::Scene in_a_row(const std::vector<double>& opacities) {
  scenes::Scene scene = test::looking_down(10.0);
  scenes::Gaussians all;
  for (std::size_t i = 0; i < opacities.size(); ++i) {
    scenes::Splat splat;
    splat.center.z = -static_cast<double>(i);
    splat.deviation = glm::dvec3(0.1);
    splat.opacity = opacities[i];
    all.add(scenes::gaussian_of(splat).value());
    for (unsigned channel = 0; channel < 3; ++channel) {  // red, green, blue, and so on
      all.coefficients.push_back(i % 3 == channel ? 1.7724539F : -1.7724539F);
    }
  }
  scene.gaussians = std::make_shared<const scenes::Gaussians>(std::move(all));
  scenes::stand_proxies(scene, copied, 1'000'000);
  return scene;
}

// Through their centres the alphas are the opacities, 0.99 at most.
TEST(GaussiansOfRays, ColoursOfARowAreClosedForms) {
  RenderOptions options = looking_through(2, 1);
  const auto seen = [&](const std::vector<double>& opacities) {
    scenes::Scene scene = in_a_row(opacities);
    scene.background = {0.0, 0.0, 1.0};
    return Built(scene, "bvh").render(options).image.at(0, 0);
  };
  const auto linear = [](double screen) { return std::pow((screen + 0.055) / 1.055, 2.4); };
  const glm::vec3 one = seen({0.6});
  EXPECT_NEAR(one.x, linear(0.6), 1e-6);
  EXPECT_NEAR(one.y, 0.0, 1e-6);
  EXPECT_NEAR(one.z, 0.4, 1e-6);
  const glm::vec3 two = seen({0.6, 0.5});
  EXPECT_NEAR(two.x, linear(0.6), 1e-6);
  EXPECT_NEAR(two.y, linear(0.4 * 0.5), 1e-6);
  EXPECT_NEAR(two.z, 0.2, 1e-6);
  const glm::vec3 opaque = seen({1.0, 1.0, 0.5});
  EXPECT_NEAR(opaque.x, linear(0.99), 1e-6);
  EXPECT_NEAR(opaque.y, 0.0099 / 12.92, 1e-6);
  EXPECT_NEAR(opaque.z, 0.0001, 1e-6) << "the third is behind too little light";
}

// One that the eye is in is not met, and one behind it neither.
TEST(GaussiansOfRays, TheEyeSeesWhatBeginsBeforeIt) {
  scenes::Scene scene = in_a_row({0.6, 0.5});
  scene.camera.eye = {0.0, 0.0, 0.01};
  scene.camera.at = {0.0, 0.0, -1.0};
  const glm::vec3 seen = Built(scene, "bvh").render(looking_through(16, 1)).image.at(0, 0);
  EXPECT_EQ(seen.x, 0.0F);
  EXPECT_GT(seen.y, 0.1F);
}

// The table of prices holds what the templates count.
TEST(GaussiansOfRays, PricesAreMeasured) {
  const auto measured = cost::measure_gaussians();
  const cost::OperationMixes& table = cost::operation_mixes(accel::Traversal::bvh_eight);
  EXPECT_EQ(measured[0], table.meet);
  EXPECT_EQ(measured[1], table.collect);
}

TEST(GaussiansOfRays, MachinesOfEveryKindReplayThem) {
  for (const scenes::Instances instances : {kept, copied}) {
    RenderOptions options = looking_through(3, 20);
    options.entered = true;
    const Frame frame = Built(random_gaussians(3, 80, 2, instances), "bvh").render(options);
    const LogTotals totals = totals_of(*frame.log);
    EXPECT_GT(totals.any_hits, totals.shades / 2);
    EXPECT_EQ(totals.transforms > 0, instances == kept);
    for (const machine::Scheme scheme :
         {machine::Scheme::image, machine::Scheme::pipeline, machine::Scheme::space}) {
      for (const auto kind : {machine::NodeKind::core, machine::NodeKind::simt}) {
        if (scheme != machine::Scheme::image &&
            (kind == machine::NodeKind::simt || (instances == kept && scheme == machine::Scheme::space))) {
          continue;
        }
        machine::MachineConfig config;
        config.nodes = scheme == machine::Scheme::pipeline ? 16 : 4;
        config.kind = kind;
        config.scheme = scheme;
        config.layout.node_bytes = 256;
        config.cache.cache.line = 64;
        config.layout.record_alignment = 64;
        config.layout.section_alignment = 64;
        const replay::MachineResult result = replay::replay(*frame.log, config);  // checks the laws
        EXPECT_EQ(static_cast<std::uint64_t>(result.steps().any_hits), totals.any_hits);
        EXPECT_EQ(static_cast<std::uint64_t>(result.steps().shades), totals.shades);
        if (kind == machine::NodeKind::core) {
          const auto material = static_cast<std::size_t>(memory::RecordKind::material);
          const cost::ReferenceCounts references = result.references();
          EXPECT_EQ(static_cast<std::uint64_t>(references.hits[material] + references.misses[material]),
                    totals.any_hits + totals.shades);
        }
      }
    }
  }
}

// A lane asks in shader code about each candidate, reads its record there, and goes on.
TEST(GaussiansOfRays, SimtNodesAreThoseOfTheirSecondImplementation) {
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    RenderOptions options = looking_through(static_cast<std::uint32_t>(1 + seed % 5), 10);
    options.entered = options.ray_words = true;
    const Frame frame =
        Built(random_gaussians(seed, 30, seed % 4, seed % 3 == 0 ? copied : kept), "bvh").render(options);
    marti::test::Random random(seed);
    const machine::MachineConfig machine = marti::test::random_simt(random, *frame.log);
    ASSERT_EQ(marti::test::FirstDifference::between(replay::replay(*frame.log, machine),
                                                    marti::test::naive_simt(*frame.log, machine)),
              "")
        << "seed " << seed << ": " << marti::test::describe_simt(machine);
  }
}

TEST(GaussiansOfRays, WhatCannotDealWithThemRefuses) {
  const auto refusal = [](const Built& built, RenderOptions options) {
    return marti::test::user_error_of([&] { (void)built.render(options); });
  };
  const Built gaussians(random_gaussians(1, 5, 0, copied), "bvh");
  RenderOptions options = looking_through(4);
  options.meets = true;
  EXPECT_NE(refusal(gaussians, options).find("rt.share"), std::string::npos);
  options = looking_through(0);
  EXPECT_NE(refusal(gaussians, options).find("nearest_hits is 0"), std::string::npos);
  options = looking_through(4);
  options.voxel_cut = 1.0;
  EXPECT_NE(refusal(gaussians, options).find("image.voxel_cut"), std::string::npos);
  options = looking_through(4);
  options.floats = true;
  EXPECT_NE(refusal(gaussians, options).find("floats"), std::string::npos);
  scenes::Scene plain = test::looking_down(1.0);
  plain.materials.resize(1);
  test::add_floor(plain, 0.0, 1.0, 0);
  EXPECT_NE(refusal(Built(plain), looking_through(4)).find("needs a scene of Gaussians"), std::string::npos);
}

}  // namespace
}  // namespace marti::processors
