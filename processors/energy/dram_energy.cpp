#include "processors/energy/dram_energy.h"

#include <array>

#include "memory/dram_presets.h"

namespace marti::processors::energy {

namespace {

// From currents as DRAMsim3 does it: an activation takes VDD (IDD0 tRC - IDD3N tRAS - IDD2N (tRC - tRAS)), a
// burst VDD (IDD4 - IDD3N) times its time on the bus, of all devices; without drivers and termination.
//
// ddr4-2400: github.com/umd-memsys/DRAMsim3, configs/DDR4_8Gb_x8_2400.ini: 3.45 nJ, and 2.93 and 2.55 nJ for
// 64 bytes.
// ddr5-4800: no published figure at hand; those of DDR4 times the square of 1.1 V / 1.2 V, and an activation
// half of that, since its row has half the bytes.
// hbm2-2000: O'Connor et al., Fine-grained DRAM, MICRO 2017: 909 pJ to activate a row of 1 KiB; 2.24 pJ a bit
// to move it over the die and 0.30 over the interface. As quoted in later papers.
// hbm3: no published figure at hand; those of HBM2 times the square of 1.1 V / 1.2 V.
// gddr6: the currents of Arches (github.com/Haydelj/arches-v2, ramulator2 GDDR6): IDD0 71, IDD2N 60, IDD3N
// 61, IDD4R 248, IDD4W 231 mA, at 1.35 V and at 1.25 V, with the preset's times: a burst of 32 bytes has the
// bus for 1.14 ns.
// lpddr5-6400: no published figure at hand; LPDDR4-2400 of DRAMsim3 (configs/LPDDR4_8Gb_x16_2400.ini: 1.74 nJ
// to activate a row of 2 KiB, 6.1 pJ a bit read at 1.2 V) times the square of 1.05 V / 1.2 V; a write as a
// read.
constexpr std::string_view of_ddr4 =
    "currents of DRAMsim3's DDR4_8Gb_x8_2400, without drivers and termination";
constexpr std::string_view as_ddr4 =
    "convention: DDR4's by the square of the voltage, rows of half the bytes";
constexpr std::string_view of_hbm2 = "O'Connor et al., MICRO 2017";
constexpr std::string_view as_hbm2 =
    "convention: HBM2's (O'Connor et al., MICRO 2017) by the square of the voltage";
constexpr std::string_view of_gddr6 = "currents of Arches' GDDR6, without drivers and termination";
constexpr std::string_view as_lpddr4 =
    "convention: currents of DRAMsim3's LPDDR4_8Gb_x16_2400 by the square of the voltage";

constexpr std::array<DramEnergy, memory::dram_preset_names.size()> energies = {{
    {3450.0, 45.8, 39.8, of_ddr4},
    {1450.0, 38.5, 33.4, as_ddr4},
    {909.0, 20.3, 20.3, of_hbm2},
    {628.0, 8.99, 8.18, of_gddr6},
    {663.0, 8.33, 7.57, of_gddr6},
    {764.0, 17.1, 17.1, as_hbm2},
    {764.0, 17.1, 17.1, as_hbm2},
    {1330.0, 37.4, 37.4, as_lpddr4},
}};

}  // namespace

const DramEnergy& dram_energy(std::size_t preset) { return energies.at(preset); }

}  // namespace marti::processors::energy
