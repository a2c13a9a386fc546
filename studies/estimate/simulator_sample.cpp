#include "studies/estimate/simulator_sample.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "processors/passes/hit_times.h"
#include "processors/replay/replay.h"
#include "sim/key_error.h"
#include "studies/estimate/error_metrics.h"
#include "studies/estimate/packet_schedule.h"

namespace marti::studies {

namespace {

constexpr std::uint64_t shortest_window = 16;
constexpr double infinite = std::numeric_limits<double>::infinity();

// The sum over all units that a sum over each stratum's chosen ones stands for.
double expand(std::span<const Stratum> strata, std::span<const double> values) {
  double sum = 0.0;
  std::size_t at = 0;
  for (const Stratum& stratum : strata) {
    const double weight = static_cast<double>(stratum.size()) / static_cast<double>(stratum.chosen.size());
    for (std::size_t i = 0; i < stratum.chosen.size(); ++i) {
      sum += weight * values[at++];
    }
  }
  return sum;
}

// The variance of the estimated total of values - ratio * known.
double variance_of(std::span<const Stratum> strata, std::span<const double> known,
                   std::span<const double> measured, double ratio) {
  double variance = 0.0;
  std::size_t at = 0;
  for (const Stratum& stratum : strata) {
    const auto n = static_cast<double>(stratum.chosen.size());
    const auto size = static_cast<double>(stratum.size());
    double sum = 0.0;
    double squares = 0.0;
    for (std::size_t i = 0; i < stratum.chosen.size(); ++i, ++at) {
      const double residue = measured[at] - ratio * known[at];
      sum += residue;
      squares += residue * residue;
    }
    if (stratum.chosen.size() > 1) {
      const double spread = std::max(0.0, (squares - sum * sum / n) / (n - 1.0));
      variance += size * size * (1.0 - n / size) * spread / n;
    }
  }
  return variance;
}

// What the windows drawn took.
struct WindowTotals {
  std::vector<double> hit_times;  // what they would have taken had every reference hit
  std::vector<double> times;
  std::vector<double> misses;
  std::vector<double> references;
};

WindowTotals totals_of_windows(const PacketWindows& windows, const processors::MachineConfig& machine,
                               std::span<const processors::PacketFigures> packets) {
  const auto hit = static_cast<double>(machine.clock.cycles(machine.cache.hit_cycles));
  WindowTotals totals;
  std::size_t at = 0;
  windows.for_each_drawn([&](std::uint64_t window) {
    processors::PacketFigures sum;
    for (std::uint64_t packet = windows.first(window); packet < windows.end(window); ++packet, ++at) {
      sum.time = sim::add_ticks(sum.time, packets[at].time);
      sum.busy = sim::add_ticks(sum.busy, packets[at].busy);
      sum.misses += packets[at].misses;
      sum.references += packets[at].references;
    }
    totals.hit_times.push_back(static_cast<double>(sum.busy) + hit * static_cast<double>(sum.misses));
    totals.times.push_back(static_cast<double>(sum.time));
    totals.misses.push_back(static_cast<double>(sum.misses));
    totals.references.push_back(static_cast<double>(sum.references));
  });
  return totals;
}

// What the packets would take if every reference hit, by the pixels of the lattice.
struct KnownWork {
  std::vector<sim::Ticks> of_packets;
  double all = 0.0;
  double half_width = 0.0;  // of `all`, relative
};

KnownWork known_work(const processors::WorkLog& log, const processors::MachineConfig& machine,
                     const PacketWindows& windows, const PixelLattice& lattice) {
  const std::vector<sim::Ticks> times = processors::hit_times(log, machine, lattice.pixels());
  KnownWork known{lattice.expected_times(times, windows.packets()), 0.0, lattice.half_width(times)};
  for (const sim::Ticks time : known.of_packets) {
    known.all += static_cast<double>(time);
  }
  return known;
}

struct SampledMachine {
  Estimate estimate;
  std::vector<double> window_times;
  bool full = false;  // the frame ends when the interconnect has carried all transfers
};

SampledMachine sample_machine(const processors::WorkLog& log, const processors::MachineConfig& machine,
                              const PacketWindows& windows, const KnownWork& known) {
  const std::vector<std::uint64_t> chosen = windows.chosen();
  const processors::PacketSample sample(chosen, windows.packets().size(),
                                        processors::PacketSample::all_before);
  const processors::MachineResult result = processors::replay(log, machine, {.sample = &sample});
  SampledMachine sampled;
  Estimate& estimate = sampled.estimate;
  WindowTotals totals = totals_of_windows(windows, machine, result.packet_figures);
  estimate.value = figures_of(machine, result);
  estimate.events = result.events;
  const auto total_of = [&](const std::vector<double>& measured) {
    return ratio_estimate(windows.strata(), totals.hit_times, measured, known.all);
  };
  estimate.references = total_of(totals.references).total;
  if (windows.has_all()) {
    sampled.window_times = std::move(totals.times);
    return sampled;
  }
  const RatioEstimate time = total_of(totals.times);
  const RatioEstimate missed = total_of(totals.misses);

  const double stretch = known.all > 0.0 ? time.total / known.all : 0.0;
  std::vector<sim::Ticks> packet_times(known.of_packets.size());
  for (std::size_t packet = 0; packet < packet_times.size(); ++packet) {
    packet_times[packet] = std::llround(stretch * static_cast<double>(known.of_packets[packet]));
  }
  auto end = static_cast<double>(schedule_packets(machine.host, machine.all_nodes(), packet_times));
  // The frame cannot end before the links have carried all of its transfers: misses and pixels.
  const auto part =
      static_cast<double>(result.references().all_misses()) + static_cast<double>(result.pixels);
  const double whole = missed.total + static_cast<double>(log.width) * static_cast<double>(log.height);
  const double busy = estimate.value[Figure::use] * static_cast<double>(result.end) * whole / part;
  sampled.full = busy > end;
  estimate.half_width[Figure::end] = std::hypot(
      known.half_width, sampled.full ? std::max(time.half_width, missed.half_width) : time.half_width);
  end = std::max(end, busy);
  estimate.value[Figure::use] = end > 0.0 ? busy / end : 0.0;
  estimate.value[Figure::end] = end;
  estimate.value[Figure::misses] = missed.total;
  estimate.half_width[Figure::misses] = std::hypot(known.half_width, missed.half_width);
  if (busy > 0.0) {
    estimate.half_width[Figure::use] =
        estimate.value[Figure::use] * std::max(time.half_width, missed.half_width);
  }
  sampled.window_times = std::move(totals.times);
  return sampled;
}

}  // namespace

RatioEstimate ratio_estimate(std::span<const Stratum> strata, std::span<const double> known,
                             std::span<const double> measured, double all_known) {
  const double sum_known = expand(strata, known);
  const double sum_measured = expand(strata, measured);
  if (all_chosen(strata)) {
    return {sum_measured, 0.0};
  }
  if (sum_known <= 0.0) {
    return {sum_measured, infinite};
  }
  const double ratio = sum_measured / sum_known;
  RatioEstimate estimate{ratio * all_known, infinite};
  if (measured.size() > strata.size() && sum_measured > 0.0) {
    estimate.half_width = student_95(measured.size() - strata.size()) *
                          std::sqrt(variance_of(strata, known, measured, ratio)) / sum_measured;
  }
  return estimate;
}

std::uint64_t window_length(std::uint32_t nodes) { return std::max<std::uint64_t>(nodes, shortest_window); }

void check_sample(const processors::MachineConfig& machine) {
  processors::check_sampled(machine);
  if (machine.clusters > 1) {
    throw sim::KeyError("machine.clusters", "a sample is taken with machine.clusters = 1 only");
  }
  if (machine.placement != processors::Placement::shared) {
    throw sim::KeyError("database.placement", "a sample is taken with database.placement = \"shared\" only");
  }
}

SampledRun estimate_by_sample(const processors::WorkLog& log, const processors::MachineConfig& machine,
                              const PacketWindows& windows, const PixelLattice& lattice) {
  check_sample(machine);
  const KnownWork known = known_work(log, machine, windows, lattice);
  SampledMachine sampled = sample_machine(log, machine, windows, known);
  SampledRun run{sampled.estimate, sampled.estimate, windows.has_all() ? 0.0 : known.half_width};
  if (machine.all_nodes() > 1) {
    SampledMachine one = sample_machine(log, processors::one_node_of(machine), windows, known);
    run.one_node = one.estimate;
    add_speed_up(run.machine, run.one_node);
    // The same packets were timed on both, so that most of what is chance in one is in the other, too. That
    // holds for the packets' times only, not for a frame time that follows from the misses.
    if (!sampled.full && !one.full) {
      const double all_times = expand(windows.strata(), sampled.window_times);
      run.machine.half_width[Figure::speed_up] =
          ratio_estimate(windows.strata(), sampled.window_times, one.window_times, all_times).half_width;
    }
  } else {
    add_speed_up(run.machine, run.one_node);
    run.machine.half_width[Figure::speed_up] = 0.0;
  }
  run.one_node.value[Figure::speed_up] = 1.0;
  run.one_node.half_width[Figure::speed_up] = 0.0;
  return run;
}

}  // namespace marti::studies
