// Random machines in which rays move, and logs with large trees of rays.
#pragma once

#include <algorithm>
#include <array>

#include "tests/support/random_machine.h"

namespace marti::test {

/// Random sizes and costs of messages and a random network.
inline void add_random_messages(Random& random, processors::machine::MachineConfig& machine) {
  machine.messages.ray_bytes = static_cast<std::uint32_t>(pick(random, 1, 80));
  machine.messages.contribution_bytes = static_cast<std::uint32_t>(pick(random, 1, 20));
  machine.messages.send_cycles = pick(random, 0, 4);
  machine.messages.receive_cycles = pick(random, 0, 4);
  machine.network.kind = static_cast<memory::NetworkKind>(pick(random, 0, 4));
  machine.network.clock = sim::Clock::from_period(pick(random, 1, 40));
  machine.network.width = static_cast<std::uint32_t>(pick(random, 1, 16));
  machine.network.cycles_per_beat = pick(random, 0, 2);
  machine.network.hop_cycles = pick(random, 0, 5);
  machine.host.occupancy_cycles = pick(random, 0, 1) * pick(random, 0, 30);
}

/// A pipeline of at most a few nodes, small queues and any admissible number of rays in flight.
inline void make_random_pipeline(Random& random, processors::machine::MachineConfig& machine) {
  add_random_messages(random, machine);
  machine.scheme = processors::machine::Scheme::pipeline;
  if (machine.placement == processors::machine::Placement::distributed) {
    machine.placement = processors::machine::Placement::shared;
  }
  processors::machine::PipelineConfig& pipeline = machine.pipeline;
  pipeline.search = static_cast<std::uint32_t>(pick(random, 1, 3));
  pipeline.nearest = static_cast<std::uint32_t>(pick(random, 1, 3));
  pipeline.shade = static_cast<std::uint32_t>(pick(random, 1, 3));
  machine.nodes = pipeline.search + pipeline.nearest + pipeline.shade;
  pipeline.queue = static_cast<std::uint32_t>(pick(random, 1, 3));
  pipeline.in_flight =
      pick(random, 0, 2) == 0
          ? 0
          : static_cast<std::uint32_t>(pick(random, 1, processors::machine::most_in_flight(pipeline)));
}

/// A random division of space, small queues and any number of rays in flight.
inline void make_random_space(Random& random, processors::machine::MachineConfig& machine) {
  add_random_messages(random, machine);
  machine.scheme = processors::machine::Scheme::space;
  if (machine.placement == processors::machine::Placement::distributed) {
    machine.placement = processors::machine::Placement::shared;  // of no effect
  }
  processors::machine::SpaceConfig& space = machine.space;
  space.policy = static_cast<processors::machine::RegionPolicy>(pick(random, 0, 3));
  space.level = static_cast<std::uint32_t>(pick(random, 1, 6));
  space.queue = static_cast<std::uint32_t>(pick(random, 0, 1) == 0 ? 1 : pick(random, 1, 9));
  space.in_flight = static_cast<std::uint32_t>(std::array{0, 1, 2, 30}[random() % 4]);
  space.sample_step = static_cast<std::uint32_t>(pick(random, 1, 4));
}

/// A log whose pixels have `samples` trees of up to `most_rays` rays, up to `deepest` bounces deep, each with
/// a short walk; a ray at a hit point has several children.
inline processors::program::WorkLog random_ray_trees(Random& random, std::uint32_t width,
                                                     std::uint32_t height, std::int64_t most_rays,
                                                     std::int64_t deepest, std::uint32_t samples = 1) {
  using processors::program::make_word;
  using processors::program::RayKind;
  using processors::program::Step;
  processors::program::WorkLog log = random_tree_log(random, width, height);
  log.samples = samples;
  for (processors::program::LogRow& row : log.rows) {
    row = {};
    for (std::uint32_t x = 0; x < width; ++x) {
      row.begin.push_back(static_cast<std::uint32_t>(row.words.size()));
      for (std::uint32_t sample = 0; sample < samples; ++sample) {
        std::int64_t bounce = 0;
        for (std::int64_t rays = pick(random, 1, most_rays); rays > 0; --rays) {
          const auto kind = bounce == 0 ? RayKind::camera : static_cast<RayKind>(pick(random, 1, 4));
          row.words.push_back(make_word(
              Step::ray, processors::program::ray_operand(kind, static_cast<std::uint32_t>(bounce))));
          append_walk(random, log, 0, row.words);
          if (kind != RayKind::shadow) {
            row.words.push_back(make_word(Step::shade, 0));
          } else if (random() % 2 == 0) {
            row.words.push_back(make_word(Step::light, 0));
          }
          bounce = std::clamp<std::int64_t>(bounce + pick(random, -1, 1), 1, deepest);
        }
      }
    }
    row.begin.push_back(static_cast<std::uint32_t>(row.words.size()));
  }
  return log;
}

/// A log whose rays walk down a tree that a machine can build.
inline processors::program::WorkLog random_log_with_tree(Random& random) {
  const auto width = static_cast<std::uint32_t>(pick(random, 1, 8));
  const auto height = static_cast<std::uint32_t>(pick(random, 1, 8));
  switch (pick(random, 0, 2)) {
    case 0:
      return random_tree_log(random, width, height);
    case 1:
      return random_ray_trees(random, width, height, 12, 4);
    default:
      return random_ray_trees(random, width, height, 5, 4, static_cast<std::uint32_t>(pick(random, 2, 5)));
  }
}

/// Any log that a machine can time; `instances`: one that does not divide space.
inline processors::program::WorkLog any_log(Random& random, bool instances = true) {
  return pick(random, 0, 3) == 0 ? random_log(random, static_cast<std::uint32_t>(pick(random, 1, 12)),
                                              static_cast<std::uint32_t>(pick(random, 1, 12)), 40, instances)
                                 : random_log_with_tree(random);
}

}  // namespace marti::test
