// Figures by intervals against those of the whole frame.
#include <gtest/gtest.h>

#include <map>
#include <optional>

#include "processors/energy/energy.h"
#include "sim/key_error.h"
#include "studies/run/record/interval_figures.h"
#include "studies/run/record/observers.h"
#include "tests/support/random_flow.h"
#include "tests/support/random_simt.h"
#include "tests/unit/processors/simt_logs.h"

namespace marti::studies::run {
namespace {

using processors::machine::MachineConfig;
using processors::replay::MachineResult;
using processors::replay::ReplayOptions;

struct Machine {
  processors::program::WorkLog log;
  MachineConfig config;
};

// Turns the energy on, if that of such caches is known.
void add_energy(MachineConfig& config) {
  config.energy.preset = processors::machine::EnergyPreset::nm45;
  try {
    processors::energy::check_energy(config);
  } catch (const sim::KeyError&) {
    config.energy = {};
  }
}

// Of every kind in turn: nodes with and without contexts, that build and that do not, pipelines, regions,
// SIMT nodes; with DRAM, second levels and energy as it comes.
Machine machine_of(std::uint64_t seed) {
  test::Random random(seed);
  Machine machine;
  if (seed % 5 == 4) {
    static const std::vector<processors::program::WorkLog> logs = processors::test::simt_logs(7, 5);
    machine.log = logs[random() % logs.size()];
    machine.config = test::random_simt(random, machine.log);
    add_energy(machine.config);
    return machine;
  }
  const bool rays_move = seed % 5 == 1 || seed % 5 == 2;
  machine.log = rays_move ? test::random_ray_trees(random, 7, 6, 12, 4) : test::random_log_with_tree(random);
  machine.config = test::random_machine(random);
  test::add_random_second_level(random, machine.config);
  if (machine.config.placement == processors::machine::Placement::shared) {
    test::add_random_dram(random, machine.config);
  }
  if (seed % 5 == 0) {
    machine.config.build = test::random_build(random);
  } else if (seed % 5 == 1) {
    test::make_random_pipeline(random, machine.config);
  } else if (seed % 5 == 2) {
    test::make_random_space(random, machine.config);
  } else {
    machine.config.contexts = static_cast<std::uint32_t>(test::pick(random, 1, 3));
  }
  add_energy(machine.config);
  return machine;
}

struct Observed {
  MachineResult result;
  tables::Table table;

