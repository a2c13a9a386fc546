#include "processors/cost/build_mix.h"

#include "processors/cost/step_time.h"
#include "sim/time.h"

namespace marti::processors::cost {

const BuildMixes& build_mixes() {
  // Columns: add, multiply, divide, square root, compare, integer.
  static constexpr BuildMixes table{
      .listed = {4517, 0, 0, 0, 22517, 3000},
      .overlap = {74182, 66119, 0, 0, 70750, 0},
      .child = {3750, 3750, 0, 0, 0, 0},
  };
  return table;
}

BuildCycles build_cycles(const machine::OperationCycles& cycles, const RecordWords& words) {
  const BuildMixes& mixes = build_mixes();
  using sim::add_ticks;
  const auto fetch = [&](std::int64_t words_of) { return fetch_record(cycles, words_of); };
  const auto store = [&](std::int64_t words_of) { return store_record(cycles, words_of); };
  return {.lock = add_ticks(add_ticks(cycles.integer, cycles.load), cycles.store),
          .listed = price(mixes.listed, cycles, add_ticks(fetch(words.entry), fetch(words.primitive))),
          .overlap = price(mixes.overlap, cycles, 0),
          .child = price(mixes.child, cycles, store(words.node)),
          .entry = store(words.entry),
          .publish = store(words.node)};
}

BuildTicks build_ticks(const machine::MachineConfig& config) {
  const BuildCycles cycles = build_cycles(config.operations, record_words(config));
  const sim::Clock& clock = config.clock;
  return {.lock = clock.cycles(cycles.lock),
          .listed = clock.cycles(cycles.listed),
          .overlap = clock.cycles(cycles.overlap),
          .child = clock.cycles(cycles.child),
          .entry = clock.cycles(cycles.entry),
          .publish = clock.cycles(cycles.publish)};
}

}  // namespace marti::processors::cost
