// How far samples are from exact answers beside what their own intervals say: what `bench_estimates` has
// measured, as part of the program.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "sim/error.h"
#include "studies/estimate/machine_figures.h"

namespace marti::studies::estimate {

/// Errors are measured apart for machines whose interconnect is busy up to these shares of the frame: how far
/// the contention in a sample is from that in the frame depends on it. Most of all where the interconnect is
/// nearly full; where it is full it works all the time, in a sample as in the frame.
inline constexpr std::array<double, 4> load_classes = {0.3, 0.7, 0.95, 1.0};
/// The class of an interconnect's use, a share from 0 on.
[[nodiscard]] inline std::size_t load_class_of(double use) {
  const auto* const found = std::ranges::lower_bound(load_classes, use);
  return std::min(static_cast<std::size_t>(found - load_classes.begin()), load_classes.size() - 1);
}
/// And apart for samples of at least so many windows, up to the next size: small samples are further off than
/// their spread says. They may miss the few places where most misses are. And where nodes wait for one
/// another, the nodes of two windows that follow one another in the sample, but not in the frame, meet at
/// their border.
inline constexpr std::array<std::uint64_t, 2> sample_sizes = {32, 64};
/// Smaller samples are not used.
inline constexpr std::uint64_t least_windows = sample_sizes[0];
/// The last of sample_sizes that such a sample reaches; `windows` is at least least_windows.
[[nodiscard]] inline std::size_t size_class_of(std::uint64_t windows) {
  const auto* const above = std::ranges::upper_bound(sample_sizes, windows);
  sim::ensure(above != sample_sizes.begin(), "no errors are known of so few windows");
  return static_cast<std::size_t>(above - sample_sizes.begin()) - 1;
}

/// What the half-widths of samples of one class of load are to be widened by, so that 95 % of errors are
/// covered; in the order of sample_sizes.
using AllowancesBySize = std::array<MachineFigures, sample_sizes.size()>;
/// In the order of load_classes, as `bench_estimates` prints it: of frame time, speed-up, misses, use and
/// mean wait. "Covered": the share of the samples in intervals widened by what the samples of the other
/// scenes say, of the figure of which it is least.
inline constexpr std::array<AllowancesBySize, load_classes.size()> measured_allowances = {{
    // busy up to 30 %: 32 windows: 126 samples, 93.7 % covered; 64 windows: 229 samples, 93.8 % covered
    {{{{0.0, 0.0035635117632829534, 0.8327778605827969, 0.005203549163941326, 2.805619844520092}},
      {{0.0, 0.0018346536330847228, 0.7779573338161518, 0.004973825193171831, 1.2963800965322738}}}},
    // busy up to 70 %: 32 windows: 31 samples, 93.5 % covered; 64 windows: 37 samples, 94.6 % covered
    {{{{0.01796523165756417, 0.02479893512883967, 0.16574912935321323, 0.023772776713000824,
        0.7302305210047655}},
      {{0.008097072663318019, 0.013087117986868547, 0.1573878477651512, 0.0228808339338574,
        0.4284700153872638}}}},
    // busy up to 95 %: 32 windows: 17 samples, 94.1 % covered; 64 windows: 23 samples, 91.3 % covered
    {{{{0.2485555208313014, 0.18492601231369266, 0.04084738195644805, 0.15876358468932528,
        0.7264035194215293}},
      {{0.03504382160187501, 0.042398985461215594, 0.0, 0.01850500622904385, 0.4217755099852807}}}},
    // busy up to 100 %: 32 windows: 26 samples, 88.5 % covered; 64 windows: 36 samples, 91.7 % covered
    {{{{0.015888362257173237, 0.019959963786341586, 0.03327242395791198, 0.00445487951830216,
        0.17165036174796533}},
      {{0.003118118914582208, 0.005160687991918662, 0.0, 0.0, 0.10420244600452211}}}},
}};

}  // namespace marti::studies::estimate
