// Rendering with an octree that grows meanwhile.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "accel/structure.h"
#include "processors/program/render.h"
#include "scenes/procedural.h"
#include "tests/support/user_error.h"
#include "tests/unit/processors/program_scenes.h"

namespace marti::processors::test {

using namespace program;

namespace {

TEST(LazyRender, GivesTheImageOfAnyStructureOnAnyNumberOfThreads) {
  const Built eager(scenes::make_procedural("teapot:4"), "octree");
  const RenderOptions options{.width = 48, .height = 48, .max_depth = 3};
  const Frame expected = eager.render(options);
  for (const unsigned threads : {1U, 4U}) {
    accel::LazyOctreeOptions lazy_options;
    lazy_options.initial.level = 1;
    const auto lazy = accel::make_lazy_octree(eager.triangles, lazy_options);
    const Frame frame = render(eager.scene, *eager.triangles, *lazy, options, threads);
    EXPECT_EQ(frame.hit_hash, expected.hit_hash);
    EXPECT_TRUE(std::equal(frame.image.pixels.begin(), frame.image.pixels.end(),
                           expected.image.pixels.begin(), expected.image.pixels.end()));
    const accel::LazyOctreeState state =
        dynamic_cast<const accel::StructureOf<accel::LazyOctree>&>(*lazy).concrete().state();
    EXPECT_GT(state.subdivided, 0U);
    EXPECT_LT(state.all.nodes(), eager.structure->topology().nodes.size());
  }
}

TEST(LazyRender, StopsWithTheReasonWhenTheTreeGrowsTooLarge) {
  const Built eager(scenes::make_procedural("teapot:4"), "octree");
  accel::LazyOctreeOptions options;
  options.initial.level = 1;
  options.tree.max_entries = eager.triangles->size() + 100;
  const auto lazy = accel::make_lazy_octree(eager.triangles, options);
  EXPECT_NE(marti::test::user_error_of([&] {
              (void)render(eager.scene, *eager.triangles, *lazy, {.width = 32, .height = 32}, 3);
            }).find("max_entries"),
            std::string::npos);
}

TEST(LazyRender, CannotBeRecorded) {
  const Built eager(scenes::make_procedural("tetra:1"));
  const auto lazy = accel::make_lazy_octree(eager.triangles);
  EXPECT_NE(marti::test::user_error_of([&] {
              (void)render(eager.scene, *eager.triangles, *lazy, {.width = 2, .height = 2, .record = true});
            }).find("work log"),
            std::string::npos);
}

}  // namespace
}  // namespace marti::processors::test
