// Estimates from a sample of a frame's packets.
#pragma once

#include <cstdint>
#include <span>

#include "processors/machine/machine_config.h"
#include "processors/program/work_log.h"
#include "studies/estimate/packet_windows.h"
#include "studies/estimate/simulator_figures.h"

namespace marti::studies {

/// A total over all units, estimated with the help of what is known of every unit.
struct RatioEstimate {
  double total = 0.0;
  double half_width = 0.0;  ///< of the 95 % interval, relative to the total
};

/// The combined ratio estimator (W. G. Cochran, "Sampling techniques", 3rd ed. 1977, section 6.11): `known`
/// and `measured` of the strata's chosen units, in order, `all_known` the sum of what is known of all units.
/// Its variance is 6.51 there; the interval takes Student's distribution, with chosen units less strata as
/// its degrees of freedom. If all units are chosen, the result is the total, with half-width 0; without a
/// degree of freedom, or where nothing is known or measured, the half-width is infinite.
[[nodiscard]] RatioEstimate ratio_estimate(std::span<const Stratum> strata, std::span<const double> known,
                                           std::span<const double> measured, double all_known);

/// Packets of a window, for a machine of so many nodes: one for each node, and enough for a window's work to
/// be more than chance.
[[nodiscard]] std::uint64_t window_length(std::uint32_t nodes);

/// A machine, and the same machine with one node.
struct SampledRun {
  Estimate machine;
  Estimate one_node;
  double lattice =
      0.0;  ///< what the lattice has of the half-width of the time: more windows do not lessen it
};

/// A sample in two phases (Cochran 1977, section 12.8). The lattice's pixels, which are many, say what the
/// frame would take if every reference hit. The packets of the windows drawn are replayed on the machine and
/// on one node, and say how much longer they take, and how many misses they have, for such a time. `log` must
/// hold the pixels of the windows and of the lattice; its other pixels are not looked at, or have no words.
/// Before a node begins a packet it takes its caches through what the log has of the packets left out since
/// its last one (processors/walk/packet_sample.h). The frame time is that of a host that hands out packets of
/// the estimated times, or the time that the interconnect needs for all transfers, if that is longer. If all
/// windows are drawn and the log is whole, the result is exact. Throws UserError for a machine that
/// check_sample() refuses.
[[nodiscard]] SampledRun estimate_by_sample(const processors::WorkLog& log,
                                            const processors::MachineConfig& machine,
                                            const PacketWindows& windows, const PixelLattice& lattice);

/// Throws UserError with the reason when a machine cannot be estimated from a sample.
void check_sample(const processors::MachineConfig& machine);

}  // namespace marti::studies
