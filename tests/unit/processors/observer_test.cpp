// An observed replay: every event is observed once, and the result does not change.
#include "processors/walk/observer.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <map>

#include "processors/replay/replay.h"
#include "tests/support/random_flow.h"
#include "tests/support/random_machine.h"

namespace marti::processors {
namespace {

constexpr std::size_t index_of(NodeState state) { return static_cast<std::size_t>(state); }

/// Adds up all that it observes, and records contradictions to the interface.
class Recorder final : public Observer {
 public:
  void begin(const ReplayInput& input) override {
    until.resize(input.config.all_nodes());
    states.resize(input.config.all_nodes());
    misses.resize(input.config.all_nodes());
    packets.resize(input.packets.size());
    width = input.log.width;
    height = input.log.height;
  }
  void spent(std::uint32_t node, NodeState state, sim::Ticks from, sim::Ticks to, PixelPlace pixel) override {
    faults += from != until[node] || to < from ? 1 : 0;
    faults += !pixel.none() && (pixel.x >= width || pixel.y >= height) ? 1 : 0;
    faults += !pixel.none() && (state == NodeState::idle || state == NodeState::dispatch_wait) ? 1 : 0;
    until[node] = to;
    states[node][index_of(state)] += to - from;
    if (!pixel.none()) {
      pixel_time[{pixel.x, pixel.y}] += to - from;
    }
  }
  void missed(std::uint32_t node, std::int64_t count, PixelPlace pixel) override {
    misses[node] += count;
    if (!pixel.none()) {
      pixel_misses += count;
    }
  }
  void began_packet(std::uint32_t node, std::uint64_t packet, sim::Ticks start) override {
    ++packets[packet];
    faults += start != until[node] ? 1 : 0;
  }
  void end(sim::Ticks time) override { ended = time; }

