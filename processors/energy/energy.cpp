#include "processors/energy/energy.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include "processors/cost/build_mix.h"
#include "processors/cost/operation_mix.h"
#include "processors/cost/step_time.h"
#include "processors/energy/energy_presets.h"
#include "processors/energy/energy_units.h"
#include "sim/key_error.h"

namespace marti::processors::energy {

namespace {

[[noreturn]] void fail_overflow(std::string_view what) {
  throw sim::KeyError("energy.preset", std::string(what) +
                                           " does not fit 64 bits, which hold 9,223 J in fJ: make the frame "
                                           "or the figures of [energy] smaller");
}

// A sum of products in 128 bits.
class Sum {
 public:
  explicit Sum(std::string_view what) : what_(what) {}

  void add(Wide each, Wide count) {
    Wide product = 0;
    if (__builtin_mul_overflow(each, count, &product) || __builtin_add_overflow(sum_, product, &sum_)) {
      fail_overflow(what_);
    }
  }
  [[nodiscard]] Wide all() const { return sum_; }
  /// The sum in units of `unit`, rounded to the nearest, halves up.
  [[nodiscard]] std::int64_t in_units_of(std::int64_t unit) const {
    const Wide whole = sum_ / unit + (2 * (sum_ % unit) >= unit ? 1 : 0);
    if (whole > std::numeric_limits<std::int64_t>::max()) {
      fail_overflow(what_);
    }
    return static_cast<std::int64_t>(whole);
  }