  // The sum of a column.
  [[nodiscard]] sim::Sum all(const std::string& column) const {
    sim::Sum sum = 0;
    for (std::size_t row = 0; row < table.rows().size(); ++row) {
      sum += std::get<std::int64_t>(table.at(row, column));
    }
    return sum;
  }
  [[nodiscard]] bool has(std::string_view name) const {
    return std::ranges::any_of(table.columns(),
                               [&](const tables::Column& column) { return column.name == name; });
  }
};

Observed observed(const Machine& machine, sim::Ticks length, processors::walk::Observer* also = nullptr) {
  IntervalFigures intervals(machine.config, length);
  Observers observers;
  observers.add(intervals);
  if (also != nullptr) {
    observers.add(*also);
  }
  ReplayOptions options;
  options.observer = &observers;
  options.intervals = &intervals.asked();
  MachineResult result = processors::replay::replay(machine.log, machine.config, options);
  tables::Table table = intervals.table(figures::counts_of(machine.config, result));
  return {std::move(result), std::move(table)};
}

// A frame is the same frame, every count which it has is there and adds up, none of what is simply counted is
// below 0, and the nodes' time is that of their accounts.
TEST(Intervals, AddUpToTheFrameOfAnyMachine) {
  std::size_t machines = 0;
  std::size_t powers = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    const Machine machine = machine_of(seed);
    std::optional<MachineResult> plain;
    try {
      plain = processors::replay::replay(machine.log, machine.config);
    } catch (const sim::UserError&) {
      continue;  // a combination that no machine has
    }
    ++machines;
    test::Random random(seed);
    const sim::Ticks length = std::max<sim::Ticks>(1, plain->end / test::pick(random, 1, 60));
    const Observed seen = observed(machine, length);
    const figures::Counts whole = figures::counts_of(machine.config, seen.result);
    const figures::Counts of_plain = figures::counts_of(machine.config, *plain);
    for (std::size_t i = 0; i < whole.size(); ++i) {
      const figures::FigureEntry& entry = figures::counted_figures()[i];
      if (entry.of_machine()) {
        EXPECT_TRUE(whole[i] == of_plain[i]) << "seed " << seed << ", " << entry.name;
      }
      if (seen.has(entry.name)) {
        const bool counted = entry.name.starts_with("steps_") || entry.name.starts_with("energy_") ||
                             entry.name.ends_with("hits") || entry.name.ends_with("misses") ||
                             entry.name.ends_with("accesses") || entry.name.ends_with("_busy");
        for (std::size_t row = 0; counted && row < seen.table.rows().size(); ++row) {
          EXPECT_GE(std::get<std::int64_t>(seen.table.at(row, entry.name)), 0) << seed << " " << entry.name;
        }
        EXPECT_TRUE(seen.all(entry.name) == whole[i]) << "seed " << seed << ", " << entry.name;
      }
    }
    EXPECT_EQ(seen.table.rows().size(), static_cast<std::size_t>((plain->end + length - 1) / length));
    for (const char* name :
         {"steps_tests", "steps_branches", "misses", "hits", "bank_accesses", "energy_total"}) {
      EXPECT_TRUE(figures::count_of(whole, name).value_or(0) == 0 || seen.has(name))
          << "seed " << seed << ", " << name;
    }
    powers += seen.has("power") ? 1 : 0;
    for (const processors::cost::Activity activity :
         {processors::cost::Activity::idle, processors::cost::Activity::dispatch_wait,
          processors::cost::Activity::message_wait, processors::cost::Activity::queue_full_wait,
          processors::cost::Activity::lock_wait}) {
      const std::string name(processors::cost::activity_names[static_cast<std::size_t>(activity)]);
      const sim::Sum time = seen.result.time()[static_cast<std::size_t>(activity)];
      EXPECT_TRUE(time == (seen.has("spent_" + name) ? seen.all("spent_" + name) : 0))
          << "seed " << seed << ", " << name;
    }
  }
  EXPECT_GT(machines, 100U);
  EXPECT_GT(powers, 10U);
}

// Counts the packets that begin in each interval.
class PacketsBegun final : public processors::walk::Observer {
 public:
  explicit PacketsBegun(sim::Ticks length) : length_(length) {}
  void spent(std::uint32_t /*node*/, processors::walk::NodeState /*state*/, sim::Ticks /*from*/,
             sim::Ticks /*to*/, processors::walk::PixelPlace /*pixel*/) override {}
  void began_packet(std::uint32_t /*node*/, std::uint64_t /*packet*/, sim::Ticks start) override {
    ++begun[start / length_];
  }
  std::map<std::int64_t, std::int64_t> begun;

 private:
  sim::Ticks length_;
};

// What happens at a known time is counted in its interval, and leakage is the same at all times.
TEST(Intervals, CountWhatHappensInThem) {
  std::size_t packets = 0;
  for (std::uint64_t seed = 3; seed <= 300; seed += 5) {
    Machine machine = machine_of(seed);
    machine.config.contexts = 1;
    machine.config.host.clock = sim::Clock::from_period(1);  // else grants begin at its cycles
    machine.config.host.latency_cycles = 0;
    machine.config.host.occupancy_cycles = 0;
    std::optional<Observed> seen;
    PacketsBegun begun(2000);
    try {
      seen = observed(machine, 2000, &begun);
    } catch (const sim::UserError&) {
      continue;
    }
    const tables::Table& table = seen->table;
    for (std::size_t row = 0; row < table.rows().size(); ++row) {
      const auto value = [&](const char* name) {
        return seen->has(name) ? std::get<std::int64_t>(table.at(row, name)) : 0;
      };
      EXPECT_EQ(value("node_packets"), begun.begun[static_cast<std::int64_t>(row)]) << "seed " << seed;
      packets += static_cast<std::size_t>(value("node_packets"));
      if (row + 1 < table.rows().size() && seen->has("energy_leakage")) {
        EXPECT_NEAR(static_cast<double>(value("energy_leakage")),
                    static_cast<double>(std::get<std::int64_t>(table.at(0, "energy_leakage"))), 1.0);
      }
    }
  }
  EXPECT_GT(packets, 200U);
}

TEST(Intervals, AreAThousandAtMost) {
  Machine machine = machine_of(3);
  const sim::Ticks end = processors::replay::replay(machine.log, machine.config).end;
  ASSERT_GT(end, 2000);
  const auto most = static_cast<sim::Ticks>(most_intervals);
  EXPECT_EQ(observed(machine, (end + most - 1) / most).table.rows().size(),
            (end - 1) / ((end + most - 1) / most) + 1);
  EXPECT_THROW((void)observed(machine, (end - 1) / most), sim::KeyError);
  EXPECT_THROW((void)observed(machine, 1), sim::KeyError);
}

}  // namespace
}  // namespace marti::studies::run