  std::vector<sim::Ticks> until;
  std::vector<std::array<sim::Ticks, node_states>> states;
  std::vector<std::int64_t> misses;
  std::vector<int> packets;
  std::map<std::pair<std::uint32_t, std::uint32_t>, sim::Ticks> pixel_time;
  std::int64_t pixel_misses = 0;
  sim::Ticks ended = -1;
  int faults = 0;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
};

sim::Ticks part(const TimeDivision& time, Activity activity) {
  return time[static_cast<std::size_t>(activity)];
}

void expect_complete(const Recorder& seen, const MachineResult& result) {
  RC_ASSERT(seen.faults == 0);
  RC_ASSERT(seen.ended == result.end);
  sim::Ticks of_pixels = 0;
  for (const auto& [place, time] : seen.pixel_time) {
    of_pixels += time;
  }
  sim::Ticks nobodys = 0;
  for (std::size_t node = 0; node < result.nodes.size(); ++node) {
    const TimeDivision& time = result.nodes[node].time;
    const auto& told = seen.states[node];
    RC_ASSERT(seen.until[node] == result.end);
    const auto equal = [&](NodeState state, Activity activity) {
      return told[index_of(state)] == part(time, activity);
    };
    RC_ASSERT(equal(NodeState::interconnect_wait, Activity::interconnect_wait));
    RC_ASSERT(equal(NodeState::bank_wait, Activity::bank_wait));
    RC_ASSERT(equal(NodeState::lock_wait, Activity::lock_wait));
    RC_ASSERT(equal(NodeState::message_wait, Activity::message_wait));
    RC_ASSERT(equal(NodeState::queue_full_wait, Activity::queue_full_wait));
    RC_ASSERT(equal(NodeState::dispatch_wait, Activity::dispatch_wait));
    RC_ASSERT(equal(NodeState::idle, Activity::idle));
    // Reading own memory is working.
    RC_ASSERT(told[index_of(NodeState::transfer)] <= part(time, Activity::transfer));
    RC_ASSERT(told[index_of(NodeState::bank_access)] <= part(time, Activity::bank_access));
    RC_ASSERT(sum_of(time) == result.end);
    RC_ASSERT(seen.misses[node] == result.nodes[node].references.all_misses());
    nobodys +=
        part(time, Activity::dispatch_wait) + part(time, Activity::message_wait) + part(time, Activity::idle);
  }
  for (const int times : seen.packets) {
    RC_ASSERT(times == (result.flow.nodes.empty() ? 1 : 0));  // where rays move, nodes have no packets
  }
  const sim::Ticks all = result.end * static_cast<sim::Ticks>(result.nodes.size());
  if (result.build.start_up == 0) {
    RC_ASSERT(of_pixels == all - nobodys);
    RC_ASSERT(seen.pixel_misses == result.references().all_misses());
  } else {
    RC_ASSERT(of_pixels <= all - nobodys);
  }
}

void expect_unchanged(const MachineResult& a, const MachineResult& b) {
  RC_ASSERT(a.end == b.end);
  RC_ASSERT(a.events == b.events);
  for (std::size_t node = 0; node < a.nodes.size(); ++node) {
    RC_ASSERT(a.nodes[node].time == b.nodes[node].time);
  }
}

RC_GTEST_PROP(Observing, TellsAllOfTheTimeAndEveryMissAndChangesNothing, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::random_log(random, static_cast<std::uint32_t>(test::pick(random, 1, 12)),
                                       static_cast<std::uint32_t>(test::pick(random, 1, 12)));
  const MachineConfig machine = test::random_machine(random);
  Recorder seen;
  ReplayOptions options;
  options.observer = &seen;
  const MachineResult result = replay(log, machine, options);
  expect_complete(seen, result);
  expect_unchanged(result, replay(log, machine, {.keep_read_events = true}));
  if (machine.placement == Placement::shared) {
    sim::Ticks transfers = 0;
    for (const auto& node : seen.states) {
      transfers += node[index_of(NodeState::transfer)];
    }
    RC_ASSERT(transfers == part(result.time(), Activity::transfer));
  }
}

RC_GTEST_PROP(Observing, TellsTheSameOfEveryReferenceOneByOne, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::random_log(random, 7, 6);
  const MachineConfig machine = test::random_machine(random);
  Recorder ahead;
  Recorder stepped;
  ReplayOptions options;
  options.observer = &ahead;
  (void)replay(log, machine, options);
  options.observer = &stepped;
  options.step_by_step = true;
  (void)replay(log, machine, options);
  RC_ASSERT(ahead.states == stepped.states);
  RC_ASSERT(ahead.pixel_time == stepped.pixel_time);
}

RC_GTEST_PROP(Observing, TellsOfBuildingToo, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::random_tree_log(random, static_cast<std::uint32_t>(test::pick(random, 1, 8)),
                                            static_cast<std::uint32_t>(test::pick(random, 1, 8)));
  MachineConfig machine = test::random_machine(random);
  machine.build = test::random_build(random);
  if (machine.build.sharing == Sharing::shared &&
      (machine.placement != Placement::shared ||
       machine.interconnect.arbitration != memory::Arbitration::fifo)) {
    machine.build.sharing = Sharing::private_trees;
  }
  Recorder seen;
  ReplayOptions options;
  options.observer = &seen;
  const MachineResult result = replay(log, machine, options);
  expect_complete(seen, result);
  expect_unchanged(result, replay(log, machine));
}

RC_GTEST_PROP(Observing, TellsOfNodesBetweenWhichRaysMove, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::random_ray_trees(random, static_cast<std::uint32_t>(test::pick(random, 1, 6)),
                                             static_cast<std::uint32_t>(test::pick(random, 1, 6)), 6, 3);
  MachineConfig machine = test::random_machine(random);
  (random() % 2 == 0 ? test::make_random_pipeline : test::make_random_space)(random, machine);
  Recorder seen;
  ReplayOptions options;
  options.observer = &seen;
  const MachineResult result = replay(log, machine, options);
  expect_complete(seen, result);
  expect_unchanged(result, replay(log, machine));
  Recorder stepped;
  options.observer = &stepped;
  options.step_by_step = true;
  (void)replay(log, machine, options);
  RC_ASSERT(seen.states == stepped.states);
  RC_ASSERT(seen.pixel_time == stepped.pixel_time);
}

}  // namespace
}  // namespace marti::processors
