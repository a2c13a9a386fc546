// A row holds the counts of its machine.
#include "studies/sweep/plan/sweep_row.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "processors/replay/bounds.h"
#include "processors/replay/replay.h"
#include "sim/error.h"
#include "studies/figures/derived_figures.h"
#include "tests/support/random_flow.h"
#include "tests/support/random_machine.h"
#include "tests/unit/studies/sweep_parts.h"

namespace marti::studies {

using namespace figures;
using namespace sweep;

namespace {

using processors::machine::MachineConfig;
using processors::replay::MachineResult;

std::map<std::string, std::optional<Count>> named(const SweepRow& row) {
  std::map<std::string, std::optional<Count>> values;
  for (std::size_t i = 0; i < row.counters.size(); ++i) {
    values[counted_figures()[i].name] = row.counters[i];
  }
  return values;
}

std::int64_t waits_in(const SweepRow& row, std::string_view what) {
  std::int64_t count = 0;
  const std::string& text = row.histograms.at(
      static_cast<std::size_t>(std::ranges::find(histogram_names, what) - histogram_names.begin()));
  for (const auto& bucket : nlohmann::json::parse(text.empty() ? "[]" : text)) {
    count += bucket.at(2).get<std::int64_t>();
  }
  return count;
}

// A random machine of any scheme, with everything that can be asked of it.
MachineConfig any_machine(test::Random& random) {
  MachineConfig machine = test::random_machine(random);
  test::add_random_second_level(random, machine);
  const std::int64_t scheme = test::pick(random, 0, 5);
  if (scheme == 0) {
    machine.l2 = {};
    test::make_random_pipeline(random, machine);
  } else if (scheme == 1) {
    machine.l2 = {};
    test::make_random_space(random, machine);
  } else if (scheme == 2 && machine.placement == processors::machine::Placement::shared &&
             machine.interconnect.arbitration == memory::Arbitration::fifo) {
    machine.build = test::random_build(random);
  }
  return machine;
}

RC_GTEST_PROP(SweepRows, HoldTheSumsOfTheirMachine, (std::uint64_t seed)) {
  test::Random random(seed);
  const processors::program::WorkLog log = test::random_tree_log(random, 7, 5);
  const MachineConfig machine = any_machine(random);
  const MachineResult result = processors::replay::replay(log, machine);
  const SweepRow row = sweep_row(machine, result);
  RC_ASSERT(row.counters.size() == counted_figures().size());
  auto values = named(row);
  const auto value = [&](const std::string& name) { return sim::ticks_of(values.at(name).value_or(-1)); };

  RC_ASSERT(value("end") == result.end);
  RC_ASSERT(value("nodes") == static_cast<std::int64_t>(result.nodes.size()));
  std::int64_t time = 0;
  for (const std::string_view activity : processors::cost::activity_names) {
    time += value("time_" + std::string(activity));
  }
  RC_ASSERT(time == result.end * value("nodes"));
  std::int64_t hits = 0;
  std::int64_t misses = 0;
  std::int64_t finish = 0;
  for (const processors::cost::NodeStatistics& node : result.nodes) {
    hits += node.references.all_hits();
    misses += node.references.all_misses();
    finish += node.finish;
  }
  RC_ASSERT(value("hits") == hits);
  RC_ASSERT(value("misses") == misses);
  RC_ASSERT(value("node_finish") == finish);
  RC_ASSERT(value("earliest_finish") * value("nodes") <= finish);
  RC_ASSERT(value("latest_finish") * value("nodes") >= finish);
  for (const std::string_view kind : memory::record_kind_names) {
    hits -= value(std::string(kind) + "_hits");
    misses -= value(std::string(kind) + "_misses");
  }
  RC_ASSERT(hits == 0);
  RC_ASSERT(misses == 0);
  std::int64_t tests = 0;
  for (const processors::cost::NodeStatistics& node : result.nodes) {
    tests += node.steps.tests;
  }
  RC_ASSERT(value("steps_tests") == tests);
}

// Of one bus the saturation is that of the closed network by which a frame time is predicted.
RC_GTEST_PROP(SweepRows, SaturateWhereTheNetworkDoes, (std::uint64_t seed)) {
  test::Random random(seed);
  const processors::program::WorkLog log = test::random_tree_log(random, 7, 5);
  MachineConfig machine = any_machine(random);
  machine.clusters = 1;
  machine.interconnect.kind = memory::InterconnectKind::bus;
  const MachineResult result = processors::replay::replay(log, machine);
  const auto prediction = processors::replay::predict(machine, result);
  if (!prediction || machine.placement != processors::machine::Placement::shared) {
    RC_DISCARD("no network");
  }
  const auto saturation = figure_of(machine, result, "saturation");
  RC_ASSERT(saturation.has_value() == prediction->network.saturation().has_value());
  if (saturation) {
    RC_ASSERT(std::abs(*saturation / *prediction->network.saturation() - 1.0) < 1e-9);
  }
}

RC_GTEST_PROP(SweepRows, HoldTheSumsOfTheMemory, (std::uint64_t seed)) {
  test::Random random(seed);
  const processors::program::WorkLog log = test::random_tree_log(random, 7, 5);
  const MachineConfig machine = any_machine(random);
  const MachineResult result = processors::replay::replay(log, machine);
  const SweepRow row = sweep_row(machine, result);
  auto values = named(row);
  std::int64_t reads = 0;
  sim::Sum waits = 0;
  std::int64_t longest = 0;
  std::int64_t count = 0;
  std::int64_t banks = 0;
  std::int64_t bank_waits = 0;
  std::int64_t busiest = 0;
  std::int64_t networks = 0;
  std::int64_t bytes = 0;
  for (const processors::replay::ClusterResult& cluster : result.clusters) {
    reads += cluster.interconnect.reads;
    waits += cluster.interconnect.waits.sum;
    count += cluster.interconnect.waits.count;
    longest = std::max(longest, cluster.interconnect.waits.max);
    for (const memory::BankStatistics& bank : cluster.banks) {
      ++banks;
      bank_waits += bank.waits.count;
      busiest = std::max(busiest, bank.busy);
    }
    if (cluster.distributed) {
      ++networks;
      bytes += cluster.distributed->network.bytes;
    }
  }
  for (const memory::NetworkStatistics& network : result.flow.networks) {
    ++networks;
    bytes += network.bytes;
  }
  RC_ASSERT(values.at("interconnect_reads") == reads);
  RC_ASSERT(values.at("interconnect_wait_sum") == waits);
  RC_ASSERT(values.at("interconnect_wait_max") == longest);
  RC_ASSERT(values.at("interconnect_wait_count") == count);
  RC_ASSERT(waits_in(row, "interconnect_wait") == count);
  RC_ASSERT(values.at("banks") == (banks == 0 ? std::nullopt : std::optional(banks)));
  RC_ASSERT(values.at("most_bank_busy") == (banks == 0 ? std::nullopt : std::optional(busiest)));
  RC_ASSERT(waits_in(row, "bank_wait") == bank_waits);
  RC_ASSERT(values.at("bound").value() <= result.end);
  for (const std::string queue : {"interconnect", "bank", "network", "l2"}) {
    std::optional<Count> before;
    for (const std::string what : {"p50", "p95", "p99", "max"}) {
      const std::optional<Count> wait = values.at(queue + "_wait_" + what);
      RC_ASSERT((!before || *before <= wait.value()));
      before = wait;
    }
  }
  RC_ASSERT(values.at("network_bytes") == (networks == 0 ? std::nullopt : std::optional(bytes)));
  RC_ASSERT(waits_in(row, "network_wait") == values.at("network_wait_count").value_or(0));
  RC_ASSERT(waits_in(row, "l2_wait") == values.at("l2_wait_count").value_or(0));
  // Counters of a part that the machine lacks have no values; those of a part that it has all have one.
  const auto there = [&](std::string_view prefix, bool expected) {
    for (const auto& [name, value] : values) {
      if (name.starts_with(prefix) && !name.starts_with("l2_wait_")) {
        RC_ASSERT(value.has_value() == expected);
      }
    }
  };
  there("build_", result.build.sharing != processors::machine::Sharing::given);
  there("tree_", result.build.sharing != processors::machine::Sharing::given);
  there("l2_", !result.l2.caches.empty());
  there("contexts_", !result.contexts.nodes.empty());
  there("sharing_", false);
  there("camera_ray_", false);
  there("split_", false);
  RC_ASSERT(values.at("flow_taken").has_value() == !result.flow.nodes.empty());
}

// The counts of a machine that counts everything add up to its misses.
void expect_counts_that_add_up(const processors::program::WorkLog& log, const MachineConfig& machine) {
  const MachineResult result = processors::replay::replay(log, machine);
  auto values = named(sweep_row(machine, result));
  figures::Count classed = 0;
  for (const std::string_view name : memory::miss_class_names) {
    classed += values.at("all_misses_" + std::string(name)).value_or(0);
  }
  EXPECT_EQ(classed, values.at("misses"));
  EXPECT_EQ(values.at("sharing_fetches"), values.at("misses"));
  figures::Count attributed = 0;
  for (const std::string_view ray : processors::program::ray_kind_names) {
    attributed += values.at(std::string(ray) + "_ray_misses").value_or(0);
  }
  const figures::Count split = values.at("split_misses").value_or(-1);
  EXPECT_EQ(split > 0, machine.build.sharing != processors::machine::Sharing::given);
  attributed += split;
  EXPECT_EQ(attributed, values.at("misses"));
}

TEST(SweepRows, WhatIsCountedOnlyWhenAskedIsThere) {
  test::Random random(11);
  const processors::program::WorkLog log = test::random_tree_log(random, 9, 9);
  MachineConfig machine;
  machine.nodes = 3;
  machine.count = {true, true, true};
  for (const processors::machine::Sharing sharing :
       {processors::machine::Sharing::given, processors::machine::Sharing::shared}) {
    machine.build.sharing = sharing;
    expect_counts_that_add_up(log, machine);
  }
}

}  // namespace
}  // namespace marti::studies
