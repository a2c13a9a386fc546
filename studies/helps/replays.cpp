#include "studies/helps/replays.h"

#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstdint>
#include <new>

#include "processors/replay/host_bytes.h"
#include "sim/error.h"

namespace marti::studies::helps {

namespace {

using processors::machine::MachineConfig;
using processors::walk::StrippedLog;

// Neither counting nor energy changes a time.
MachineConfig without_counting(const MachineConfig& machine) {
  MachineConfig plain = machine;
  plain.count = {};
  plain.energy = {};
  return plain;
}

Replayed replay_one(const SharedLog& shared, const MachineConfig& machine, std::uint64_t packet_seed) {
  sim::WorkMeter packets(shared.meter);
  processors::replay::ReplayOptions options = shared.options;
  options.stripped = stripped_for(shared, machine);
  options.meter = &packets;
  options.packet_seed = packet_seed;
  try {
    const processors::replay::MachineResult result =
        processors::replay::replay(shared.log, without_counting(machine), options);
    return {result.end, false, replay_work(result, options.stripped)};
  } catch (const sim::UserError&) {
    return {};
  } catch (const std::bad_alloc&) {
    return {std::nullopt, true, 0};
  }
}

}  // namespace

std::uint64_t bytes_of(const SharedLog& shared, const MachineConfig& machine) {
  const MachineConfig timed = without_counting(machine);
  try {
    return processors::replay::host_bytes(shared.log, timed);
  } catch (const sim::UserError&) {
    return processors::replay::host_bytes(timed, shared.log.width, shared.log.height);
  }
}

const StrippedLog* stripped_for(const SharedLog& shared, const MachineConfig& machine) {
  const StrippedLog* const stripped = shared.stripped.get();
  return stripped != nullptr && stripped->suits(without_counting(machine)) ? stripped : nullptr;
}

std::vector<Replayed> replay_all(const SharedLog& shared, std::span<const MachineConfig* const> machines,
                                 std::uint64_t most_bytes, std::span<const std::uint64_t> packet_seeds) {
  const auto cores = static_cast<std::uint64_t>(tbb::this_task_arena::max_concurrency());
  const std::uint64_t at_a_time =
      std::clamp<std::uint64_t>(shared.memory.left() / std::max<std::uint64_t>(1, most_bytes), 1, cores);
  std::vector<Replayed> replayed(machines.size());
  tbb::task_arena arena(static_cast<int>(at_a_time));
  arena.execute([&] {
    tbb::parallel_for(
        std::size_t{0}, machines.size(),
        [&](std::size_t i) {
          replayed[i] = replay_one(shared, *machines[i], packet_seeds.empty() ? 0 : packet_seeds[i]);
          count_step(shared.meter);
        },
        tbb::simple_partitioner());
  });
  return replayed;
}

}  // namespace marti::studies::helps
