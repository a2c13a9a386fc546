// The search of `marti run --within` for a sample that is large enough.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "studies/estimate/measured_errors.h"
#include "studies/estimate/within.h"

namespace marti::studies::estimate {

namespace {

// A sample of least_windows is taken at once where it traces so little that it costs next to nothing.
constexpr double cheap_share = 0.05;
// The largest share of the pixels that the smallest sample which may do can trace: what is not estimated
// after all is traced once, but the packets of a sample are then replayed in vain.
constexpr double fair_share = 0.2;
// Where a small sample costs more, the lattice is traced first. By the load that it lets expect, a sample of
// least_windows is likely to do where the measured errors leave it so much of what is asked for; else a
// first, smaller sample says what the next must be.
constexpr double likely_share_of_tolerance = 0.5;
constexpr std::uint64_t first_strata = 4;
// The largest share of the pixels that a later sample may trace.
constexpr double most_share = 0.3;
// Degrees of freedom from which on more of them make an interval hardly narrower.
constexpr std::uint64_t many_degrees = 25;

// The share of all windows whose half-width will be `wanted`, where the windows drawn have `half_width` with
// so many degrees of freedom, and the lattice its part of both. The square of the windows' part goes with 1 /
// share - 1.
double share_for(const PacketWindows& windows, std::uint64_t degrees, double lattice, double half_width,
                 double wanted) {
  if (degrees == 0) {
    return 1.0;
  }
  const double drawn = static_cast<double>(windows.drawn()) / static_cast<double>(windows.windows());
  const double student = student_95(std::max(degrees, many_degrees)) / student_95(degrees);
  // Widened by one standard error of a standard deviation with so many degrees of freedom.
  const double margin = 1.0 + 1.0 / std::sqrt(2.0 * static_cast<double>(degrees));
  const double own = margin * student * std::sqrt(std::max(0.0, half_width * half_width - lattice * lattice));
  const double of_windows = std::sqrt(wanted * wanted - lattice * lattice);
  return 1.0 / (1.0 + of_windows / own * (of_windows / own) * (1.0 / drawn - 1.0));
}

class GrowingSample {
 public:
  GrowingSample(SampledFrame& frame, const processors::machine::PacketList& packets,
                const processors::machine::MachineConfig& machine, double tolerance, std::uint64_t seed)
      : frame_(frame),
        packets_(packets),
        machine_(machine),
        nodes_(machine.all_nodes()),
        tolerance_(tolerance),
        seed_(seed) {}

  WithinAnswer answer() {
    begin();
    while (reason_.empty()) {
      const PacketWindows windows = windows_of(strata_);
      if (const std::optional<EstimatedRun> run = attempt(windows)) {
        return {run, ""};
      }
      double wanted = 0.0;
      for (const Figure figure : needs_) {
        wanted = std::max(wanted, windows_for(windows, figure));
      }
      if (reason_.empty()) {
        grow(wanted);
      }
    }
    return {std::nullopt, reason_};
  }

 private:
  [[nodiscard]] PacketWindows windows_of(std::uint64_t strata) const {
    return {packets_, window_length(nodes_), strata, seed_};
  }

  // The wider of the half-widths that are asked for: those of frame time and speed-up. One node has a
  // speed-up of exactly 1.
  [[nodiscard]] double width_of(const MachineFigures& half_width) const {
    return nodes_ == 1 ? half_width[Figure::end]
                       : std::max(half_width[Figure::end], half_width[Figure::speed_up]);
  }
  [[nodiscard]] double least_allowance(const AllowancesBySize& load) const {
    return width_of(std::ranges::min(load, {}, [&](const MachineFigures& one) { return width_of(one); }));
  }

  // The first reason is kept.
  void refuse(const std::string& reason) { reason_ = reason_.empty() ? reason : reason_; }
  void refuse_unknown(double allowance) {
    refuse(
        fmt::format("samples of such machines are known to have errors of up to {:.2g} % beside what a "
                    "larger sample lessens",
                    100.0 * allowance));
  }
  void refuse_large_first(double share) {
    if (share > fair_share) {
      refuse(
          fmt::format("the smallest sample would trace {:.0f} % of the pixels and replay its packets first",
                      100.0 * share));
    }
  }

  // The share of the pixels that are traced with a sample of so many strata.
  [[nodiscard]] double share_of(std::uint64_t strata) const { return frame_.share_with(windows_of(strata)); }

  // Sets strata_ for the first sample, unless an exact run is cheaper than any sample.
  void begin() {
    double least = std::numeric_limits<double>::infinity();
    for (const AllowancesBySize& load : measured_allowances) {
      least = std::min(least, least_allowance(load));
    }
    if (least >= tolerance_) {
      refuse_unknown(least);
      return;
    }
    strata_ = least_windows / 2;
    const double share = share_of(strata_);
    refuse_large_first(share);
    if (share > fair_share || share <= cheap_share) {
      return;
    }
    work_.emplace(frame_.with_lattice(), machine_, frame_.lattice(), packets_, visits_);
    const AllowancesBySize& load = measured_allowances[load_class_of(work_->expected_use(machine_))];
    if (width_of(load[0]) < likely_share_of_tolerance * tolerance_) {
      return;
    }
    for (std::size_t size = 0; size < load.size(); ++size) {
      if (width_of(load[size]) < tolerance_) {
        refuse_large_first(share_of(sample_sizes[size] / 2));
        strata_ = first_strata;
        return;
      }
    }
    refuse_unknown(least_allowance(load));
  }

