// The simulated machine against a second implementation of it, in SystemC and TLM-2.0, written from
// docs/internals/model.md. Other random machines: --gtest_random_seed=N.
#include <gtest/gtest.h>

#include <array>
#include <deque>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "processors/replay/replay.h"
#include "sim/error.h"
#include "tests/validation/systemc/difference.h"
#include "tests/validation/systemc/simulate.h"
#include "tests/validation/systemc_machines.h"

namespace marti::oracle {
namespace {

using processors::cost::Activity;
using processors::machine::MachineConfig;
using processors::replay::MachineResult;

constexpr std::uint32_t random_machine_count = 240;

struct Compared {
  std::deque<ComparedMachine> machines;
  std::vector<MachineResult> replays;
};

const Compared& compared() {
  static const Compared all = [] {
    Compared result;
    const auto seed = static_cast<std::uint64_t>(GTEST_FLAG_GET(random_seed));
    result.machines = random_machines(1000 * (seed + 1), random_machine_count);
    for (ComparedMachine& machine : machines_of_real_frames()) {
      result.machines.push_back(std::move(machine));
    }
    for (const ComparedMachine& machine : result.machines) {
      result.replays.push_back(processors::replay::replay(machine.log, machine.config));
    }
    return result;
  }();
  return all;
}

// The comparison finds each change of one figure of a machine whose banks are used.
void expect_changes_found(const MachineResult& replay, const MachineFigures& systemc) {
  const std::array<std::function<void(MachineFigures&)>, 14> changes = {
      [](MachineFigures& m) { ++m.end; },
      [](MachineFigures& m) { ++m.packets; },
      [](MachineFigures& m) { ++m.host.busy; },
      [](MachineFigures& m) { ++m.nodes.back().finish; },
      [](MachineFigures& m) { ++m.nodes.back().steps.lookups; },
      [](MachineFigures& m) { ++m.nodes.back().time[3]; },
      [](MachineFigures& m) { ++m.nodes.back().references.hits[1]; },
      [](MachineFigures& m) { ++m.nodes.back().references.misses[5]; },
      [](MachineFigures& m) { m.nodes.pop_back(); },
      [](MachineFigures& m) { ++m.clusters.back().interconnect.bytes; },
      [](MachineFigures& m) { ++m.clusters[0].banks[0].statistics.accesses; },
      [](MachineFigures& m) { m.clusters[0].banks.pop_back(); },
      [](MachineFigures& m) { ++m.clusters[0].banks[0].waits.begin()->second; },
      [](MachineFigures& m) { --m.clusters[0].waits.begin()->second; }};
  for (std::size_t change = 0; change < changes.size(); ++change) {
    MachineFigures figures = systemc;
    changes[change](figures);
    EXPECT_FALSE(differences(replay, figures).empty()) << "change " << change;
  }
}

TEST(SystemC, EqualsTheReplayInEveryFigure) {
  const Compared& all = compared();
  std::vector<Job> jobs;
  for (const ComparedMachine& machine : all.machines) {
    jobs.push_back({&machine.log, &machine.config});
  }
  const std::vector<MachineFigures> simulated = simulate(jobs).machines;
  ASSERT_EQ(simulated.size(), all.machines.size());
  const MachineFigures* with_banks = nullptr;
  for (std::size_t i = 0; i < simulated.size(); ++i) {
    const std::vector<std::string> lines = differences(all.replays[i], simulated[i]);
    EXPECT_TRUE(lines.empty()) << all.machines[i].name << ": " << lines.size()
                               << " figures differ, the first is " << lines.front();
    const std::vector<BankFigures>& banks = simulated[i].clusters[0].banks;
    if (with_banks == nullptr && !banks.empty() && !banks[0].waits.empty()) {
      with_banks = &simulated[i];
      expect_changes_found(all.replays[i], simulated[i]);
    }
  }
  EXPECT_NE(with_banks, nullptr);
}

// The comparison is meaningful only if the machines do something.
TEST(SystemC, TheMachinesDoWhatTheModelCanDo) {
  const Compared& all = compared();
  const auto expect_some = [&all](const char* what, const auto& does) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < all.machines.size(); ++i) {
      count += does(all.machines[i].config, all.replays[i]) ? 1U : 0U;
    }
    EXPECT_GE(count, 3U) << what;
  };
  const auto waited = [](Activity activity) {
    return [activity](const MachineConfig&, const MachineResult& result) {
      return result.time()[static_cast<std::size_t>(activity)] > 0;
    };
  };
  expect_some("full write buffers", waited(Activity::queue_full_wait));
  expect_some("waits for the interconnect", waited(Activity::interconnect_wait));
  expect_some("waits for banks", waited(Activity::bank_wait));
  expect_some("waits for the host", waited(Activity::dispatch_wait));
  for (const auto kind :
       {memory::InterconnectKind::ideal, memory::InterconnectKind::bus, memory::InterconnectKind::crossbar}) {
    expect_some("reads and writes on each interconnect",
                [kind](const MachineConfig& c, const MachineResult& r) {
                  const memory::InterconnectStatistics& moved = r.clusters[0].interconnect;
                  return c.interconnect.kind == kind && moved.reads > 0 && moved.writes > 0;
                });
  }
  for (const auto mode : {memory::BusMode::held, memory::BusMode::split}) {
    expect_some("waits on buses in each mode", [mode](const MachineConfig& c, const MachineResult& r) {
      return c.interconnect.kind == memory::InterconnectKind::bus && c.interconnect.mode == mode &&
             r.clusters[0].interconnect.waits.sum > 0;
    });
  }
  for (const auto organisation :
       {processors::machine::CacheOrganisation::unified, processors::machine::CacheOrganisation::split}) {
    for (const auto replacement :
         {memory::Replacement::lru, memory::Replacement::fifo, memory::Replacement::random,
          memory::Replacement::plru, memory::Replacement::srrip}) {
      expect_some("hits and misses of each cache", [=](const MachineConfig& c, const MachineResult& r) {
        return c.cache.organisation == organisation && c.cache.cache.replacement == replacement &&
               c.cache.cache.ways != 1 && r.references().all_hits() > 0 &&
               r.references().all_misses() >
                   2 * static_cast<std::int64_t>(c.cache.cache.size / c.cache.cache.line);
      });
    }
  }
  expect_some("no caches", [](const MachineConfig& c, const MachineResult&) {
    return c.cache.organisation == processors::machine::CacheOrganisation::none;
  });
  expect_some("own copies", [](const MachineConfig& c, const MachineResult&) {
    return c.placement == processors::machine::Placement::replicated;
  });
  for (const auto assignment :
       {processors::machine::Assignment::dynamic, processors::machine::Assignment::interleaved,
        processors::machine::Assignment::blocks}) {
    expect_some("several packets for each node", [=](const MachineConfig& c, const MachineResult& r) {
      return c.host.assignment == assignment && r.packets > 2 * r.nodes.size() && r.nodes.size() > 2;
    });
  }
  processors::cost::StepCounts steps;
  for (const MachineResult& result : all.replays) {
    sim::merge(steps, result.steps());
  }
  sim::for_each_counter(
      steps, [](const auto& counter, std::int64_t value) { EXPECT_GT(value, 100) << counter.name; });
}

