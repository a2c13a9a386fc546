// DRAM channels against figures of other simulators, for streams that are defined exactly.
//
// The figures are of Ramulator 2.1 (github.com/CMU-SAFARI/ramulator2, commit c5b1c3a), fed with the streams
// of dram_streams.h: one channel of each preset, queues of 32 lines read and 32 written. Its own
// scheduler FRFCFS; its schedulers for FCFS and its closed pages were added to it for these figures.
// DRAMsim3 (github.com/umd-memsys/DRAMsim3, commit 2981759) differs from them by up to 4.5 % in the latency
// of random reads below half of the peak, 0.6 % in the bandwidth of random reads without a pause and 16 %
// with writes. Here all figures agree to the last digit but for writes served first come, first served.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "memory/dram_presets.h"
#include "tests/support/long_tests.h"
#include "tests/unit/memory/dram_streams.h"

namespace marti::memory {
namespace {

using F = DramField;

enum class Mapping { column_first, group_first, row_low };

// A line of 64 bytes is `bursts` bursts of one row.
std::vector<DramFieldBits> fields(Mapping mapping, std::int64_t bursts) {
  switch (mapping) {
    case Mapping::column_first:
      return {{F::column}, {F::channel}, {F::rank}, {F::bank_group}, {F::bank}, {F::row}};
    case Mapping::group_first:
      if (bursts == 2) {
        return {{F::column, 1}, {F::bank_group}, {F::column}, {F::channel}, {F::rank}, {F::bank}, {F::row}};
      }
      return {{F::bank_group}, {F::column}, {F::channel}, {F::rank}, {F::bank}, {F::row}};
    case Mapping::row_low:
      return {{F::column}, {F::row}, {F::bank}, {F::bank_group}, {F::rank}, {F::channel}};
  }
  return {};
}

struct Figure {
  DramPolicy policy;
  DramPage page;
  Mapping mapping;
  const char* pattern;
  double load;
  bool refresh;
  double mean_cycles;  // with a load, from arrival; without one, from a queue that is always full
  DramCycle last_read;
  std::int64_t hits, misses, conflicts, refreshes;
  std::size_t preset = 0;
};

// clang-format off
constexpr auto figures = std::to_array<Figure>({
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "seq", 0, true, 191.284, 267531, 49572, 428, 0, 28},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "rand1G", 0, true, 254.847, 342106, 9, 323, 49668, 36},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "onebank", 0, true, 1879.821, 2881868, 19, 219, 49762, 307},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "rand1G", 0.1, true, 69.063, 2012562, 6, 3356, 46638, 214},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "rand1G", 0.25, true, 81.371, 800919, 6, 1280, 48714, 85},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "rand1G", 0.5, true, 145.082, 402045, 8, 589, 49403, 42},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "rw9010", 0.5, true, 164.304, 402150, 12, 1314, 48674, 42},
    {DramPolicy::frfcfs, DramPage::open, Mapping::row_low, "seq", 0, true, 231.305, 330064, 49575, 36, 389, 35},
    {DramPolicy::frfcfs, DramPage::open, Mapping::row_low, "rand1G", 0, true, 972.233, 1463632, 9, 214, 49777, 156},
    {DramPolicy::frfcfs, DramPage::open, Mapping::row_low, "rand1G", 0.25, true, 333131.660, 1463765, 9, 213, 49778, 156},
    {DramPolicy::frfcfs, DramPage::open, Mapping::group_first, "seq", 0, true, 154.802, 210380, 49512, 364, 124, 22},
    {DramPolicy::frfcfs, DramPage::open, Mapping::group_first, "rand1G", 0, true, 254.867, 342214, 6, 336, 49658, 36},
    {DramPolicy::frfcfs, DramPage::open, Mapping::group_first, "rand1G", 0.25, true, 81.345, 800915, 4, 1281, 48715, 85},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "seq", 0, true, 1421.487, 2165712, 0, 50000, 0, 231},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "rand1G", 0, true, 254.883, 342158, 0, 50000, 0, 36},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "onebank", 0, true, 1880.496, 2882913, 0, 50000, 0, 307},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "rand1G", 0.1, true, 53.367, 2012546, 0, 50000, 0, 214},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "rand1G", 0.25, true, 65.322, 800903, 0, 50000, 0, 85},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "rand1G", 0.5, true, 129.089, 402029, 0, 50000, 0, 42},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "rw9010", 0.5, true, 133.909, 402129, 0, 50000, 0, 42},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::row_low, "seq", 0, true, 1880.496, 2882913, 0, 50000, 0, 307},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::row_low, "rand1G", 0, true, 972.015, 1463287, 0, 50000, 0, 156},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::row_low, "rand1G", 0.25, true, 333076.064, 1463502, 0, 50000, 0, 156},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::group_first, "seq", 0, true, 470.633, 679349, 0, 50000, 0, 72},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::group_first, "rand1G", 0, true, 254.893, 342247, 0, 50000, 0, 36},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::group_first, "rand1G", 0.25, true, 65.316, 800898, 0, 50000, 0, 85},
    {DramPolicy::fcfs, DramPage::open, Mapping::column_first, "seq", 0, true, 225.032, 320263, 49575, 425, 0, 34},
    {DramPolicy::fcfs, DramPage::open, Mapping::column_first, "rand1G", 0, true, 719.157, 1068099, 6, 1741, 48253, 114},
    {DramPolicy::fcfs, DramPage::open, Mapping::column_first, "onebank", 0, true, 1880.460, 2882858, 1, 219, 49780, 307},
    {DramPolicy::fcfs, DramPage::open, Mapping::column_first, "rand1G", 0.1, true, 82.635, 2012575, 6, 3356, 46638, 214},
    {DramPolicy::fcfs, DramPage::open, Mapping::column_first, "rand1G", 0.25, true, 133619.368, 1068099, 6, 1740, 48254, 114},
    {DramPolicy::fcfs, DramPage::open, Mapping::column_first, "rw9010", 0.5, true, 339107.636, 1081814, 6, 1771, 48223, 115},
    {DramPolicy::fcfs, DramPage::open, Mapping::row_low, "seq", 0, true, 231.305, 330064, 49575, 36, 389, 35},
    {DramPolicy::fcfs, DramPage::open, Mapping::row_low, "rand1G", 0, true, 1362.529, 2073378, 2, 353, 49645, 221},
    {DramPolicy::fcfs, DramPage::open, Mapping::row_low, "rand1G", 0.25, true, 635665.904, 2073378, 2, 353, 49645, 221},
    {DramPolicy::fcfs, DramPage::open, Mapping::group_first, "seq", 0, true, 156.533, 213175, 49521, 367, 112, 22},
    {DramPolicy::fcfs, DramPage::open, Mapping::group_first, "rand1G", 0, true, 722.027, 1072228, 4, 1752, 48244, 114},
    {DramPolicy::fcfs, DramPage::open, Mapping::group_first, "rand1G", 0.25, true, 135676.605, 1072228, 4, 1757, 48239, 114},
    {DramPolicy::fcfs, DramPage::closed, Mapping::column_first, "seq", 0, true, 1867.212, 2862157, 0, 50000, 0, 305},
    {DramPolicy::fcfs, DramPage::closed, Mapping::column_first, "rand1G", 0, true, 506.807, 735863, 0, 50000, 0, 78},
    {DramPolicy::fcfs, DramPage::closed, Mapping::column_first, "onebank", 0, true, 1880.496, 2882913, 0, 50000, 0, 307},
    {DramPolicy::fcfs, DramPage::closed, Mapping::column_first, "rand1G", 0.1, true, 58.436, 2012546, 0, 50000, 0, 214},
    {DramPolicy::fcfs, DramPage::closed, Mapping::column_first, "rand1G", 0.25, true, 238.010, 801132, 0, 50000, 0, 85},
    {DramPolicy::fcfs, DramPage::closed, Mapping::column_first, "rw9010", 0.5, true, 176599.395, 756080, 0, 50000, 0, 80},
    {DramPolicy::fcfs, DramPage::closed, Mapping::row_low, "seq", 0, true, 1880.496, 2882913, 0, 50000, 0, 307},
    {DramPolicy::fcfs, DramPage::closed, Mapping::row_low, "rand1G", 0, true, 1300.821, 1977084, 0, 50000, 0, 211},
    {DramPolicy::fcfs, DramPage::closed, Mapping::row_low, "rand1G", 0.25, true, 587640.653, 1977141, 0, 50000, 0, 211},
    {DramPolicy::fcfs, DramPage::closed, Mapping::group_first, "seq", 0, true, 496.491, 719754, 0, 50000, 0, 76},
    {DramPolicy::fcfs, DramPage::closed, Mapping::group_first, "rand1G", 0, true, 509.328, 739787, 0, 50000, 0, 78},
    {DramPolicy::fcfs, DramPage::closed, Mapping::group_first, "rand1G", 0.25, true, 229.510, 800988, 0, 50000, 0, 85},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "rand1G", 0.4, true, 103.852, 501576, 7, 780, 49213, 53},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "rand1G", 0.55, true, 206.322, 366560, 8, 510, 49482, 39},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "rand1G", 0.55, true, 189.708, 366578, 0, 50000, 0, 39},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "seq", 0, false, 185.517, 258526, 49609, 16, 375, 0},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "rand1G", 0, false, 243.889, 324997, 10, 16, 49974, 0},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "onebank", 0, false, 1794.709, 2748882, 20, 1, 49979, 0},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "rand1G", 0.1, false, 55.740, 2012562, 6, 16, 49978, 0},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "rand1G", 0.25, false, 61.449, 800919, 6, 16, 49978, 0},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "rand1G", 0.5, false, 83.910, 402045, 7, 16, 49977, 0},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "rw9010", 0.5, false, 99.014, 402150, 10, 823, 49167, 0},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "seq", 0, false, 1357.122, 2065142, 0, 50000, 0, 0},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "rand1G", 0, false, 243.930, 325044, 0, 50000, 0, 0},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "onebank", 0, false, 1795.420, 2749982, 0, 50000, 0, 0},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "rand1G", 0.1, false, 39.722, 2012546, 0, 50000, 0, 0},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "rand1G", 0.25, false, 45.362, 800903, 0, 50000, 0, 0},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "rand1G", 0.5, false, 67.595, 402029, 0, 50000, 0, 0},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "rw9010", 0.5, false, 73.795, 402129, 0, 50000, 0, 0},
    {DramPolicy::fcfs, DramPage::open, Mapping::column_first, "seq", 0, false, 218.658, 310321, 49609, 16, 375, 0},
    {DramPolicy::fcfs, DramPage::open, Mapping::column_first, "rand1G", 0, false, 695.879, 1031397, 6, 16, 49978, 0},
    {DramPolicy::fcfs, DramPage::open, Mapping::column_first, "onebank", 0, false, 1795.384, 2749927, 1, 1, 49998, 0},
    {DramPolicy::fcfs, DramPage::open, Mapping::column_first, "rand1G", 0.1, false, 64.827, 2012575, 6, 16, 49978, 0},
    {DramPolicy::fcfs, DramPage::open, Mapping::column_first, "rand1G", 0.25, false, 115495.142, 1031432, 6, 16, 49978, 0},
    {DramPolicy::fcfs, DramPage::open, Mapping::column_first, "rw9010", 0.5, false, 320744.245, 1045215, 6, 16, 49978, 0},
    {DramPolicy::fcfs, DramPage::closed, Mapping::column_first, "seq", 0, false, 1782.690, 2730092, 0, 50000, 0, 0},
    {DramPolicy::fcfs, DramPage::closed, Mapping::column_first, "rand1G", 0, false, 484.449, 700929, 0, 50000, 0, 0},
    {DramPolicy::fcfs, DramPage::closed, Mapping::column_first, "onebank", 0, false, 1795.420, 2749982, 0, 50000, 0, 0},
    {DramPolicy::fcfs, DramPage::closed, Mapping::column_first, "rand1G", 0.1, false, 41.392, 2012546, 0, 50000, 0, 0},
    {DramPolicy::fcfs, DramPage::closed, Mapping::column_first, "rand1G", 0.25, false, 108.846, 800928, 0, 50000, 0, 0},
    {DramPolicy::fcfs, DramPage::closed, Mapping::column_first, "rw9010", 0.5, false, 158758.808, 720337, 0, 50000, 0, 0},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "seq", 0, true, 339.677, 461070, 49124, 876, 0, 49, 1},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "rand1G", 0, true, 499.449, 655661, 7, 1132, 48861, 69, 1},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "rand1G", 0.25, true, 176.040, 1610801, 4, 5287, 44709, 171, 1},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "rand1G", 0.5, true, 280.644, 801028, 4, 2497, 47499, 85, 1},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "rw9010", 0.5, true, 286.450, 801399, 7, 3954, 46039, 85, 1},
    {DramPolicy::frfcfs, DramPage::open, Mapping::group_first, "rand1G", 0.5, true, 279.527, 801038, 3, 2495, 47502, 85, 1},
    {DramPolicy::frfcfs, DramPage::open, Mapping::group_first, "rw9010", 0.5, true, 284.962, 801185, 5, 4108, 45887, 85, 1},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "rand1G", 0, true, 499.507, 655748, 0, 50000, 0, 69, 1},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "rand1G", 0.5, true, 245.144, 801006, 0, 50000, 0, 85, 1},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "rw9010", 0.5, true, 238.868, 801134, 0, 50000, 0, 85, 1},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "seq", 0, true, 98.896, 124053, 96752, 1022, 2226, 62, 2},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "rand1G", 0, true, 136.510, 168211, 49556, 1260, 49184, 86, 2},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "rand1G", 0.1, true, 74.484, 1000743, 49749, 8033, 42218, 512, 2},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "rand1G", 0.5, true, 158.402, 200134, 49660, 1560, 48780, 102, 2},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "rw9010", 0.5, true, 214.228, 200206, 47975, 2553, 49472, 102, 2},
    {DramPolicy::frfcfs, DramPage::open, Mapping::group_first, "rw9010", 0.5, true, 212.111, 200276, 47926, 2520, 49554, 102, 2},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "seq", 0, true, 358.938, 516750, 49917, 50083, 0, 264, 2},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "rand1G", 0, true, 114.216, 130966, 48819, 50343, 838, 66, 2},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "rand1G", 0.5, true, 110.575, 200058, 49475, 50281, 244, 102, 2},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "rand1G", 0.7, true, 195.996, 143699, 49107, 50255, 638, 72, 2},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "rand1G", 0.8, true, 3057.011, 131531, 48782, 50345, 873, 66, 2},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "rand1G", 0.9, true, 10006.519, 131298, 48770, 50333, 897, 66, 2},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "rand1G", 0.8, false, 91.471, 125868, 49439, 50000, 561, 0, 2},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "rw9010", 0.5, true, 139.605, 200107, 47715, 50292, 1993, 102, 2},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::group_first, "rand1G", 0.7, true, 195.377, 143698, 49094, 50277, 629, 72, 2},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::group_first, "rand1G", 0.9, false, 2973.602, 117286, 49086, 50000, 914, 0, 2},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::group_first, "rw9010", 0.5, true, 140.616, 200185, 47734, 50300, 1966, 102, 2},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "mix8020", 0.75, true, 2166.309, 270750, 75539, 4959, 19502, 81, 3},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "onebank", 0, false, 2611.499, 3992778, 50090, 1, 49909, 0, 3},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "rand1G", 0.4, true, 230.467, 501696, 49555, 1919, 48526, 150, 3},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "rw9010", 0.25, true, 152.881, 801037, 48674, 4203, 47123, 240, 3},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "seq", 0.25, false, 38.614, 800893, 99218, 16, 766, 0, 3},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::group_first, "mix8020", 0.5, true, 20095.117, 442443, 49475, 50525, 0, 132, 3},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::group_first, "mix8020", 0, true, 326.649, 442179, 49492, 50508, 0, 132, 3},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::group_first, "rand1G", 0, true, 326.275, 441594, 49505, 50495, 0, 132, 3},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "onebank", 0, true, 2783.309, 4256265, 49538, 50462, 0, 1276, 3},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "rand1G", 0.25, true, 112.643, 800943, 49523, 50477, 0, 240, 3},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "rw9010", 0.25, true, 116.522, 801012, 47628, 50616, 1756, 240, 3},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "seq", 0.75, true, 941525.520, 2149409, 49508, 50492, 0, 644, 3},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "mix8020", 0.5, true, 176.282, 402114, 78755, 2534, 18711, 120, 4},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "onebank", 0, false, 2933.812, 4491871, 50090, 1, 49909, 0, 4},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "rand1G", 0.25, true, 185.200, 801089, 49501, 3284, 47215, 240, 4},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::group_first, "rand1G", 0.75, true, 170943.438, 609231, 49438, 50562, 0, 182, 4},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::group_first, "seq", 0.25, true, 142402.306, 1085266, 49373, 50627, 0, 325, 4},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "mix8020", 0.5, true, 114692.613, 630574, 49439, 50561, 0, 189, 4},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "onebank", 0, false, 2933.812, 4491871, 50090, 49910, 0, 0, 4},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "rw9010", 0.25, true, 168.574, 801255, 48462, 50589, 949, 240, 4},
    {DramPolicy::frfcfs, DramPage::open, Mapping::group_first, "seq", 0.25, true, 81.833, 401981, 96634, 3366, 0, 128, 5},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "mix8020", 0.25, true, 139.037, 402026, 79359, 4362, 16279, 128, 5},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "onebank", 0, true, 2603.442, 3972473, 49782, 405, 49813, 1272, 5},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "rand1G", 0.25, true, 150.579, 402038, 49559, 4088, 46353, 128, 5},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "rw9010", 0.25, true, 166.997, 402048, 48427, 4765, 46808, 128, 5},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::group_first, "rand1G", 0.25, true, 125.077, 402013, 49580, 50291, 129, 128, 5},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "mix8020", 0.25, false, 157.410, 402233, 49993, 50000, 7, 0, 5},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "mix8020", 0, false, 189.840, 230947, 49928, 50000, 72, 0, 5},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "onebank", 0, true, 2603.442, 3972473, 49782, 50218, 0, 1272, 5},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "onebank", 0, false, 2357.439, 3594137, 50090, 49910, 0, 0, 5},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "rand1G", 0.75, false, 11090.666, 156264, 49328, 50000, 672, 0, 5},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "rw9010", 0.25, true, 134.340, 402023, 48228, 50386, 1386, 128, 5},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "rw9010", 0.25, false, 73.225, 402023, 48725, 50000, 1275, 0, 5},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "seq", 0.5, false, 252661.216, 705431, 50000, 50000, 0, 0, 5},
    {DramPolicy::frfcfs, DramPage::open, Mapping::group_first, "mix8020", 0.5, true, 1523.198, 202520, 49600, 858, 49542, 64, 6},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "onebank", 0, true, 2539.621, 3874153, 49783, 398, 49819, 1240, 6},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "rand1G", 0.5, true, 861.697, 201056, 49537, 930, 49533, 64, 6},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "mix8020", 0.75, false, 74010.990, 281946, 49979, 50001, 20, 0, 6},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "onebank", 0, true, 2539.621, 3874153, 49783, 50217, 0, 1240, 6},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "rand1G", 0.5, false, 118.881, 200128, 49905, 50000, 95, 0, 6},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "rw9010", 0.25, true, 133.201, 402267, 48244, 50326, 1430, 128, 6},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "seq", 0.5, true, 283792.306, 768071, 49690, 50310, 0, 246, 6},
    {DramPolicy::frfcfs, DramPage::open, Mapping::group_first, "onebank", 0, true, 1706.831, 2604574, 49703, 580, 49717, 833, 7},
    {DramPolicy::frfcfs, DramPage::open, Mapping::group_first, "rand1G", 0, true, 211.346, 279302, 48871, 1551, 49578, 89, 7},
    {DramPolicy::frfcfs, DramPage::open, Mapping::group_first, "rw9010", 0.5, true, 130.720, 402191, 48545, 2470, 48985, 128, 7},
    {DramPolicy::frfcfs, DramPage::open, Mapping::group_first, "seq", 0, true, 161.269, 214128, 98106, 1094, 800, 68, 7},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "onebank", 0, true, 1706.831, 2604574, 49703, 580, 49717, 833, 7},
    {DramPolicy::frfcfs, DramPage::open, Mapping::column_first, "rand1G", 0.1, true, 63.706, 2012725, 49671, 9990, 40339, 644, 7},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::group_first, "onebank", 0, true, 1706.831, 2604574, 49703, 49957, 340, 833, 7},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::group_first, "rw9010", 0.5, true, 97.378, 401997, 48008, 50288, 1704, 128, 7},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::group_first, "seq", 0, true, 351.228, 498378, 49626, 50374, 0, 159, 7},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "onebank", 0, true, 1706.831, 2604574, 49703, 49957, 340, 833, 7},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "rand1G", 0.5, true, 79.320, 402035, 49459, 50263, 278, 128, 7},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "rand1G", 0, true, 183.519, 233681, 47360, 50367, 2273, 74, 7},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "rw9010", 0.5, true, 98.231, 402070, 48079, 50309, 1612, 128, 7},
    {DramPolicy::frfcfs, DramPage::closed, Mapping::column_first, "seq", 0, true, 588.193, 867507, 49810, 50190, 0, 277, 7},
});
// clang-format on

