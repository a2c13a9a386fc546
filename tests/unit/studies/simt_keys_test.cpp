// Keys of SIMT nodes that need others, and what a frame reads of them.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "studies/keys/frame_keys.h"
#include "studies/run/run_result.h"
#include "studies/sweep/plan/sweep_keys.h"
#include "studies/sweep/plan/sweep_plan.h"
#include "tests/support/configuration_of.h"
#include "tests/support/user_error.h"

namespace marti::studies {
namespace {

// Reads frame and machine.
void read(const std::string& text) {
  sim::Config config = sim::Config::from_text(run::run_schema(), text, "machine.toml", {});
  (void)keys::read_frame(config);
  (void)keys::read_machine(config);
  config.refuse_unused();
}

TEST(SimtKeys, RefuseWhatTheyCannotHaveWithPlaceAndWhatToSet) {
  struct Case {
    std::string text;
    std::string says;
  };
  const std::string bvh = "node.kind = 'simt'\nstructure.kind = 'bvh'\n";
  const std::string treelets = bvh + "layout.node_order = 'treelets'\n";
  const std::vector<Case> cases = {
      {"node.kind = 'core'\nprefetch.stack = 2\n", "machine.toml:2: prefetch.stack: "},
      {"node.kind = 'core'\nprefetch.treelet = true\n", "machine.toml:2: prefetch.treelet: "},
      {"node.kind = 'core'\nrt.order = 'breadth_first'\n", "machine.toml:2: rt.order: "},
      {"node.kind = 'simt'\nprefetch.stack = 2\n",
       "machine.toml:2: prefetch.stack: must be 0 with structure.kind"},
      {"node.kind = 'simt'\nrt.order = 'breadth_first'\n", "machine.toml:2: rt.order: "},
      {bvh + "rt.warps = 0\nprefetch.stack = 2\n",
       "machine.toml:4: prefetch.stack: is for warps in a ray-tracing unit; set rt.warps"},
      {bvh + "prefetch.stack = 2\nrt.order = 'breadth_first'\n",
       "machine.toml:3: prefetch.stack: must be 0 with rt.order"},
      {"node.kind = 'core'\nrt.sort = 'kind'\n", "machine.toml:2: rt.sort: "},
      {"node.kind = 'simt'\nrt.warps = 0\nrt.sort = 'kind'\n", "machine.toml:3: rt.sort: "},
      {"node.kind = 'simt'\nrt.sort = 'colour'\n", "machine.toml:2: rt.sort: "},
      {"node.kind = 'simt'\nrt.sort_rays = 64\n", "machine.toml:2: rt.sort_rays: "},
      {"node.kind = 'simt'\nrt.sort_cycles = 64\n", "machine.toml:2: rt.sort_cycles: "},
      {"node.kind = 'simt'\nrt.sort = 'origin'\nrt.sort_rays = 0\n", "machine.toml:3: rt.sort_rays: "},
      {"node.kind = 'simt'\nrt.sort = 'origin'\nrt.sort_rays = 4097\n", "machine.toml:3: rt.sort_rays: "},
      {"node.kind = 'simt'\nrt.sort = 'origin'\nrt.sort_cycles = -1\n", "machine.toml:3: rt.sort_cycles: "},
      {"node.kind = 'simt'\nrt.sort = 'origin'\nrt.sort_rays = 64\nrt.sort_cycles = 0\n", "no UserError"},
      {"node.kind = 'core'\nrt.share = 'warp'\n", "machine.toml:2: rt.share: "},
      {"node.kind = 'simt'\nrt.share = 'warp'\n",
       "machine.toml:2: rt.share: must be \"none\" with structure.kind"},
      {bvh + "rt.warps = 0\nrt.share = 'warp'\n", "machine.toml:4: rt.share: "},
      {bvh + "rt.share = 'lanes'\n", "machine.toml:3: rt.share: "},
      {bvh + "rt.share = 'warp'\nrt.stack = 2\n", "machine.toml:4: rt.stack: must be 0 with rt.share"},
      {bvh + "rt.share = 'warp'\nprefetch.stack = 2\n",
       "machine.toml:4: prefetch.stack: must be 0 with rt.share"},
      {bvh + "rt.share = 'warp'\n", "no UserError"},
      {"node.kind = 'core'\nrt.stack = 2\n", "machine.toml:2: rt.stack: "},
      {"node.kind = 'simt'\nrt.stack = 2\n", "machine.toml:2: rt.stack: must be 0 with structure.kind"},
      {bvh + "rt.warps = 0\nrt.stack = 2\n", "machine.toml:4: rt.stack: "},
      {bvh + "rt.stack = 2\nrt.order = 'breadth_first'\n",
       "machine.toml:3: rt.stack: must be 0 with rt.order"},
      {bvh + "rt.stack = -1\n", "machine.toml:3: rt.stack: "},
      {bvh + "rt.stack = 1025\n", "machine.toml:3: rt.stack: "},
      {bvh + "database.placement = 'replicated'\nrt.stack = 2\n", "machine.toml:4: rt.stack: "},
      {bvh + "cache.sector = '4 B'\nrt.stack = 2\n",
       "machine.toml:4: rt.stack: needs lines of at least 8 bytes"},
      {bvh + "rt.stack = 2\n", "no UserError"},
      {bvh + "prefetch.stack = 65\n", "machine.toml:3: prefetch.stack: "},
      {bvh + "prefetch.queue = 5\n", "machine.toml:3: prefetch.queue: "},
      {bvh + "prefetch.treelet = true\n",
       "machine.toml:3: prefetch.treelet: needs nodes that lie in treelets; set layout.node_order"},
      {bvh + "rt.scheduler = 'treelet'\n",
       "machine.toml:3: rt.scheduler: \"treelet\" needs nodes that lie in treelets; set layout.node_order"},
      {bvh + "rt.order = 'treelet_first'\n",
       "machine.toml:3: rt.order: \"treelet_first\" needs nodes that lie in treelets; set layout.node_order"},
      {treelets + "database.placement = 'replicated'\nprefetch.treelet = true\n",
       "machine.toml:5: prefetch.treelet: "},
      {bvh + "prefetch.stack = 2\nprefetch.queue = 5\n", "no UserError"},
      {treelets + "prefetch.treelet = true\nrt.scheduler = 'treelet'\nrt.order = 'treelet_first'\n",
       "no UserError"},
  };
  for (const Case& one : cases) {
    const std::string said = test::user_error_of([&] { read(one.text); });
    EXPECT_TRUE(said.starts_with(one.says)) << one.text << said;
  }
}

// Stacks are recorded once for all machines of a frame that may want them, and belong to no other frame.
TEST(SimtKeys, AFrameHasStacksIfAnyOfItsMachinesMayUseThem) {
  const auto frames_of = [](const std::string& axes) {
    sim::Config config = sim::Config::from_text(
        sweep::sweep_schema(), "structure.kind = 'bvh'\n[sweep.axes]\n" + axes, "sweep.toml", {});
    return sweep::plan_sweep(config).frames;
  };
  const auto both = frames_of("node.kind = ['core', 'simt']\n");
  ASSERT_EQ(both.size(), 1U);
  EXPECT_TRUE(both.front().config.render.entered);
  const auto entered = frames_of("node.kind = ['simt']\nprefetch.stack = [0, 2]\n");
  ASSERT_EQ(entered.size(), 1U);
  EXPECT_TRUE(entered.front().config.render.entered);
  EXPECT_FALSE(frames_of("machine.nodes = [2, 3]\n").front().config.render.entered);
  const auto sorted = frames_of("node.kind = ['simt']\nrt.sort = ['none', 'kind', 'direction']\n");
  ASSERT_EQ(sorted.size(), 1U);
  EXPECT_TRUE(sorted.front().config.render.ray_words);
  EXPECT_FALSE(entered.front().config.render.ray_words);
  const auto shared = frames_of("node.kind = ['simt']\nrt.share = ['none', 'warp']\n");
  ASSERT_EQ(shared.size(), 1U);
  EXPECT_TRUE(shared.front().config.render.meets);
  EXPECT_FALSE(entered.front().config.render.meets);
  EXPECT_EQ(frames_of("node.kind = ['simt']\nrt.order = ['depth_first', 'breadth_first']\n").size(), 2U);
}

}  // namespace
}  // namespace marti::studies