 private:
  std::string_view what_;
  Wide sum_ = 0;
};

constexpr std::int64_t attojoules_a_femtojoule = 1000;
constexpr std::int64_t yoctojoules_a_femtojoule = 1'000'000'000;

// Adds the steps. Their costs are sums of those of operations: in cycles, or here in aJ.
void add_steps(const machine::MachineConfig& config, const machine::OperationCycles& operations,
               const EnergyCounts& counts, const cost::StepCounts& steps, Sum& sum) {
  const cost::StepCycles costs = cost::step_cycles(operations, cost::record_words(config), counts.traversal,
                                                   counts.mailboxes, counts.integrator);
  cost::for_each_step(
      costs, steps,
      [&sum](cost::Activity /*activity*/, std::int64_t each, std::int64_t count) { sum.add(each, count); });
}

// The steps of cores, and those of ray-tracing units.
struct DividedSteps {
  cost::StepCounts core;
  cost::StepCounts unit;
};
DividedSteps divided(const machine::MachineConfig& config, const cost::StepCounts& steps) {
  DividedSteps of{steps, {}};
  if (config.has_rt_unit()) {
    for (const auto member :
         {&cost::StepCounts::branches, &cost::StepCounts::transforms, &cost::StepCounts::leaves,
          &cost::StepCounts::tests, &cost::StepCounts::sphere_tests, &cost::StepCounts::cone_tests,
          &cost::StepCounts::cuts, &cost::StepCounts::passes}) {
      std::swap(of.core.*member, of.unit.*member);
    }
  }
  return of;
}

std::int64_t of_operations(const machine::MachineConfig& config, const EnergyUnits& units,
                           const EnergyCounts& counts) {
  Sum sum("the energy of operations");
  const cost::RecordWords words = cost::record_words(config);
  add_steps(config, units.operations, counts, divided(config, counts.steps).core, sum);
  node::for_each_build_part(cost::build_cycles(units.operations, words), counts.build,
                            [&sum](std::int64_t each, std::int64_t count) { sum.add(each, count); });
  return sum.in_units_of(attojoules_a_femtojoule);
}

// A test takes its operations, and of what holds the rays a read before it and a write after it.
std::int64_t of_tests(const machine::MachineConfig& config, const EnergyUnits& units,
                      const EnergyCounts& counts) {
  Sum sum("the energy of ray-tracing units");
  const cost::StepCounts steps = divided(config, counts.steps).unit;
  add_steps(config, units.unit_operations, counts, steps, sum);
  const std::int64_t leaves = accel::walks_bvh(counts.traversal) ? 0 : steps.leaves;
  sum.add(units.unit_rays.read + units.unit_rays.write,
          steps.branches + steps.transforms + leaves + steps.tests + steps.cuts + steps.passes);
  return sum.in_units_of(attojoules_a_femtojoule);
}

void add_cache(const CacheUnits& units, const memory::CacheCounters& counts, Sum& sum) {
  sum.add(units.read, counts.hits);
  sum.add(units.read + units.write, counts.misses);
}

std::int64_t of_first_level(const EnergyUnits& units, const EnergyCounts& counts) {
  Sum sum("the energy of first-level caches");
  for (std::size_t i = 0; i < machine::split_caches; ++i) {
    add_cache(units.l1.at(i), counts.l1.at(i), sum);
  }
  sum.add(units.l1[0].write, counts.l1_prefetches);
  return sum.in_units_of(attojoules_a_femtojoule);
}

std::int64_t of_second_level(const EnergyUnits& units, const EnergyCounts& counts) {
  Sum sum("the energy of second-level caches");
  add_cache(units.l2, counts.l2, sum);
  return sum.in_units_of(attojoules_a_femtojoule);
}

std::int64_t of_interconnect(const EnergyUnits& units, const EnergyCounts& counts) {
  Sum sum("the energy of the interconnect");
  sum.add(units.interconnect_byte, counts.interconnect_bytes);
  sum.add(units.hop_byte, counts.hop_bytes);
  return sum.in_units_of(attojoules_a_femtojoule);
}

std::int64_t of_memory(const EnergyUnits& units, const EnergyCounts& counts) {
  Sum sum("the energy of memory");
  sum.add(units.memory_read, counts.memory_reads);
  sum.add(units.memory_write, counts.memory_writes);
  sum.add(units.dram_activation, counts.dram.activations);
  sum.add(units.dram_read, counts.dram.read_bursts);
  sum.add(units.dram_write, counts.dram.write_bursts);
  return sum.in_units_of(attojoules_a_femtojoule);
}

// The area of what begins a step in each cycle: a unit for each of its operations. In um2, rounded up.
std::int64_t area_of_step(const machine::MachineConfig& config, const cost::OperationMix& mix) {
  constexpr double thousandths = 1000.0;
  constexpr double square_micrometres_a_square_millimetre = 1e6;
  const OperationAreas areas = operation_areas(config.energy.preset);
  const auto of = [](double area, std::int64_t operations) {
    return area / thousandths * static_cast<double>(operations);
  };
  return static_cast<std::int64_t>(std::ceil(square_micrometres_a_square_millimetre *
                                             (of(areas.add, mix.add) + of(areas.multiply, mix.multiply) +
                                              of(areas.divide, mix.divide + mix.square_root) +
                                              of(areas.integer, mix.compare + mix.integer))));
}

// How many such units there are: those that are given, or for any number so many that in them all lanes of
// the unit can test.
std::int64_t units_of_tests(const machine::MachineConfig& config, std::uint32_t given, std::int64_t cycles) {
  const std::int64_t lanes = std::int64_t{config.rt.warps} * config.simt.lanes;
  const std::int64_t each = std::max<std::int64_t>(1, cycles);
  return given > 0 ? given : (lanes - 1) / each + 1;
}

// Of one node's ray-tracing unit.
Wide area_of_unit(const machine::MachineConfig& config, const EnergyUnits& units,
                  accel::Traversal traversal) {
  if (!config.has_rt_unit()) {
    return 0;
  }
  const cost::OperationMixes& mixes = cost::operation_mixes(traversal);
  const auto one = [&](Wide area, const cost::OperationMix& mix) {
    return area == by_unit_operations ? Wide{area_of_step(config, mix)} : area;
  };
  return units.rays_area +
         one(units.box_unit_area, mixes.branch) *
             units_of_tests(config, config.rt.box_units, config.rt.box_cycles) +
         one(units.triangle_unit_area, mixes.test) *
             units_of_tests(config, config.rt.triangle_units, config.rt.triangle_cycles);
}

void add_areas(const machine::MachineConfig& config, const EnergyUnits& units, accel::Traversal traversal,
               EnergyResult& result) {
  const Wide unit = area_of_unit(config, units, traversal);
  const auto area = [&](Wide node, Wide cluster) {
    Sum sum("the area of the machine");
    sum.add(node, config.all_nodes());
    sum.add(cluster, config.clusters);
    return sum.in_units_of(1);
  };
  result.area = area(units.node_area - units.rays_area + unit, units.cluster_area);
  result.cache_area = area(units.cache_area, units.cluster_area);
  result.unit_area = area(unit, 0);
}

// A pW for a ps is a yJ.
std::int64_t of_leakage(const EnergyUnits& units, std::int64_t area, sim::Ticks end) {
  Sum power("the leakage of the machine");
  power.add(area, units.leakage);
  Sum sum("the energy of leakage");
  sum.add(power.all(), end);
  return sum.in_units_of(yoctojoules_a_femtojoule);
}

// Sets the total of the parts.
void add_up(EnergyResult& result) {
  Sum total("the energy of the frame");
  for (std::size_t i = 0; i < energy_parts; ++i) {
    total.add(result.*EnergyResult::counters()[i].member, 1);
  }
  result.total = total.in_units_of(1);
}

}  // namespace

void check_energy(const machine::MachineConfig& config) {
  if (config.energy.on()) {
    (void)energy_units(config);
  }
}

EnergyResult energy_of_accesses(const machine::MachineConfig& config, const EnergyCounts& counts) {
  const EnergyUnits units = energy_units(config);
  EnergyResult result;
  result.l1 = of_first_level(units, counts);
  result.l2 = of_second_level(units, counts);
  result.interconnect = of_interconnect(units, counts);
  result.memory = of_memory(units, counts);
  add_up(result);
  return result;
}

EnergyResult energy_of(const machine::MachineConfig& config, const EnergyCounts& counts) {
  const EnergyUnits units = energy_units(config);
  EnergyResult result = energy_of_accesses(config, counts);
  result.operations = of_operations(config, units, counts);
  result.unit = of_tests(config, units, counts);
  add_areas(config, units, counts.traversal, result);
  result.leakage = of_leakage(units, result.area, counts.end);
  add_up(result);
  return result;
}

}  // namespace marti::processors::energy
