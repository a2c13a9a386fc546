#include "processors/energy/energy.h"

#include <limits>
#include <string>
#include <string_view>

#include "processors/cost/build_mix.h"
#include "processors/cost/step_time.h"
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

std::int64_t of_operations(const machine::MachineConfig& config, const EnergyUnits& units,
                           const EnergyCounts& counts) {
  Sum sum("the energy of operations");
  // The costs of steps and splits are sums of those of operations: in cycles, or here in aJ.
  const cost::RecordWords words = cost::record_words(config);
  cost::for_each_step(
      cost::step_cycles(units.operations, words, counts.traversal, counts.mailboxes, counts.integrator),
      counts.steps,
      [&sum](cost::Activity /*activity*/, std::int64_t each, std::int64_t count) { sum.add(each, count); });
  node::for_each_build_part(cost::build_cycles(units.operations, words), counts.build,
                            [&sum](std::int64_t each, std::int64_t count) { sum.add(each, count); });
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

std::int64_t area_of(const machine::MachineConfig& config, const EnergyUnits& units) {
  Sum sum("the area of the machine");
  sum.add(units.node_area, config.all_nodes());
  sum.add(units.cluster_area, config.clusters);
  return sum.in_units_of(1);
}

// A pW for a ps is a yJ.
std::int64_t of_leakage(const EnergyUnits& units, std::int64_t area, sim::Ticks end) {
  Sum power("the leakage of the machine");
  power.add(area, units.leakage);
  Sum sum("the energy of leakage");
  sum.add(power.all(), end);
  return sum.in_units_of(yoctojoules_a_femtojoule);
}

}  // namespace

void check_energy(const machine::MachineConfig& config) {
  if (config.energy.on()) {
    (void)energy_units(config);
  }
}

EnergyResult energy_of(const machine::MachineConfig& config, const EnergyCounts& counts) {
  const EnergyUnits units = energy_units(config);
  EnergyResult result;
  result.operations = of_operations(config, units, counts);
  result.l1 = of_first_level(units, counts);
  result.l2 = of_second_level(units, counts);
  result.interconnect = of_interconnect(units, counts);
  result.memory = of_memory(units, counts);
  result.area = area_of(config, units);
  result.leakage = of_leakage(units, result.area, counts.end);
  Sum total("the energy of the frame");
  for (std::size_t i = 0; i < energy_parts; ++i) {
    total.add(result.*EnergyResult::counters()[i].member, 1);
  }
  result.total = total.in_units_of(1);
  return result;
}

}  // namespace marti::processors::energy