class Reference : public testing::TestWithParam<Figure> {};

TEST_P(Reference, AgreesWithRamulator) {
  const Figure& figure = GetParam();
  DramConfig config = dram_preset(figure.preset);
  const std::int64_t bursts = 64 / config.burst_bytes;
  config.policy = figure.policy;
  config.page = figure.page;
  config.mapping = fields(figure.mapping, bursts);
  config.reorder_cap = 0;
  config.queue = static_cast<std::uint32_t>(32 * bursts);
  if (!figure.refresh) {
    config.timing.refi = 0;
  }
  const test::StreamResult result =
      test::run_stream(config, test::make_stream(config, {figure.pattern, figure.load}), bursts);
  const DramStatistics& counts = result.counts;
  EXPECT_EQ(counts.row_hits + counts.row_misses + counts.row_conflicts, 50000 * bursts);
  // What the data buses do adds up, also where commands take half cycles.
  EXPECT_EQ(counts.data_busy + counts.bus_no_request + counts.bus_refresh + counts.bus_rows + counts.bus_turn,
            counts.data_buses * result.last * config.period);
  if (std::string(figure.pattern) == "rw9010" && figure.policy == DramPolicy::fcfs) {
    // Ramulator's first come, first served keeps writes in a queue of their own; here they are served in
    // their turn, so the data bus changes its direction more often.
    EXPECT_NEAR(result.mean_cycles / figure.mean_cycles, 1.0, 0.05);
    EXPECT_NEAR(static_cast<double>(result.last_read) / static_cast<double>(figure.last_read), 1.0, 0.02);
    return;
  }
  EXPECT_EQ(result.last_read, figure.last_read);
  EXPECT_EQ(counts.row_hits, figure.hits);
  EXPECT_EQ(counts.row_misses, figure.misses);
  EXPECT_EQ(counts.row_conflicts, figure.conflicts);
  EXPECT_EQ(counts.refreshes, figure.refreshes);
  if (figure.load > 0.0) {
    EXPECT_NEAR(result.mean_cycles, figure.mean_cycles, 0.0006);
  }
}

