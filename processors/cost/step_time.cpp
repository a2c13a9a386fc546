#include "processors/cost/step_time.h"

namespace marti::processors {

namespace {

std::int64_t words(std::uint32_t bytes, std::uint32_t word_bytes) {
  return (std::int64_t{bytes} + word_bytes - 1) / word_bytes;
}

}  // namespace

StepTicks step_ticks(const MachineConfig& config, const WorkLog& log) {
  const memory::LayoutConfig& layout = config.layout;
  const std::uint32_t word = config.word_bytes;
  const StepCycles cycles = step_cycles(
      config.operations,
      {words(layout.node_bytes, word), words(layout.entry_bytes, word), words(layout.primitive_bytes, word),
       words(layout.quadric_bytes, word), words(layout.material_bytes, word), words(layout.texel_bytes, word),
       words(layout.pixel_bytes, word)},
      log.traversal, log.mailboxes);
  StepTicks ticks;
  for (std::size_t kind = 0; kind < ray_kinds; ++kind) {
    ticks.ray[kind] = config.clock.cycles(cycles.ray[kind]);
  }
  ticks.branch = config.clock.cycles(cycles.branch);
  ticks.leaf = config.clock.cycles(cycles.leaf);
  ticks.lookup = config.clock.cycles(cycles.lookup);
  ticks.test = config.clock.cycles(cycles.test);
  ticks.sphere_test = config.clock.cycles(cycles.sphere_test);
  ticks.cone_test = config.clock.cycles(cycles.cone_test);
  ticks.shade = config.clock.cycles(cycles.shade);
  ticks.light = config.clock.cycles(cycles.light);
  ticks.cut = config.clock.cycles(cycles.cut);
  ticks.pass = config.clock.cycles(cycles.pass);
  ticks.texel = config.clock.cycles(cycles.texel);
  ticks.pixel = config.clock.cycles(cycles.pixel);
  ticks.hit = config.clock.cycles(config.cache.hit_cycles);
  return ticks;
}

void add_counted_time(const StepTicks& ticks, const StepCounts& steps, std::int64_t hits,
                      TimeDivision& time) {
  const auto add = [&time](Activity activity, sim::Ticks each, std::int64_t count) {
    sim::Ticks& sum = time[static_cast<std::size_t>(activity)];
    sum = sim::add_ticks(sum, sim::multiply_ticks(each, count));
  };
  for (std::size_t kind = 0; kind < ray_kinds; ++kind) {
    add(Activity::traversal, ticks.ray[kind], steps.*ray_counters[kind]);
  }
  add(Activity::traversal, ticks.branch, steps.branches);
  add(Activity::traversal, ticks.leaf, steps.leaves);
  add(Activity::traversal, ticks.cut, steps.cuts);
  add(Activity::traversal, ticks.pass, steps.passes);
  add(Activity::intersection, ticks.lookup, steps.lookups);
  add(Activity::intersection, ticks.test, steps.tests - steps.sphere_tests - steps.cone_tests);
  add(Activity::intersection, ticks.sphere_test, steps.sphere_tests);
  add(Activity::intersection, ticks.cone_test, steps.cone_tests);
  add(Activity::shading, ticks.shade, steps.shades);
  add(Activity::shading, ticks.light, steps.lights);
  add(Activity::shading, ticks.texel, steps.texels);
  add(Activity::shading, ticks.pixel, steps.pixels);
  add(Activity::cache_access, ticks.hit, hits);
}

}  // namespace marti::processors