TEST(SystemC, RefusesWhatItDoesNotModel) {
  EXPECT_NO_THROW(refuse_what_is_not_modelled({}));
  const std::array<std::function<void(MachineConfig&)>, 8> changes = {
      [](MachineConfig& c) { c.contexts = 2; },
      [](MachineConfig& c) { c.l2.sharing = processors::machine::SecondLevel::shared; },
      [](MachineConfig& c) { c.interconnect.arbitration = memory::Arbitration::round_robin; },
      [](MachineConfig& c) { c.build.sharing = processors::machine::Sharing::shared; },
      [](MachineConfig& c) { c.scheme = processors::machine::Scheme::space; },
      [](MachineConfig& c) { c.placement = static_cast<processors::machine::Placement>(99); },
      [](MachineConfig& c) { c.cache.cache.replacement = static_cast<memory::Replacement>(99); },
      [](MachineConfig& c) { c.interconnect.kind = static_cast<memory::InterconnectKind>(99); }};
  for (std::size_t change = 0; change < changes.size(); ++change) {
    MachineConfig config;
    changes[change](config);
    EXPECT_THROW(refuse_what_is_not_modelled(config), sim::InternalError) << "change " << change;
  }
}

}  // namespace
}  // namespace marti::oracle

// SystemC's library has a main() too; this one is the program's.
int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