// Under the sanitizers every fifth one.
std::vector<Figure> tried() {
  std::vector<Figure> some;
  for (std::size_t i = 0; i < figures.size(); i += figures.size() / marti::test::cases(figures.size())) {
    some.push_back(figures[i]);
  }
  return some;
}
INSTANTIATE_TEST_SUITE_P(Presets, Reference, testing::ValuesIn(tried()));

// One line at a time, each `gap` cycles after the data of the last.
struct IdleFigure {
  std::size_t preset;
  DramPage page;
  const char* pattern;
  bool refresh;
  double mean_cycles;
  std::int64_t hits, misses, conflicts;
};

// clang-format off
constexpr auto idle_figures = std::to_array<IdleFigure>({
    {0, DramPage::open, "idle_conflict", false, 52.997, 0, 1, 4999},
    {0, DramPage::open, "idle_conflict", true, 58.656, 0, 85, 4915},
    {0, DramPage::open, "idle_hit", false, 21.003, 4999, 1, 0},
    {0, DramPage::open, "idle_hit", true, 26.490, 4932, 68, 0},
    {0, DramPage::open, "idle_random", false, 53.061, 2, 16, 4982},
    {0, DramPage::open, "idle_random", true, 54.165, 2, 454, 4544},
    {0, DramPage::closed, "idle_empty", false, 37.000, 0, 5000, 0},
    {0, DramPage::closed, "idle_empty", true, 42.918, 0, 5000, 0},
    {0, DramPage::closed, "idle_random", false, 38.134, 0, 5000, 0},
    {0, DramPage::closed, "idle_random", true, 40.025, 0, 5000, 0},
    {1, DramPage::open, "idle_conflict", true, 132.291, 0, 83, 4917},
    {1, DramPage::open, "idle_hit", true, 56.216, 4916, 84, 0},
    {1, DramPage::open, "idle_random", true, 112.360, 2, 1761, 3237},
    {1, DramPage::closed, "idle_empty", true, 95.286, 0, 5000, 0},
    {1, DramPage::closed, "idle_random", true, 88.922, 0, 5000, 0},
    {2, DramPage::open, "idle_conflict", true, 62.459, 5000, 209, 4791},
    {2, DramPage::open, "idle_hit", true, 29.967, 9833, 167, 0},
    {2, DramPage::open, "idle_random", true, 48.924, 4978, 1840, 3182},
    {2, DramPage::closed, "idle_empty", true, 49.972, 4904, 5096, 0},
    {2, DramPage::closed, "idle_random", true, 40.191, 4971, 5029, 0},
    {3, DramPage::open, "idle_conflict", true, 96.059, 4999, 295, 4706},
    {3, DramPage::open, "idle_hit", false, 31.005, 9999, 1, 0},
    {3, DramPage::open, "idle_hit", true, 38.863, 9791, 209, 0},
    {3, DramPage::open, "idle_random", false, 84.892, 5002, 16, 4982},
    {3, DramPage::open, "idle_random", true, 81.685, 4959, 1776, 3265},
    {3, DramPage::closed, "idle_empty", true, 66.626, 4999, 5001, 0},
    {3, DramPage::closed, "idle_random", false, 59.247, 5000, 5000, 0},
    {3, DramPage::closed, "idle_random", true, 64.221, 4952, 5048, 0},
    {4, DramPage::open, "idle_conflict", false, 90.994, 5000, 1, 4999},
    {4, DramPage::open, "idle_conflict", true, 101.933, 4925, 228, 4847},
    {4, DramPage::open, "idle_hit", false, 31.006, 9999, 1, 0},
    {4, DramPage::open, "idle_random", false, 90.880, 5002, 16, 4982},
    {4, DramPage::open, "idle_random", true, 86.754, 4954, 1871, 3175},
    {4, DramPage::closed, "idle_empty", true, 70.900, 4936, 5064, 0},
    {4, DramPage::closed, "idle_random", true, 68.161, 4949, 5051, 0},
    {5, DramPage::open, "idle_conflict", false, 83.995, 5000, 1, 4999},
    {5, DramPage::open, "idle_conflict", true, 101.261, 5000, 161, 4839},
    {5, DramPage::open, "idle_hit", false, 27.006, 9999, 1, 0},
    {5, DramPage::open, "idle_hit", true, 38.677, 9888, 112, 0},
    {5, DramPage::open, "idle_random", false, 83.680, 5000, 64, 4936},
    {5, DramPage::open, "idle_random", true, 77.540, 4963, 2849, 2188},
    {5, DramPage::closed, "idle_empty", false, 59.000, 5000, 5000, 0},
    {5, DramPage::closed, "idle_empty", true, 73.226, 5000, 5000, 0},
    {5, DramPage::closed, "idle_random", false, 59.190, 5000, 5000, 0},
    {5, DramPage::closed, "idle_random", true, 65.406, 4973, 5027, 0},
    {6, DramPage::open, "idle_conflict", false, 83.995, 5000, 1, 4999},
    {6, DramPage::open, "idle_conflict", true, 94.992, 5000, 156, 4844},
    {6, DramPage::open, "idle_hit", false, 27.006, 9999, 1, 0},
    {6, DramPage::open, "idle_random", true, 80.669, 4965, 1899, 3136},
    {6, DramPage::closed, "idle_empty", false, 59.000, 5000, 5000, 0},
    {6, DramPage::closed, "idle_random", false, 59.374, 5000, 5000, 0},
    {6, DramPage::closed, "idle_random", true, 64.099, 4967, 5033, 0},
    {7, DramPage::open, "idle_conflict", true, 64.439, 4913, 176, 4911},
    {7, DramPage::open, "idle_hit", true, 30.214, 9791, 209, 0},
    {7, DramPage::open, "idle_random", true, 54.519, 4953, 1348, 3699},
    {7, DramPage::closed, "idle_empty", true, 48.746, 4882, 5000, 118},
    {7, DramPage::closed, "idle_random", true, 43.253, 4972, 5001, 27},
});
// clang-format on

