// The energy of a frame: closed forms by hand, caches against those that CACTI was asked for, laws of
// random machines against their own counters, and what is refused.
#include "processors/energy/energy.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "memory/dram_presets.h"
#include "processors/cost/build_mix.h"
#include "processors/cost/operation_mix.h"
#include "processors/energy/cacti_rows.h"
#include "processors/energy/dram_energy.h"
#include "processors/energy/energy_presets.h"
#include "processors/replay/energy_counts.h"
#include "processors/replay/replay.h"
#include "tests/support/random_flow.h"
#include "tests/support/random_machine.h"
#include "tests/support/user_error.h"

namespace marti::processors {

using namespace cost;
using namespace energy;
using namespace machine;
using namespace program;
using namespace replay;

namespace {

constexpr std::int64_t fj_a_pj = 1000;

// A machine of one node without figures: whatever a test sets is all that takes energy.
MachineConfig without_figures() {
  MachineConfig machine;
  machine.nodes = 1;
  machine.energy.preset = EnergyPreset::nm45;
  machine.energy.figures.l1 = machine.energy.figures.l2 = {0.0, 0.0, 0.0};
  return machine;
}

std::int64_t sum_of_parts(const EnergyResult& energy) {
  return energy.operations + energy.unit + energy.l1 + energy.l2 + energy.interconnect + energy.memory +
         energy.leakage;
}

TEST(Energy, OfSplitCachesIsThatOfEach) {
  MachineConfig machine = without_figures();
  machine.cache.organisation = CacheOrganisation::split;
  machine.energy.figures.l1 = {by_shape, by_shape, by_shape};
  EnergyCounts counts;
  for (std::size_t i = 0; i < split_caches; ++i) {
    counts.l1.at(i) = {static_cast<std::int64_t>(1000 * i), 10};
  }
  double expected = 0.0;
  double area = 0.0;
  for (std::size_t i = 0; i < split_caches; ++i) {
    memory::CacheConfig cache = machine.cache.cache;
    cache.size = machine.cache.split_sizes.at(i);
    const CacheFigures figures = known_cache(EnergyPreset::nm45, cache).value();
    expected += (static_cast<double>(1000 * i + 10) * figures.read + 10.0 * figures.write) * fj_a_pj;
    area += figures.area * 1e6;
  }
  const EnergyResult energy = energy_of(machine, counts);
  EXPECT_NEAR(static_cast<double>(energy.l1), expected, 5.0);
  EXPECT_NEAR(static_cast<double>(energy.area), area, 4.0);
}

TEST(Energy, OfBytesIsThatOfTheirBitsAndWay) {
  MachineConfig machine = without_figures();
  machine.energy.figures.wire = 0.5;
  machine.energy.figures.interconnect_length = 2.0;
  machine.energy.figures.hop_length = 0.25;
  EnergyCounts counts;
  counts.interconnect_bytes = 100;
  counts.hop_bytes = 40;
  const EnergyResult energy = energy_of(machine, counts);
  EXPECT_EQ(energy.interconnect, (100 * 8 + 40) * fj_a_pj);  // 1 pJ a bit, 1 pJ a byte
  EXPECT_EQ(energy.total, energy.interconnect);
}

TEST(Energy, OfMemoryIsThatOfItsAccessesAndTheirLines) {
  MachineConfig machine = without_figures();
  machine.cache.cache.line = 64;
  machine.energy.figures.memory_access = 100.0;
  machine.energy.figures.memory_read = 2.0;
  machine.energy.figures.memory_write = 1.0;
  EnergyCounts counts;
  counts.memory_reads = 3;
  counts.memory_writes = 5;
  const EnergyResult energy = energy_of(machine, counts);
  EXPECT_EQ(energy.memory, (3 * (100 + 64 * 2) + 5 * (100 + 64)) * fj_a_pj);
  EXPECT_EQ(energy.total, energy.memory);
}

// 1 W for 1 ps is 1 pJ; the machine has 2 clusters of 3 nodes with 2 contexts.
TEST(Energy, OfAMachineThatDoesNothingIsLeakage) {
  MachineConfig machine = without_figures();
  machine.clusters = 2;
  machine.nodes = 3;
  machine.contexts = 2;
  machine.l2.sharing = SecondLevel::shared;
  EnergyFigures& figures = machine.energy.figures;
  figures.add = figures.load = figures.wire = figures.memory_access = 5.0;  // of nothing
  figures.node_area = 0.5;
  figures.context_area = 0.125;
  figures.l1.area = 0.25;
  figures.l2.area = 1.5;
  figures.leakage_density = 1000.0;
  EnergyCounts counts;
  counts.end = 7;
  const EnergyResult energy = energy_of(machine, counts);
  EXPECT_EQ(energy.area, 6 * 875'000 + 2 * 1'500'000);
  EXPECT_EQ(energy.leakage, 7 * 8250);  // 8.25 W
  EXPECT_EQ(energy.total, energy.leakage);
  machine.l2.sharing = SecondLevel::private_caches;
  EXPECT_EQ(energy_of(machine, counts).area, 6 * (875'000 + 1'500'000));
}

std::int64_t thousandths(const OperationMix& mix) {
  return mix.add + mix.multiply + mix.divide + mix.square_root + mix.compare + mix.integer;
}

// With 1 pJ for every operation a step takes as many pJ as it has operations.
TEST(Energy, OfOperationsIsThatOfTheMixesAndOfTheWordsMoved) {
  MachineConfig machine = without_figures();
  EnergyFigures& figures = machine.energy.figures;
  figures.add = figures.multiply = figures.divide = figures.square_root = figures.compare = figures.integer =
      figures.load = figures.store = 0.25;
  figures.instruction = 0.75;
  for (std::size_t at = 0; at < accel::traversals; ++at) {
    const auto traversal = static_cast<accel::Traversal>(at);
    const OperationMixes& mixes = operation_mixes(traversal);
    EnergyCounts counts;
    counts.traversal = traversal;
    counts.steps.camera_rays = 2;
    counts.steps.branches = 5;
    counts.steps.tests = 11;
    counts.steps.sphere_tests = 3;
    counts.steps.cone_tests = 1;
    counts.steps.lights = 4;
    counts.steps.pixels = 6;
    // Beside the mixes: an address and the words of 8 bytes of a node; an entry and its address, a triangle
    // of 48 bytes or a quadric of 40 and its address; an address and the word of a pixel.
    const std::int64_t expected = 2 * thousandths(mixes.ray[0]) + 5 * (thousandths(mixes.branch) + 3000) +
                                  7 * (thousandths(mixes.test) + 2000 + 13000) +
                                  3 * (thousandths(mixes.sphere_test) + 2000 + 11000) +
                                  (thousandths(mixes.cone_test) + 2000 + 11000) +
                                  4 * thousandths(mixes.light) + 6 * (thousandths(mixes.pixel) + 2000);
    EXPECT_EQ(energy_of(machine, counts).operations, expected);
  }
  EnergyCounts built;
  built.build.locks = 2;
  built.build.listed = 3;
  built.build.overlaps = 5;
  built.build.entries = 7;
  EXPECT_EQ(energy_of(machine, built).operations, 2 * 3000 +
                                                      3 * (thousandths(build_mixes().listed) + 2000 + 13000) +
                                                      5 * thousandths(build_mixes().overlap) + 7 * 2000);
}

// As before, but the unit's operations have no instruction, and each test reads and writes its ray.
TEST(Energy, OfAUnitIsThatOfItsTestsAndOfTheRaysThatItHolds) {
  MachineConfig machine = without_figures();
  machine.kind = NodeKind::simt;
  EnergyFigures& figures = machine.energy.figures;
  figures.add = figures.multiply = figures.divide = figures.square_root = figures.compare = figures.integer =
      figures.load = figures.store = 0.25;
  figures.instruction = 0.75;
  figures.rt = {2.0, 3.0, 0.5};
  EnergyCounts counts;
  counts.traversal = accel::Traversal::bvh_six;
  counts.steps.camera_rays = 2;
  counts.steps.branches = 5;
  counts.steps.leaves = 4;
  counts.steps.tests = 7;
  const OperationMixes& mixes = operation_mixes(counts.traversal);
  const std::int64_t tests =
      5 * (thousandths(mixes.branch) + 3000) + 7 * (thousandths(mixes.test) + 2000 + 13000);
  const EnergyResult energy = energy_of(machine, counts);
  EXPECT_EQ(energy.operations, 2 * thousandths(mixes.ray[0]));
  EXPECT_NEAR(static_cast<double>(energy.unit), static_cast<double>(tests) / 4.0 + 12 * 5 * fj_a_pj, 2.0);
  EXPECT_EQ(energy.total, sum_of_parts(energy));
  figures.rt_operation = 0.75;
  EXPECT_EQ(energy_of(machine, counts).unit, tests + 12 * 5 * fj_a_pj);
  machine.rt.warps = 0;
  EXPECT_EQ(energy_of(machine, counts).unit, 0);
  EXPECT_EQ(energy_of(machine, counts).operations, 2 * thousandths(mixes.ray[0]) + tests);
}

// 3 nodes of 4 warps of 8 lanes, two of which compute at once.
TEST(Energy, AreaOfASimtNodeIsThatOfItsLanesAndItsUnit) {
  MachineConfig machine = without_figures();
  machine.nodes = 3;
  machine.kind = NodeKind::simt;
  machine.simt.lanes = 8;
  machine.simt.warps = 4;
  machine.simt.issue = 2;
  machine.rt.warps = 3;
  machine.rt.box_cycles = 7;
  machine.rt.triangle_units = 5;
  EnergyFigures& figures = machine.energy.figures;
  figures.node_area = 1.0;
  figures.context_area = 0.5;
  figures.l1.area = 0.25;
  figures.rt = {0.0, 0.0, 2.0};
  figures.rt_box_area = 0.125;
  figures.rt_triangle_area = 0.0625;
  const EnergyResult energy = energy_of(machine, {});
  const std::int64_t unit = 2'000'000 + 4 * 125'000 + 5 * 62'500;  // 24 lanes of 7 cycles need 4 units
  EXPECT_EQ(energy.unit_area, 3 * unit);
  EXPECT_EQ(energy.cache_area, 3 * 250'000);
  EXPECT_EQ(energy.area, 3 * (16'000'000 + 16 * 500'000 + 250'000 + unit));
  // Without a figure it is that of an adder, a multiplier, ... for each operation: of SimTRaX, at 45 nm.
  figures.rt_triangle_area = by_shape;
  const OperationMix& test = operation_mixes(accel::Traversal::octree).test;
  const double one = (0.003 * static_cast<double>(test.add) + 0.0165 * static_cast<double>(test.multiply) +
                      0.112 * static_cast<double>(test.divide + test.square_root) +
                      0.00066 * static_cast<double>(test.compare + test.integer)) *
                     1000.0 * 45.0 * 45.0 / (65.0 * 65.0);
  EXPECT_NEAR(static_cast<double>(energy_of(machine, {}).unit_area - 3 * (2'000'000 + 4 * 125'000)),
              15.0 * one, 15.0);
  machine.rt.warps = 0;
  EXPECT_EQ(energy_of(machine, {}).unit_area, 0);
}

TEST(Energy, OfWhatSwitchesGrowsWithTheSquareOfTheVoltage) {
  marti::test::Random random(3);
  MachineConfig machine = without_figures();
  machine.energy.figures = energy_figures(EnergyPreset::nm45);
  machine.energy.figures.l1 = {20.0, 30.0, 0.5};
  // Whole pJ, so that nothing is rounded.
  machine.energy.figures.add = machine.energy.figures.multiply = machine.energy.figures.divide =
      machine.energy.figures.square_root = machine.energy.figures.compare = machine.energy.figures.integer =
          machine.energy.figures.load = machine.energy.figures.store = 2.0;
  machine.energy.figures.wire = 0.125;
  EnergyCounts counts;
  counts.steps.branches = marti::test::pick(random, 1, 1'000'000);
  counts.steps.tests = marti::test::pick(random, 1, 1'000'000);
  counts.l1[0] = {marti::test::pick(random, 1, 1'000'000), 1000};
  counts.interconnect_bytes = marti::test::pick(random, 1, 1'000'000);
  counts.memory_reads = 1000;
  counts.end = 1'000'000;
  const EnergyResult nominal = energy_of(machine, counts);
  for (const double voltage : {2.0, 0.5, 3.0}) {
    machine.energy.voltage = voltage;
    const EnergyResult energy = energy_of(machine, counts);
    const auto scaled = [&](std::int64_t value) { return static_cast<double>(value) * voltage * voltage; };
    EXPECT_NEAR(static_cast<double>(energy.operations), scaled(nominal.operations), 1.0);
    EXPECT_NEAR(static_cast<double>(energy.l1), scaled(nominal.l1), 1.0);
    EXPECT_NEAR(static_cast<double>(energy.interconnect), scaled(nominal.interconnect), 1.0);
    EXPECT_EQ(energy.memory, nominal.memory);
    EXPECT_EQ(energy.leakage, nominal.leakage);
    EXPECT_EQ(energy.area, nominal.area);
  }
}

// What CACTI gives (the commit that cacti_rows.h names, its settings): nJ to read and write, mm2.
struct CactiCache {
  EnergyPreset preset;
  std::uint64_t kib;
  std::uint32_t ways;
  std::uint32_t line;
  double read;
  double write;
  double area;
};
constexpr std::array<CactiCache, 12> cacti = {{
    {EnergyPreset::nm45, 2, 1, 32, 0.00773526, 0.0113961, 0.0146363},
    {EnergyPreset::nm45, 16, 4, 32, 0.0327603, 0.0359903, 0.0828651},
    {EnergyPreset::nm45, 16, 8, 64, 0.176, 0.159656, 0.263598},
    {EnergyPreset::nm45, 64, 4, 64, 0.107252, 0.114459, 0.292468},
    {EnergyPreset::nm45, 256, 8, 32, 0.121359, 0.121632, 1.07621},
    {EnergyPreset::nm45, 4096, 8, 64, 0.726056, 0.815454, 19.5093},
    {EnergyPreset::nm22, 2, 1, 32, 0.00208212, 0.00293317, 0.00371772},
    {EnergyPreset::nm22, 16, 4, 32, 0.00900725, 0.00970511, 0.019987},
    {EnergyPreset::nm22, 16, 8, 64, 0.0640797, 0.0631724, 0.154346},
    {EnergyPreset::nm22, 64, 4, 64, 0.0315224, 0.0315571, 0.0748437},
    {EnergyPreset::nm22, 256, 8, 32, 0.0310475, 0.0286776, 0.311764},
    {EnergyPreset::nm22, 4096, 8, 64, 0.219735, 0.229389, 4.51033},
}};

TEST(KnownCaches, AreThoseOfCacti) {
  for (const CactiCache& known : cacti) {
    const memory::CacheConfig cache = {.size = known.kib * 1024, .line = known.line, .ways = known.ways};
    const CacheFigures figures = known_cache(known.preset, cache).value();
    EXPECT_NEAR(figures.read, known.read * 1e3, 1e-5 * known.read * 1e3) << known.kib;
    EXPECT_NEAR(figures.write, known.write * 1e3, 1e-5 * known.write * 1e3) << known.kib;
    EXPECT_NEAR(figures.area, known.area, 1e-5 * known.area) << known.kib;
  }
}

// Each cache whose neighbours of half and twice the size are known too is left out and found from these: the
// errors that energy_presets.h states.
TEST(KnownCaches, OfSizesBetweenAreWithinTheStatedErrors) {
  struct Error {
    double CactiRow::*figure;
    double mean;
    double largest;
  };
  for (const Error& stated : {Error{&CactiRow::read, 0.06, 0.44}, Error{&CactiRow::write, 0.09, 0.35},
                              Error{&CactiRow::area, 0.12, 0.50}}) {
    for (const std::uint32_t line : {32U, 64U, 128U}) {
      double sum = 0.0;
      double largest = 0.0;
      int count = 0;
      for (const auto rows : {cacti_rows_45nm(), cacti_rows_22nm()}) {
        for (std::size_t i = 1; i + 1 < rows.size(); ++i) {
          const bool between = rows[i].line == line && rows[i - 1].ways == rows[i].ways &&
                               rows[i + 1].ways == rows[i].ways && rows[i - 1].line == line &&
                               rows[i + 1].line == line && rows[i - 1].size * 2 == rows[i].size &&
                               rows[i].size * 2 == rows[i + 1].size;
          if (between) {
            const double found = std::sqrt(rows[i - 1].*stated.figure * rows[i + 1].*stated.figure);
            const double error = std::abs(found / (rows[i].*stated.figure) - 1.0);
            sum += error;
            largest = std::max(largest, error);
            ++count;
          }
        }
      }
      EXPECT_GT(count, 50);
      EXPECT_LT(sum / count, stated.mean) << line;
      EXPECT_LT(largest, stated.largest) << line;
    }
  }
}

// Between two known caches lie those of sizes and ways between them, and of more ways than any has are as the
// last.
TEST(KnownCaches, LieBetweenTheirNeighbours) {
  for (const EnergyPreset preset : {EnergyPreset::nm45, EnergyPreset::nm22}) {
    for (const KnownCaches& known : known_caches) {
      memory::CacheConfig cache = {.size = std::uint64_t{256} * 1024, .line = known.line, .ways = 4};
      const auto read = [&](std::uint64_t kib, std::uint32_t ways) {
        cache.size = kib * 1024;
        cache.ways = ways;
        return known_cache(preset, cache).value().read;
      };
      EXPECT_LT(read(256, 4), read(512, 4));
      EXPECT_NEAR(std::log(read(384, 4)) - std::log(read(256, 4)),
                  std::log(1.5) / std::log(2.0) * (std::log(read(512, 4)) - std::log(read(256, 4))), 1e-12);
      EXPECT_NEAR(std::log(read(256, 3)) - std::log(read(256, 2)),
                  std::log(1.5) / std::log(2.0) * (std::log(read(256, 4)) - std::log(read(256, 2))), 1e-12);
      EXPECT_EQ(read(256, known.line == 128 ? 32 : 8), read(256, 64));
      EXPECT_EQ(read(256, 64), read(256, memory::full_ways));
      for (const std::uint64_t size : {known.least_size, known.most_size}) {
        EXPECT_GT(read(size / 1024, 32), 0.0);
      }
    }
  }
}

// Every memory has figures of its own, and says where they are from.
TEST(DramEnergy, OfEachPresetIsItsOwnAndHasASource) {
  for (std::size_t i = 0; i < memory::dram_preset_names.size(); ++i) {
    const DramEnergy& energy = dram_energy(i);
    EXPECT_FALSE(energy.source.empty());
    EXPECT_GT(energy.activation, 0.0);
    EXPECT_GT(energy.write, 0.0);
    EXPECT_GE(energy.read, energy.write);
    for (std::size_t j = 0; j < i; ++j) {
      const bool same_dies =
          memory::dram_preset_names.at(i).substr(0, 9) == memory::dram_preset_names.at(j).substr(0, 9) &&
          memory::dram_preset_names.at(i).starts_with("hbm3");
      EXPECT_TRUE(same_dies || energy.read != dram_energy(j).read) << i << " " << j;
    }
  }
}

TEST(KnownCaches, OthersAreRefused) {
  MachineConfig machine = without_figures();
  machine.energy.figures.l1 = {};
  const auto refusal = [&machine] { return marti::test::user_error_of([&] { check_energy(machine); }); };
  EXPECT_EQ(refusal(), "no UserError");
  machine.cache.cache.size = 1024;
  EXPECT_EQ(
      refusal(),
      "cache.size: the energy of a cache of 1 KiB with lines of 32 bytes is not known: it is of caches with "
      "lines of 32 bytes of 2 KiB to 4 MiB, 64 bytes of 2 KiB to 4 MiB, 128 bytes of 8 KiB to 8 MiB; give "
      "energy.l1_read, energy.l1_write and energy.l1_area");
  machine.cache.cache.line = 16;
  EXPECT_TRUE(refusal().starts_with("cache.line: the energy of a cache of 1 KiB with lines of 16 bytes"));
  machine.cache.cache.line = 32;
  machine.energy.figures.l1 = {1.0, 1.0, by_shape};
  EXPECT_NE(refusal(), "no UserError");
  machine.energy.figures.l1.area = 0.0;
  EXPECT_EQ(refusal(), "no UserError");
  machine.l2.sharing = SecondLevel::private_caches;
  machine.l2.cache.size = std::uint64_t{8} * 1024 * 1024;
  machine.energy.figures.l2 = {};
  EXPECT_TRUE(refusal().starts_with("l2.size: the energy of a cache of 8 MiB"));
  machine.l2.sharing = SecondLevel::shared;
  machine.cache.organisation = CacheOrganisation::none;
  machine.banks.interleave = 256;
  EXPECT_TRUE(refusal().starts_with("memory.interleave: the energy of a cache of 8 MiB with lines of 256"));
  machine.l2.sharing = SecondLevel::none;
  machine.cache.organisation = CacheOrganisation::split;
  machine.cache.split_sizes[2] = 512;
  machine.energy.figures.l1 = {};
  EXPECT_TRUE(refusal().starts_with("cache.primitive_size: "));
}

TEST(Energy, RefusesFiguresOutOfRange) {
  const auto refusal = [](const auto& change) {
    MachineConfig machine = without_figures();
    change(machine.energy);
    return marti::test::user_error_of([&] { check_energy(machine); });
  };
  EXPECT_EQ(refusal([](EnergyConfig& e) { e.figures.add = -1.0; }), "energy.add: must be from 0 to 1e+05");
  EXPECT_TRUE(refusal([](EnergyConfig& e) { e.figures.wire = std::nan(""); }).starts_with("energy.wire"));
  EXPECT_TRUE(refusal([](EnergyConfig& e) {
                e.figures.leakage_density = std::numeric_limits<double>::infinity();
              }).starts_with("energy.leakage_density"));
  EXPECT_TRUE(refusal([](EnergyConfig& e) { e.voltage = 11.0; }).starts_with("energy.voltage"));
}

// 65,536 nodes of the preset, for as long as 64 bits of fJ hold, and a little longer.
TEST(Energy, ThatDoesNotFitIsRefused) {
  MachineConfig machine;
  machine.nodes = 65536;
  machine.energy.preset = EnergyPreset::nm45;
  machine.energy.figures = energy_figures(EnergyPreset::nm45);
  EnergyCounts counts;
  counts.end = 1'000'000'000'000;  // 1 s
  const std::int64_t second = energy_of(machine, counts).leakage;
  counts.end *= std::numeric_limits<std::int64_t>::max() / second;
  EXPECT_GT(energy_of(machine, counts).leakage, std::numeric_limits<std::int64_t>::max() / 2);
  counts.end *= 2;
  const std::string refusal = marti::test::user_error_of([&] { (void)energy_of(machine, counts); });
  EXPECT_TRUE(refusal.starts_with("energy.preset: the energy of leakage does not fit 64 bits")) << refusal;
  // Parts that fit one by one, but not together.
  machine.energy.figures.memory_access = 1e9;
  counts.end /= 2;
  counts.memory_reads = std::numeric_limits<std::int64_t>::max() / 2 / 1'000'000'000'000;
  EXPECT_TRUE(marti::test::user_error_of([&] {
                (void)energy_of(machine, counts);
              }).starts_with("energy.preset: the energy of the frame"));
  counts.memory_reads = std::numeric_limits<std::int64_t>::max();
  EXPECT_TRUE(marti::test::user_error_of([&] {
                (void)energy_of(machine, counts);
              }).starts_with("energy.preset: the energy of memory"));
}

// A log and a machine of any scheme that walks it, with any second level, contexts and building.
struct EnergyCase {
  WorkLog log;
  MachineConfig machine;
};

EnergyCase random_energy_case(marti::test::Random& random) {
  EnergyCase one{marti::test::random_tree_log(random, 9, 7), marti::test::random_machine(random)};
  switch (marti::test::pick(random, 0, 4)) {
    case 0:
      marti::test::add_random_contexts(random, false, one.machine);
      break;
    case 1:
      marti::test::add_random_build(random, one.machine);
      break;
    case 2:
      one.log = marti::test::random_ray_trees(random, 6, 5, 6, 3);
      marti::test::make_random_pipeline(random, one.machine);
      break;
    case 3:
      one.log = marti::test::random_ray_trees(random, 6, 5, 6, 3);
      marti::test::make_random_space(random, one.machine);
      break;
    default:
      marti::test::add_random_second_level(random, one.machine);
  }
  marti::test::add_random_dram(random, one.machine);
  return one;
}

// The reads and writes of all memories, or of DRAM the rows it has opened, found another way than
// energy_counts() does: by the banks, or by what an ideal interconnect and the nodes' own memories were asked
// for.
std::int64_t accesses_of(const MachineConfig& machine, const MachineResult& result) {
  std::int64_t accesses = 0;
  for (const ClusterResult& cluster : result.clusters) {
    for (const memory::BankStatistics& bank : cluster.banks) {
      accesses += cluster.dram.empty() ? bank.accesses : 0;
    }
    for (const memory::DramStatistics& channel : cluster.dram) {
      accesses += channel.activations;
    }
    if (cluster.banks.empty()) {
      accesses += cluster.interconnect.reads + cluster.interconnect.writes;
    }
  }
  const bool second = machine.l2.sharing == SecondLevel::private_caches;
  std::int64_t misses = 0;
  for (std::size_t node = 0; node < result.nodes.size(); ++node) {
    misses += second ? result.l2.caches[node].misses : result.nodes[node].references.all_misses();
  }
  const bool own = machine.placement == Placement::replicated || machine.scheme == Scheme::space;
  return accesses + (own ? misses : result.build.counts().local_misses);
}

TEST(Energy, IsThatOfWhatTheCountersSayOnRandomMachines) {
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    marti::test::Random random(seed);
    EnergyCase one = random_energy_case(random);
    MachineConfig& machine = one.machine;
    const MachineResult plain = replay::replay(one.log, machine);
    ASSERT_FALSE(plain.energy.has_value());
    machine.energy = without_figures().energy;
    const auto with = [&](const auto& change) {
      MachineConfig changed = machine;
      change(changed.energy.figures);
      const EnergyResult result = energy_of(changed, replay::energy_counts(one.log, changed, plain));
      EXPECT_EQ(result.total, sum_of_parts(result)) << seed;
      return result;
    };
    EXPECT_EQ(with([](EnergyFigures&) {}).total, 0) << seed;
    const ReferenceCounts references = plain.references();
    const bool cached = machine.cache.organisation != CacheOrganisation::none;
    EXPECT_EQ(with([](EnergyFigures& f) { f.l1.read = 1.0; }).l1,
              cached ? references.references() * fj_a_pj : 0)
        << seed;
    EXPECT_EQ(with([](EnergyFigures& f) { f.l1.write = 1.0; }).l1,
              cached ? (references.all_misses() + plain.contexts.counts().issued) * fj_a_pj : 0)
        << seed;
    EXPECT_EQ(with([](EnergyFigures& f) { f.l2.read = 1.0; }).l2, plain.l2.counters().references() * fj_a_pj);
    EXPECT_EQ(with([](EnergyFigures& f) { f.l2.write = 1.0; }).l2, plain.l2.counters().misses * fj_a_pj);
    EXPECT_EQ(with([](EnergyFigures& f) { f.memory_access = 1.0; }).memory,
              accesses_of(machine, plain) * fj_a_pj)
        << seed;
    std::int64_t bytes = 0;
    for (const ClusterResult& cluster : plain.clusters) {
      bytes += cluster.distributed ? 0 : cluster.interconnect.bytes;
    }
    EXPECT_EQ(with([](EnergyFigures& f) { f.wire = f.interconnect_length = 1.0; }).interconnect,
              bytes * 8 * fj_a_pj)
        << seed;
    machine.energy.figures = energy_figures(EnergyPreset::nm22);
    machine.energy.figures.l1 = machine.energy.figures.l2 = {2.5, 3.5, 0.25};
    const MachineResult replayed = replay::replay(one.log, machine);
    EXPECT_EQ(replayed.end, plain.end);
    const EnergyResult all = *replayed.energy;
    EXPECT_EQ(all.total, sum_of_parts(all)) << seed;
    EXPECT_GT(all.operations, 0);
    EXPECT_GT(all.leakage, 0);
  }
}

}  // namespace
}  // namespace marti::processors
