#include "processors/flow/space/region_work.h"

#include <span>

#include "processors/program/ray_tree.h"

namespace marti::processors::flow {

namespace {

// The time to compute one leaf's tests.
sim::Ticks tests_time(const program::WorkLog& log, const cost::StepTicks& ticks, const std::uint32_t* word) {
  const accel::TopologyNode& leaf = log.topology.nodes[program::operand_of(*word)];
  const std::uint32_t entries = program::step_of(*word) == program::Step::leaf ? leaf.count : word[1];
  const std::uint32_t* const mask =
      program::step_of(*word) == program::Step::mailed_leaf ? word + 2 : nullptr;
  cost::StepCounts counts;
  sim::Ticks time = log.mailboxes ? sim::multiply_ticks(ticks.lookup, entries) : 0;
  for (std::uint32_t entry = 0; entry < entries; ++entry) {
    if (mask == nullptr || program::tested_in_mask(mask, entry)) {
      const std::uint32_t primitive = log.topology.entries[leaf.first + entry];
      time = sim::add_ticks(time, cost::count_test(ticks, log.kind_of(primitive), counts));
    }
  }
  return time;
}

sim::Ticks compute_time(const program::WorkLog& log, const cost::StepTicks& ticks,
                        const std::uint32_t* word) {
  switch (program::step_of(*word)) {
    case program::Step::branch:
      return ticks.branch;
    case program::Step::leaf:
    case program::Step::partial_leaf:
    case program::Step::mailed_leaf:
      return sim::add_ticks(ticks.leaf, tests_time(log, ticks, word));
    case program::Step::ray:
      return ticks.ray[program::ray_number_of(program::operand_of(*word))];
    case program::Step::shade:
      return ticks.shade;
    case program::Step::light:
      return ticks.light;
    case program::Step::texel:
      return ticks.texel;
    case program::Step::transform:
      return ticks.transform;
    case program::Step::cut:
      return ticks.cut;
    case program::Step::pass:
      return ticks.pass;
    case program::Step::any_hit:
      return ticks.any_hit;
  }
  return 0;
}

// The region whose tree node the step reads, or RegionMap::top.
std::uint32_t region_of_step(const RegionMap& regions, std::uint32_t word) {
  return program::visits_node(program::step_of(word)) ? regions.region_of[program::operand_of(word)]
                                                      : RegionMap::top;
}

std::uint32_t first_region(const RegionMap& regions, const program::LoggedRay& ray) {
  for (const std::uint32_t* word = ray.begin; word != ray.end; word += program::step_words(word)) {
    if (const std::uint32_t region = region_of_step(regions, *word); region != RegionMap::top) {
      return region;
    }
  }
  return RegionMap::top;
}

}  // namespace

RegionWork sample_work(const program::WorkLog& log, const RegionMap& regions, const cost::StepTicks& ticks,
                       std::uint32_t step) {
  RegionWork work;
  work.of.assign(regions.size(), 0);
  std::vector<program::LoggedRay> rays;
  std::vector<std::uint32_t> ended_in;
  for (std::uint64_t y = 0; y < log.height; y += step) {
    for (std::uint64_t x = 0; x < log.width; x += step) {
      std::span<const std::uint32_t> left =
          log.pixel(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
      while (!left.empty()) {
        const std::span<const std::uint32_t> sample = program::first_sample(log, left);
        left = left.subspan(sample.size());
        program::rays_of_sample(sample, rays);
        ended_in.clear();
        for (const program::LoggedRay& ray : rays) {
          std::uint32_t at =
              ray.parent == program::LoggedRay::none ? first_region(regions, ray) : ended_in[ray.parent];
          for (const std::uint32_t* word = ray.begin; word != ray.end; word += program::step_words(word)) {
            const std::uint32_t entered = region_of_step(regions, *word);
            at = entered == RegionMap::top ? at : entered;
            const sim::Ticks time = compute_time(log, ticks, word);
            work.total = sim::add_ticks(work.total, time);
            if (at != RegionMap::top) {
              work.of[at] += static_cast<std::uint64_t>(time);
            }
          }
          ended_in.push_back(at);
        }
      }
    }
  }
  return work;
}

}  // namespace marti::processors::flow
