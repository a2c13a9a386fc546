#include "processors/energy/energy_units.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

#include "processors/energy/energy_presets.h"
#include "sim/key_error.h"
#include "sim/units.h"

namespace marti::processors::energy {

namespace {

constexpr double attojoules_a_picojoule = 1e6;
constexpr double square_micrometres_a_square_millimetre = 1e6;
constexpr double picowatts_of_milliwatts = 1e3;  // mW a mm2 in pW a um2

// The largest figure of all others.
constexpr double most = 1e9;

void require_range(std::string_view key, double figure, double largest) {
  if (!(figure >= 0.0 && figure <= largest)) {
    throw sim::KeyError("energy." + std::string(key), "must be from 0 to " + sim::print_real(largest));
  }
}

// A figure in a unit that is `times` smaller, rounded to the nearest.
std::int64_t whole(std::string_view key, double figure, double times) {
  require_range(key, figure, most);
  return std::llround(figure * times);
}

// What switches takes the square of the voltage.
std::int64_t switched(const machine::EnergyConfig& energy, std::string_view key, double picojoules) {
  require_range("voltage", energy.voltage, most_voltage);
  const auto nominal = static_cast<double>(whole(key, picojoules, attojoules_a_picojoule));
  return std::llround(nominal * energy.voltage * energy.voltage);
}

// Operations with what each takes beside its own, `beside` of them under `beside_key`.
machine::OperationCycles operations_of(const machine::EnergyConfig& energy, std::string_view beside_key,
                                       double beside) {
  const machine::EnergyFigures& figures = energy.figures;
  const auto operation = [&](std::string_view key, double picojoules) {
    require_range(key, picojoules, most_of_operation);
    return switched(energy, key, picojoules);
  };
  const std::int64_t each = operation(beside_key, beside);
  const auto of = [&](std::string_view key, double picojoules) { return operation(key, picojoules) + each; };
  return {.add = of("add", figures.add),
          .multiply = of("multiply", figures.multiply),
          .divide = of("divide", figures.divide),
          .square_root = of("square_root", figures.square_root),
          .compare = of("compare", figures.compare),
          .integer = of("integer", figures.integer),
          .load = of("load", figures.load),
          .store = of("store", figures.store)};
}

// One cache, with the keys that say its size, its lines and its figures.
struct NamedCache {
  memory::CacheConfig cache;
  std::string_view size_key;
  std::string_view line_key;
  std::string_view level;  // "l1", "l2" or "rt"
};

// The cache's figures: those that are given, for the others those of CACTI's caches.
machine::CacheFigures figures_of(const machine::EnergyConfig& energy, const NamedCache& named) {
  machine::CacheFigures figures = named.level == "l1"   ? energy.figures.l1
                                  : named.level == "l2" ? energy.figures.l2
                                                        : energy.figures.rt;
  if (figures.read != machine::by_shape && figures.write != machine::by_shape &&
      figures.area != machine::by_shape) {
    return figures;
  }
  const std::optional<machine::CacheFigures> known = known_cache(energy.preset, named.cache);
  if (!known) {
    const std::string level = "energy." + std::string(named.level);
    const bool line =
        std::ranges::find(known_caches, named.cache.line, &KnownCaches::line) == known_caches.end();
    std::string all;
    for (const KnownCaches& caches : known_caches) {
      all += (all.empty() ? "" : ", ") + std::to_string(caches.line) + " bytes of " +
             sim::print_size(static_cast<std::int64_t>(caches.least_size)) + " to " +
             sim::print_size(static_cast<std::int64_t>(caches.most_size));
    }
    throw sim::KeyError(std::string(line ? named.line_key : named.size_key),
                        "the energy of a cache of " +
                            sim::print_size(static_cast<std::int64_t>(named.cache.size)) + " with lines of " +
                            std::to_string(named.cache.line) +
                            " bytes is not known: it is of caches with lines of " + all + "; give " + level +
                            "_read, " + level + "_write and " + level + "_area");
  }
  for (const auto member :
       {&machine::CacheFigures::read, &machine::CacheFigures::write, &machine::CacheFigures::area}) {
    if (figures.*member == machine::by_shape) {
      figures.*member = (*known).*member;
    }
  }
  return figures;
}

// Adds the cache's area; returns its energies.
CacheUnits add_cache(const machine::EnergyConfig& energy, const NamedCache& named, Wide& area) {
  const machine::CacheFigures figures = figures_of(energy, named);
  const std::string level(named.level);
  area += whole(level + "_area", figures.area, square_micrometres_a_square_millimetre);
  return {switched(energy, level + "_read", figures.read), switched(energy, level + "_write", figures.write)};
}

void add_first_level(const machine::MachineConfig& config, EnergyUnits& units) {
  const std::vector<machine::FirstLevelCache> caches = machine::first_level_caches(config.cache);
  for (std::size_t i = 0; i < caches.size(); ++i) {
    units.l1.at(i) =
        add_cache(config.energy, {caches[i].cache, caches[i].size_key, "cache.line", "l1"}, units.node_area);
  }
}

void add_second_level(const machine::MachineConfig& config, EnergyUnits& units) {
  if (config.l2.sharing != machine::SecondLevel::none) {
    Wide& area = config.l2.sharing == machine::SecondLevel::shared ? units.cluster_area : units.node_area;
    const bool alone = config.cache.organisation == machine::CacheOrganisation::none;
    units.l2 = add_cache(
        config.energy,
        {machine::second_level_cache(config), "l2.size", alone ? "memory.interleave" : "cache.line", "l2"},
        area);
  }
}

// What holds the rays of a unit, as a direct-mapped cache of lines of 64 bytes: of each lane the ray, its hit
// and ten entries of its stack, 128 bytes, and of each line under way its address and who waits for it, 16
// bytes.
void add_unit(const machine::MachineConfig& config, EnergyUnits& units) {
  constexpr std::uint64_t ray_bytes = 128;
  constexpr std::uint64_t register_bytes = 16;
  const machine::EnergyConfig& energy = config.energy;
  units.unit_operations = operations_of(energy, "rt_operation", energy.figures.rt_operation);
  const std::uint64_t bytes =
      ray_bytes * config.rt.warps * config.simt.lanes + register_bytes * config.simt.mshrs;
  memory::CacheConfig rays;
  rays.line = 64;
  rays.ways = 1;
  rays.size = std::max(bytes, known_caches[1].least_size);
  Wide area = 0;
  units.unit_rays = add_cache(energy, {rays, "rt.warps", "rt.warps", "rt"}, area);
  units.rays_area = area;
  units.node_area += area;
  const auto area_of = [](std::string_view key, double figure) {
    return figure == machine::by_shape ? by_unit_operations
                                       : Wide{whole(key, figure, square_micrometres_a_square_millimetre)};
  };
  units.box_unit_area = area_of("rt_box_area", energy.figures.rt_box_area);
  units.triangle_unit_area = area_of("rt_triangle_area", energy.figures.rt_triangle_area);
}

}  // namespace

EnergyUnits energy_units(const machine::MachineConfig& config) {
  const machine::EnergyConfig& energy = config.energy;
  const machine::EnergyFigures& figures = energy.figures;
  EnergyUnits units;
  units.operations = operations_of(energy, "instruction", figures.instruction);
  add_first_level(config, units);
  add_second_level(config, units);
  units.cache_area = units.node_area;
  if (config.has_rt_unit()) {
    add_unit(config, units);
  }
  constexpr double bits = 8.0;
  units.interconnect_byte = switched(energy, "wire", figures.wire * figures.interconnect_length * bits);
  units.hop_byte = switched(energy, "wire", figures.wire * figures.hop_length * bits);
  // Memory has a supply of its own.
  const Wide line = config.reference_bytes();
  const Wide access = whole("memory_access", figures.memory_access, attojoules_a_picojoule);
  const Wide byte_read = whole("memory_read", figures.memory_read, attojoules_a_picojoule);
  const Wide byte_written = whole("memory_write", figures.memory_write, attojoules_a_picojoule);
  units.memory_read = access + line * byte_read;
  // Pixels that a SIMT node writes together may fill a line, of which it reads sectors.
  const Wide written = config.kind == machine::NodeKind::simt ? Wide{config.cache.cache.line} : line;
  units.memory_write = access + written * byte_written;
  if (config.banks.dram) {
    units.dram_activation = access;
    units.dram_read = config.banks.dram->burst_bytes * byte_read;
    units.dram_write = config.banks.dram->burst_bytes * byte_written;
  }
  constexpr double square = square_micrometres_a_square_millimetre;
  // Of the lanes of warps, so many compute at once; those of other warps have registers alone.
  const bool simt = config.kind == machine::NodeKind::simt;
  const Wide computing = simt ? std::min(config.simt.issue, config.simt.warps) * config.simt.lanes : 1;
  const Wide all = simt ? config.simt.warps * config.simt.lanes : config.contexts;
  units.node_area += computing * whole("node_area", figures.node_area, square) +
                     (all - computing) * whole("context_area", figures.context_area, square);
  units.leakage = whole("leakage_density", figures.leakage_density, picowatts_of_milliwatts);
  return units;
}

}  // namespace marti::processors::energy