class Idle : public testing::TestWithParam<IdleFigure> {};

TEST_P(Idle, AgreesWithRamulator) {
  const IdleFigure& figure = GetParam();
  DramConfig config = dram_preset(figure.preset);
  config.policy = DramPolicy::frfcfs;
  config.page = figure.page;
  config.timing.refi = figure.refresh ? config.timing.refi : 0;
  const std::string pattern = figure.pattern;
  const DramCycle gap = pattern == "idle_random" ? 0 : 100;
  const std::int64_t bursts = 64 / config.burst_bytes;
  const DramMapping mapping(config);
  test::SplitMix addresses(12345);
  DramQueued channel(config);
  DramCycle now = 0;
  DramCycle sum = 0;
  for (std::uint32_t i = 0; i < 5000; ++i) {
    DramPlace place;
    if (pattern == "idle_random") {
      place = mapping.place(64 * (addresses.next() % ((1U << 30U) / 64)));
    } else {
      place.row = pattern == "idle_hit" ? 0 : i % 2;
    }
    std::optional<DramDone> done = channel.enter({place, bursts, false, now * config.steps()}, 0, i, 0);
    while (!done) {
      done = channel.step();
    }
    const DramCycle end = done->service.end / config.steps();
    sum += end - now;
    now = end + gap;
  }
  EXPECT_NEAR(static_cast<double>(sum) / 5000.0, figure.mean_cycles, 0.0006);
  const DramStatistics counts = channel.statistics(now * config.period);
  EXPECT_EQ(counts.row_hits, figure.hits);
  EXPECT_EQ(counts.row_misses, figure.misses);
  EXPECT_EQ(counts.row_conflicts, figure.conflicts);
}

INSTANTIATE_TEST_SUITE_P(Presets, Idle, testing::ValuesIn(idle_figures));

}  // namespace
}  // namespace marti::memory
