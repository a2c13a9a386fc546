#include "processors/cost/step_time.h"

namespace marti::processors::cost {

RecordWords record_words(const machine::MachineConfig& config) {
  const auto words = [&config](std::uint32_t bytes) {
    return (std::int64_t{bytes} + config.word_bytes - 1) / config.word_bytes;
  };
  const memory::LayoutConfig& layout = config.layout;
  return {words(layout.node_bytes),    words(layout.entry_bytes),    words(layout.primitive_bytes),
          words(layout.quadric_bytes), words(layout.material_bytes), words(layout.texel_bytes),
          words(layout.pixel_bytes),   words(layout.transform_bytes)};
}

StepTicks step_ticks(const machine::MachineConfig& config, const program::WorkLog& log) {
  const StepCycles cycles =
      step_cycles(config.operations, record_words(config), log.traversal, log.mailboxes, log.integrator);
  StepTicks ticks;
  for (std::size_t kind = 0; kind < program::ray_kinds; ++kind) {
    ticks.ray[kind] = config.clock.cycles(cycles.ray[kind]);
  }
  ticks.branch = config.clock.cycles(cycles.branch);
  ticks.transform = config.clock.cycles(cycles.transform);
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
  ticks.any_hit = config.clock.cycles(cycles.any_hit);
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
  for_each_step(ticks, steps, add);
  add(Activity::cache_access, ticks.hit, hits);
}

}  // namespace marti::processors::cost
