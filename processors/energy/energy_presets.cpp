#include "processors/energy/energy_presets.h"

#include <array>
#include <cmath>

namespace marti::processors::energy {

namespace {

// a of the ways, which are read side by side, and b of the wires to and from the arrays, added as p-th
// powers:
// ((a ways (line / 64)^d1)^p + (b KiB^q (line / 64)^d2)^p)^(1/p).
struct Fit {
  double a;
  double b;
  double q;
  double p;
  double d1;
  double d2;

  [[nodiscard]] double at(const memory::CacheConfig& cache) const {
    const bool many = cache.ways == memory::full_ways || cache.ways > most_fitted_ways;
    const double ways = many ? most_fitted_ways : cache.ways;
    const double line = cache.line / 64.0;
    const double of_ways = a * ways * std::pow(line, d1);
    const double of_wires = b * std::pow(static_cast<double>(cache.size) / 1024.0, q) * std::pow(line, d2);
    return std::pow(std::pow(of_ways, p) + std::pow(of_wires, p), 1.0 / p);
  }
};

struct CacheFits {
  Fit read;   // pJ
  Fit write;  // pJ
  Fit area;   // um2
};

// Fitted by least squares of logarithms to 87 caches of 2 KiB to 4 MiB, 1 to 8 ways, lines of 32 and 64 bytes
// and at least 32 sets, as CACTI gives them (github.com/HewlettPackard/cacti, commit 1ffd8df: cache.cfg with
// high-performance transistors, ways read side by side, a bus of one line, no error correction). Mean and
// largest error in percent, 45 nm: read 8 and 29, write 8 and 25, area 9 and 42; 22 nm: read 8 and 34, write
// 8 and 21, area 11 and 46.
constexpr std::array<CacheFits, 2> fits = {{
    {.read = {22.25, 4.131, 0.625, 1.99, 1.65, 0.53},
     .write = {18.99, 13.23, 0.488, 2.00, 1.65, 0.84},
     .area = {29630.0, 3530.0, 1.033, 1.183, 1.669, -0.002050}},
    {.read = {6.764, 1.480, 0.603, 2.42, 1.79, 0.62},
     .write = {6.122, 3.129, 0.511, 1.89, 1.87, 0.86},
     .area = {9761.0, 1299.0, 0.9800, 1.616, 2.051, 0.07024}},
}};

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
// of a context, its registers. Leakage: the geometric mean over the caches that the fits were made of, at 360
// K. Horowitz, Keckler and, below, Dally are taken from later papers that quote them, not from the originals.
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

std::optional<machine::CacheFigures> fitted_cache(machine::EnergyPreset preset,
                                                  const memory::CacheConfig& cache) {
  const bool fitted = cache.size >= least_fitted_size && cache.size <= most_fitted_size &&
                      cache.line >= least_fitted_line && cache.line <= most_fitted_line;
  if (preset == machine::EnergyPreset::none || !fitted) {
    return std::nullopt;
  }
  const CacheFits& fit = fits.at(preset == machine::EnergyPreset::nm45 ? 0 : 1);
  return machine::CacheFigures{fit.read.at(cache), fit.write.at(cache), fit.area.at(cache) / 1e6};
}

}  // namespace marti::processors::energy
