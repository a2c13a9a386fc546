// What a functional run says of its structure.
#include "studies/functional_run.h"

#include <gtest/gtest.h>

namespace marti::studies {
namespace {

FrameConfig teapot(const char* structure, std::uint64_t max_entries) {
  FrameConfig config;
  config.scene = "teapot:4";
  config.structure = structure;
  config.structure_options.octree.max_entries = max_entries;
  config.structure_options.bsp.max_entries = max_entries;
  config.render.width = 8;
  config.render.height = 8;
  config.memory = sim::MemoryBudget(std::uint64_t{1} << 30U);
  return config;
}

TEST(FunctionalRun, SaysThatATreeWasCut) {
  for (const char* structure : {"octree", "bsp"}) {
    const FunctionalRun whole = run_functional(teapot(structure, std::uint64_t{1} << 25));
    const FunctionalRun cut = run_functional(teapot(structure, 2000));
    EXPECT_TRUE(whole.structure_notes.empty());
    ASSERT_EQ(cut.structure_notes.size(), 1U);
    EXPECT_NE(cut.structure_notes[0].find("division stopped"), std::string::npos);
    EXPECT_LT(cut.frame.log->topology.nodes.size(), whole.frame.log->topology.nodes.size());
    EXPECT_EQ(cut.image_hash, whole.image_hash);
  }
}

}  // namespace
}  // namespace marti::studies
