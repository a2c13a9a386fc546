// Estimates from a sample of a frame's packets.
#pragma once

#include <cstdint>
#include <vector>

#include "processors/machine/machine_config.h"
#include "processors/program/work_log.h"
#include "processors/replay/replay.h"
#include "processors/walk/kept_visits.h"
#include "studies/estimate/machine_figures.h"
#include "studies/estimate/packet_windows.h"
#include "studies/estimate/regression_estimate.h"

namespace marti::studies::estimate {

/// The figures of a replay of all packets.
[[nodiscard]] MachineFigures figures_of(const processors::machine::MachineConfig& machine,
                                        const processors::replay::MachineResult& result);

/// Packets of a window, for a machine of so many nodes: one for each node, and enough for a window's work to
/// be more than chance.
[[nodiscard]] std::uint64_t window_length(std::uint32_t nodes);

/// What the pixels of the lattice say of a frame on machines whose nodes and caches are those of one, however
/// many nodes they have.
class LatticeWork {
 public:
  /// `log` must hold the pixels of the lattice; its others are not looked at. `visits`: see pixel_figures().
  LatticeWork(const processors::program::WorkLog& log, const processors::machine::MachineConfig& machine,
              const PixelLattice& lattice, const processors::machine::PacketList& packets,
              processors::walk::KeptVisits& visits);

  [[nodiscard]] const std::vector<KnownWork>& of_packets() const { return of_packets_; }
  [[nodiscard]] const KnownWork& all() const { return all_; }
  /// The misses of the frame if a node had always just walked the same pixel, so that only what does not fit
  /// its cache is missed.
  [[nodiscard]] double fewest_misses() const { return fewest_misses_; }
  /// What share of the frame the machine's interconnect is busy, roughly.
  [[nodiscard]] double expected_use(const processors::machine::MachineConfig& machine) const;
  /// Half of the 95 % interval of all(), with what its time and its misses count for.
  [[nodiscard]] double half_width(const KnownWork& counts_for) const;

 private:
  const PixelLattice& lattice_;
  double pixels_;  // of the image
  std::vector<KnownWork> of_pixels_;
  std::vector<KnownWork> of_packets_;
  KnownWork all_;
  double fewest_misses_ = 0.0;
};

/// One machine's figures by the windows drawn.
struct SampledMachine {
  Estimate estimate;             ///< without the speed-up
  std::vector<double> residues;  ///< of each window: measured less estimated, as a share of the frame time
  KnownWork counts_for;       ///< what a tick of all hit times, and an expected miss, are of the frame time
  std::uint64_t degrees = 0;  ///< of freedom
  double lattice = 0.0;       ///< the lattice's part of the half-width of the frame time
};

/// A sample in two phases (Cochran 1977, sections 12.6 and 12.8). The lattice's pixels, which are many, say
/// what the frame would take if every reference hit, and how many misses to expect. The packets of the
/// windows drawn are replayed, and say how long they take, and how many misses they have, for such a time and
/// so many expected misses. `log` must hold the pixels of the windows and of the lattice; its other pixels
/// are not looked at, or have no words. Before a node begins a packet it takes its caches through what the
/// log has of the packets left out since its last one (processors/walk/packet_sample.h). The frame time is
/// that of a host that hands out packets of the estimated times, or the time that the interconnect needs for
/// all transfers, if that is longer. If all windows are drawn and the log is whole, the result is exact.
/// not_sampled() must not refuse the machine. `visits`: see replay::ReplayOptions.
[[nodiscard]] SampledMachine sample_machine(const processors::program::WorkLog& log,
                                            const processors::machine::MachineConfig& machine,
                                            const PacketWindows& windows, const LatticeWork& work,
                                            processors::walk::KeptVisits& visits);

/// A machine, and the same machine with one node.
struct SampledRun {
  Estimate machine;
  Estimate one_node;
  /// What the lattice has of the machine's half-widths of frame time and speed-up: more windows do not lessen
  /// it.
  MachineFigures lattice;
};

/// Adds the same machine with one node, by the same windows, and the speed-up over it. Most of what is chance
/// in the time of one is in that of the other, too.
[[nodiscard]] SampledRun with_one_node(const SampledMachine& sampled, const processors::program::WorkLog& log,
                                       const processors::machine::MachineConfig& machine,
                                       const PacketWindows& windows, const LatticeWork& work,
                                       processors::walk::KeptVisits& visits);

}  // namespace marti::studies::estimate