  // Traces and times a sample. If it does not say frame time and speed-up narrowly enough, or not whether it
  // does, needs_ are the figures that a larger one is to say.
  std::optional<EstimatedRun> attempt(const PacketWindows& windows) {
    const processors::program::WorkLog& log = frame_.with(windows);
    if (!work_) {
      work_.emplace(log, machine_, frame_.lattice(), packets_, visits_);
    }
    const SampledMachine sampled = sample_machine(log, machine_, windows, *work_, visits_);
    run_ = {sampled.estimate, {}, {}};
    run_.lattice[Figure::end] = sampled.lattice;
    degrees_ = sampled.degrees;
    load_ = load_class_of(run_.machine.value[Figure::use]);
    size_ = size_class_of(std::max(windows.drawn(), least_windows));
    needs_ = {Figure::end};
    const bool large_enough = windows.drawn() >= least_windows;
    const auto narrow = [&](Figure figure) {
      return large_enough &&
             run_.machine.half_width[figure] + measured_allowances[load_][size_][figure] <= tolerance_;
    };
    // One node is timed only where it takes little time, or may be all that is missing.
    if (large_enough && !narrow(Figure::end)) {
      return std::nullopt;
    }
    run_ = with_one_node(sampled, log, machine_, windows, *work_, visits_);
    if (nodes_ > 1) {
      needs_.push_back(Figure::speed_up);
    }
    if (!std::ranges::all_of(needs_, narrow)) {
      return std::nullopt;
    }
    widen(run_.machine, load_);
    widen(run_.one_node, load_class_of(run_.one_node.value[Figure::use]));
    run_.one_node.half_width[Figure::speed_up] = 0.0;  // one node has a speed-up of exactly 1
    if (nodes_ == 1) {
      run_.machine.half_width[Figure::speed_up] = 0.0;
    }
    return EstimatedRun{run_,
                        load_classes[load_],
                        windows.drawn(),
                        windows.windows(),
                        windows.chosen().size(),
                        windows.packets().size(),
                        frame_.traced()};
  }

  // Adds the measured half-widths to the sample's own.
  void widen(Estimate& estimate, std::size_t load) const {
    for (std::size_t i = 0; i < figure_count; ++i) {
      estimate.half_width.values[i] += measured_allowances[load][size_].values[i];
    }
  }

  // The fewest windows that are expected to suffice for a figure, unless an exact run is cheaper.
  double windows_for(const PacketWindows& windows, Figure figure) {
    const AllowancesBySize& load = measured_allowances[load_];
    const double lattice = run_.lattice[figure];  // its part of the half-width, which stays
    const auto all = static_cast<double>(windows.windows());
    double least = std::numeric_limits<double>::infinity();
    double wanted = 0.0;
    for (std::size_t size = size_; size < load.size(); ++size) {
      const double rest = tolerance_ - load[size][figure];
      least = std::min(least, load[size][figure]);
      if (rest <= lattice) {
        continue;
      }
      wanted = std::max({wanted,
                         share_for(windows, degrees_, lattice, run_.machine.half_width[figure], rest) * all,
                         static_cast<double>(sample_sizes[size])});
      if (size + 1 < load.size() && wanted < static_cast<double>(sample_sizes[size + 1])) {
        break;
      }
    }
    if (wanted == 0.0) {
      refuse_unknown(least + lattice);
    } else if (wanted > most_share * all) {
      refuse(fmt::format("a sample that is large enough would trace {:.0f} % of the pixels",
                         std::min(100.0, 100.0 * wanted / all)));
    }
    return wanted;
  }

  // The number of strata doubles, so that all that was drawn is drawn again.
  void grow(double wanted) {
    do {
      strata_ *= 2;
    } while (2.0 * static_cast<double>(strata_) < 0.99 * wanted);
    if (const double share = share_of(strata_); share > most_share) {
      refuse(fmt::format("a larger sample would trace {:.0f} % of the pixels and replay its packets again",
                         100.0 * share));
    }
  }

  SampledFrame& frame_;
  const processors::machine::PacketList& packets_;
  const processors::machine::MachineConfig& machine_;
  std::uint32_t nodes_;
  double tolerance_;
  std::uint64_t seed_;
  std::optional<LatticeWork> work_;  // empty before the lattice is traced
  processors::walk::KeptVisits visits_;
  std::uint64_t strata_ = 0;  // of the next sample
  std::string reason_;        // why an exact run is cheaper; empty: it is not known to be
  // Of the last sample:
  SampledRun run_;             // with one node where that was timed
  std::size_t load_ = 0;       // class
  std::size_t size_ = 0;       // class, the first for samples that are too small
  std::uint64_t degrees_ = 0;  // of freedom
  std::vector<Figure> needs_;
};

}  // namespace

WithinAnswer estimate_within(SampledFrame& frame, const processors::machine::PacketList& packets,
                             const processors::machine::MachineConfig& machine, double tolerance,
                             std::uint64_t seed) {
  return GrowingSample(frame, packets, machine, tolerance, seed).answer();
}

}  // namespace marti::studies::estimate
