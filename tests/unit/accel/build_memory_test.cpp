// Builders stay within their memory budget, as the operating system measures it, and say what to change.
#include <gtest/gtest.h>

#include <memory>
#include <random>

#include "accel/structure.h"
#include "sim/work_meter.h"
#include "tests/support/measured_memory.h"
#include "tests/support/user_error.h"

namespace marti::accel {
namespace {

constexpr std::uint64_t mebibyte = std::uint64_t{1} << 20U;

// Small triangles all over a cube: the trees over them grow until their levels end.
std::shared_ptr<const TriangleSet> scattered(std::size_t count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(0.0, 1.0);
  std::uniform_real_distribution<double> size(0.0, 0.4);
  std::vector<TriangleCorners> triangles(count);
  for (TriangleCorners& corners : triangles) {
    const double x = place(random);
    const double y = place(random);
    const double z = place(random);
    corners = {x, y, z, x + size(random), y, z, x, y + size(random), z + size(random)};
  }
  return std::make_shared<const TriangleSet>(std::move(triangles));
}

StructureOptions options_of(std::uint64_t limit) {
  StructureOptions options;
  options.octree.max_objects = 1;
  options.octree.max_level = 7;
  options.octree.threads = 1;
  options.octree.memory = sim::MemoryBudget(limit);
  options.bsp.max_objects = 1;
  options.bsp.max_level = 7;
  options.bsp.memory = options.octree.memory;
  options.grid.density = 1000.0;
  options.grid.memory = options.octree.memory;
  return options;
}

// A hierarchy is as large as the scene, so it takes more triangles.
TEST(BuildMemoryOfABvh, NeverExceedsTheBudget) {
  if (!test::memory_can_be_measured) {
    GTEST_SKIP() << "a sanitizer takes memory of its own";
  }
  const auto triangles = scattered(120'000);
  const auto build = [&](std::uint64_t limit) {
    StructureOptions options;
    options.bvh = {.max_objects = 1, .threads = 1, .memory = sim::MemoryBudget(limit)};
    return test::user_error_of([&] { (void)make_structure("bvh", triangles, options); });
  };
  EXPECT_NE(build(mebibyte).find("more than 1 MiB"), std::string::npos);
  // What the references, the binary tree, and the records need.
  for (const std::uint64_t limit : {mebibyte, 12 * mebibyte, 22 * mebibyte, 26 * mebibyte, 30 * mebibyte}) {
    EXPECT_LT(test::peak_bytes([&] { (void)build(limit); }), limit + 3 * mebibyte) << limit;
  }
  EXPECT_GT(test::peak_bytes([&] { (void)build(2048 * mebibyte); }), 20 * mebibyte);
}

class BuildMemory : public ::testing::TestWithParam<const char*> {};

TEST_P(BuildMemory, NeverExceedsTheBudget) {
  if (!test::memory_can_be_measured) {
    GTEST_SKIP() << "a sanitizer takes memory of its own";
  }
  const auto triangles = scattered(1500);
  const auto build = [&](std::uint64_t limit) {
    return test::user_error_of([&] { (void)make_structure(GetParam(), triangles, options_of(limit)); });
  };
  const std::string refusal = build(mebibyte);
  EXPECT_NE(refusal.find("structure."), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("more than 1 MiB"), std::string::npos) << refusal;
  for (const std::uint64_t limit : {1 * mebibyte, 6 * mebibyte}) {
    // Room for pages, the allocator's own memory, and nodes made between two checks.
    EXPECT_LT(test::peak_bytes([&] { (void)build(limit); }), limit + 3 * mebibyte) << limit;
  }
  // The limits refuse this tree; a larger limit allows it.
  EXPECT_GT(test::peak_bytes([&] { (void)build(2048 * mebibyte); }), 9 * mebibyte);
}

// A tree that nobody waits for any more is not built.
TEST_P(BuildMemory, IsAskedWhetherSomebodyWaits) {
  sim::WorkMeter meter;
  StructureOptions options = options_of(2048 * mebibyte);
  for (sim::MemoryBudget* const memory :
       {&options.octree.memory, &options.bsp.memory, &options.grid.memory, &options.bvh.memory}) {
    memory->wait_with(&meter);
  }
  const auto triangles = scattered(500);
  EXPECT_NO_THROW((void)make_structure(GetParam(), triangles, options));
  meter.stop();
  EXPECT_THROW((void)make_structure(GetParam(), triangles, options), sim::Stopped);
}

// The message about a structure that is built.
TEST_P(BuildMemory, OfABuiltStructureIsKnown) {
  const auto triangles = scattered(500);
  const auto structure = make_structure(GetParam(), triangles, options_of(2048 * mebibyte));
  EXPECT_GE(host_bytes(*structure), bytes_of(structure->topology()));
  if (!test::memory_can_be_measured) {
    GTEST_SKIP() << "a sanitizer takes memory of its own";
  }
  const std::uint64_t peak = test::peak_bytes(
      [&] { static const auto kept = make_structure(GetParam(), triangles, options_of(2048 * mebibyte)); });
  EXPECT_LT(host_bytes(*structure), peak + mebibyte);
}

INSTANTIATE_TEST_SUITE_P(Kinds, BuildMemory, ::testing::Values("octree", "bsp", "grid"));

}  // namespace
}  // namespace marti::accel
