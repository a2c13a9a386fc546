#include "processors/energy/energy_presets.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "processors/energy/cacti_rows.h"

namespace marti::processors::energy {

namespace {

using Rows = std::span<const CactiRow>;

// The value at x on the line through two points.
double through(double x0, double y0, double x1, double y1, double x) {
  return y0 + (y1 - y0) * (x - x0) / (x1 - x0);
}

// The logarithm of a figure of a cache of so many bytes, from caches of one line and one number of ways: on
// straight lines between logarithms, and beyond the smallest and largest on that through these two.
double by_size(Rows rows, double CactiRow::*figure, double size) {
  const auto above = std::ranges::find_if(rows, [&](const CactiRow& row) { return row.size >= size; });
  const bool beyond = above == rows.begin() || above == rows.end();
  const CactiRow& low = beyond ? rows.front() : *(above - 1);
  const CactiRow& high = beyond ? rows.back() : *above;
  return through(std::log(low.size), std::log(low.*figure), std::log(high.size), std::log(high.*figure),
                 std::log(size));
}

// As by_size(), from caches of one line and all numbers of ways.
double by_ways(Rows rows, double CactiRow::*figure, const memory::CacheConfig& cache) {
  const auto size = static_cast<double>(cache.size);
  const double ways =
      cache.ways == memory::full_ways ? rows.back().ways : std::min(cache.ways, rows.back().ways);
  double ways_before = 0.0;
  double before = 0.0;
  for (;;) {
    const std::uint32_t next = rows.front().ways;
    const auto end = std::ranges::find_if(rows, [&](const CactiRow& row) { return row.ways != next; });
    const double figure_of_next = by_size({rows.begin(), end}, figure, size);
    if (next >= ways) {
      return next == ways
                 ? figure_of_next
                 : through(std::log(ways_before), before, std::log(next), figure_of_next, std::log(ways));
    }
    ways_before = next;
    before = figure_of_next;
    rows = {end, rows.end()};
  }
}

// 45 nm, 0.9 V. Operations of 32 bits, and what an instruction takes beside them (70 pJ): Horowitz,
// Computing's energy problem, ISSCC 2014, figure 1.1.9: floating-point addition 0.9 pJ, multiplication 3.7,
// integer addition 0.1. A division is 7.1 times a multiplication, as measured on a Cortex-M4F (table 3 of
// ncbi.nlm.nih.gov/pmc/articles/PMC8934428). Conventions, for want of a figure: a square root is as a
// division, as in SimTRaX (github.com/dkoptacs/simtrax, sim/ReadConfig.cc); a comparison is as an integer
// addition, within 7 % as there, and so is the address of a load or store, whose cache is counted apart.
// Wires, 40 nm: 310 pJ for 256 bits over 10 mm: Keckler et al., GPUs and the future of parallel computing,
// IEEE Micro 31(5), 2011, table 1. Their 10 mm is the interconnect's length; that of a hop is a convention.
// Memory: DDR4 8 Gb x8 at 2400, a rank of 64 bits, from the currents in DRAMsim3
// (github.com/umd-memsys/DRAMsim3, DDR4_8Gb_x8_2400.ini): 3.45 nJ to activate and precharge, 2.93 nJ to read
// and 2.55 nJ to write 64 bytes. Area of a node: SimTRaX's units of 65 nm (adder .003, multiplier .0165,
// divider .112, integer multiplier .0117 and adder .00066, registers .0148 mm2), times the square of 45 / 65;
// of a context, its registers. Leakage: the geometric mean over 87 of these caches, with lines of 32 and 64
// bytes, at 360 K. Horowitz, Keckler and, below, Dally are taken from later papers that quote them, not from
// the originals.
constexpr machine::EnergyFigures nm45 = {.add = 0.9,
                                         .multiply = 3.7,
                                         .divide = 26.3,
                                         .square_root = 26.3,
                                         .compare = 0.1,
                                         .integer = 0.1,
                                         .load = 0.1,
                                         .store = 0.1,
                                         .instruction = 70.0,
                                         .l1 = {},
                                         .l2 = {},
                                         .wire = 0.121,
                                         .interconnect_length = 10.0,
                                         .hop_length = 2.0,
                                         .memory_access = 3450.0,
                                         .memory_read = 45.8,
                                         .memory_write = 39.8,
                                         .node_area = 0.076,
                                         .context_area = 0.0071,
                                         .leakage_density = 226.0};

// 22 nm. Operations: those of 45 nm times 0.29, the ratio of the two technologies' reads of caches (geometric
// mean over the same 87). Wires: 100 fJ a bit and mm (Dally, Turakhia, Han, Domain-specific hardware
// accelerators, Communications of the ACM 63(7), 2020). Their figure is for wires of about 14 nm; no
// correction to 22 nm is made. Lengths: half of those of 45 nm. Areas: times the square of 22 / 65.
constexpr machine::EnergyFigures nm22 = {.add = 0.261,
                                         .multiply = 1.073,
                                         .divide = 7.627,
                                         .square_root = 7.627,
                                         .compare = 0.029,
                                         .integer = 0.029,
                                         .load = 0.029,
                                         .store = 0.029,
                                         .instruction = 20.3,
                                         .l1 = {},
                                         .l2 = {},
                                         .wire = 0.1,
                                         .interconnect_length = 5.0,
                                         .hop_length = 1.0,
                                         .memory_access = 3450.0,
                                         .memory_read = 45.8,
                                         .memory_write = 39.8,
                                         .node_area = 0.0182,
                                         .context_area = 0.0017,
                                         .leakage_density = 225.0};

}  // namespace

machine::EnergyFigures energy_figures(machine::EnergyPreset preset) {
  switch (preset) {
    case machine::EnergyPreset::none:
      break;
    case machine::EnergyPreset::nm45:
      return nm45;
    case machine::EnergyPreset::nm22:
      return nm22;
  }
  return {};
}

OperationAreas operation_areas(machine::EnergyPreset preset) {
  // SimTRaX's units at 65 nm (FPADD, FPMUL, FPINV, INTADD of sim/ReadConfig.cc), as in the areas of nodes
  // above.
  const double nanometres = preset == machine::EnergyPreset::nm22 ? 22.0 : 45.0;
  const double scale = preset == machine::EnergyPreset::none ? 0.0 : nanometres * nanometres / (65.0 * 65.0);
  return {
      .add = 0.003 * scale, .multiply = 0.0165 * scale, .divide = 0.112 * scale, .integer = 0.00066 * scale};
}

std::optional<machine::CacheFigures> known_cache(machine::EnergyPreset preset,
                                                 const memory::CacheConfig& cache) {
  const auto* const known = std::ranges::find(known_caches, cache.line, &KnownCaches::line);
  if (preset == machine::EnergyPreset::none || known == known_caches.end() ||
      cache.size < known->least_size || cache.size > known->most_size) {
    return std::nullopt;
  }
  const Rows all = preset == machine::EnergyPreset::nm45 ? cacti_rows_45nm() : cacti_rows_22nm();
  const auto begin = std::ranges::lower_bound(all, cache.line, {}, &CactiRow::line);
  const auto end = std::ranges::upper_bound(all, cache.line, {}, &CactiRow::line);
  const auto figure = [&, rows = Rows(begin, end)](double CactiRow::*member) {
    return std::exp(by_ways(rows, member, cache));
  };
  return machine::CacheFigures{figure(&CactiRow::read), figure(&CactiRow::write), figure(&CactiRow::area)};
}

}  // namespace marti::processors::energy
