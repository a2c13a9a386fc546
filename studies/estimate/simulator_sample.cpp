#include "studies/estimate/simulator_sample.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "processors/passes/pixel_figures.h"
#include "processors/replay/replay.h"
#include "sim/error.h"
#include "sim/key_error.h"
#include "sim/mapped.h"
#include "studies/estimate/packet_schedule.h"
#include "studies/estimate/tenures.h"

namespace marti::studies::estimate {

namespace {

constexpr std::uint64_t shortest_window = 16;
constexpr double not_bounded = std::numeric_limits<double>::infinity();

// The misses of a pixel whose neighbour the node has just walked: those that it has when it is walked twice
// in a row (misses_again), because its lines do not fit the cache together; and a share of the others,
// because a step of one pixel brings in fewer lines than a step of the lattice.
double expected_misses(const processors::passes::PixelFigures& pixel) {
  const auto brought_in = static_cast<double>(std::max<std::int64_t>(0, pixel.misses - pixel.misses_again));
  return static_cast<double>(pixel.misses_again) + brought_in / PixelLattice::step;
}

// What the windows drawn took.
struct WindowTotals {
  std::vector<KnownWork>
      known;  // what they would have taken had every reference hit, and the misses expected
  std::vector<double> times;
  std::vector<double> misses;
  std::vector<double> references;
};

WindowTotals totals_of_windows(const PacketWindows& windows,
                               const processors::machine::MachineConfig& machine,
                               std::span<const processors::walk::PacketFigures> packets,
                               const LatticeWork& work) {
  const auto hit = static_cast<double>(machine.clock.cycles(machine.cache.hit_cycles));
  WindowTotals totals;
  std::size_t at = 0;
  windows.for_each_drawn([&](std::uint64_t window) {
    processors::walk::PacketFigures sum;
    KnownWork known;
    for (std::uint64_t packet = windows.first(window); packet < windows.end(window); ++packet, ++at) {
      sum.time = sim::add_ticks(sum.time, packets[at].time);
      sum.busy = sim::add_ticks(sum.busy, packets[at].busy);
      sum.misses += packets[at].misses;
      sum.references += packets[at].references;
      known.misses += work.of_packets()[packet].misses;
    }
    known.hit_time = static_cast<double>(sum.busy) + hit * static_cast<double>(sum.misses);
    totals.known.push_back(known);
    totals.times.push_back(static_cast<double>(sum.time));
    totals.misses.push_back(static_cast<double>(sum.misses));
    totals.references.push_back(static_cast<double>(sum.references));
  });
  return totals;
}

// The times of all packets by what is known of each, with the sum `total`.
std::vector<sim::Ticks> packet_times(const LatticeWork& work, const RegressionEstimate& time) {
  std::vector<double> times;
  double sum = 0.0;
  for (const KnownWork& packet : work.of_packets()) {
    times.push_back(
        std::max(0.0, time.counts_for.hit_time * packet.hit_time + time.counts_for.misses * packet.misses));
    sum += times.back();
  }
  return sim::mapped(times, [&](const double one) {
    return sim::Ticks{std::llround(sum > 0.0 ? one * time.total / sum : 0.0)};
  });
}

// Sets the error of the frame time to that of `part`; `other` adds to the total and has no error.
void describe_end(const RegressionEstimate& part, double other, const LatticeWork& work,
                  SampledMachine& sampled) {
  const double all = part.total + other;
  if (part.total <= 0.0) {
    sampled.estimate.half_width[Figure::end] = not_bounded;
    return;
  }
  sampled.residues = part.residues;
  for (double& residue : sampled.residues) {
    residue /= all;
  }
  sampled.degrees = part.degrees;
  sampled.counts_for = {part.counts_for.hit_time / all, part.counts_for.misses / all};
  sampled.lattice = work.half_width(sampled.counts_for);
  sampled.estimate.half_width[Figure::end] = std::hypot(part.half_width * part.total / all, sampled.lattice);
}

}  // namespace

std::uint64_t window_length(std::uint32_t nodes) { return std::max<std::uint64_t>(nodes, shortest_window); }

void check_sample(const processors::machine::MachineConfig& machine) {
  processors::replay::check_sampled(machine);
  if (machine.clusters > 1) {
    throw sim::KeyError("machine.clusters", "a sample is taken with machine.clusters = 1 only");
  }
  if (machine.placement != processors::machine::Placement::shared) {
    throw sim::KeyError("database.placement", "a sample is taken with database.placement = \"shared\" only");
  }
}

LatticeWork::LatticeWork(const processors::program::WorkLog& log,
                         const processors::machine::MachineConfig& machine, const PixelLattice& lattice,
                         const processors::machine::PacketList& packets, processors::walk::KeptVisits& visits)
    : lattice_(lattice), pixels_(static_cast<double>(log.width) * static_cast<double>(log.height)) {
  std::vector<double> times;
  std::vector<double> misses;
  std::vector<double> fewest;
  for (const processors::passes::PixelFigures& pixel :
       processors::passes::pixel_figures(log, machine, lattice.pixels(), visits)) {
    of_pixels_.push_back({static_cast<double>(pixel.hit_time), expected_misses(pixel)});
    times.push_back(of_pixels_.back().hit_time);
    misses.push_back(of_pixels_.back().misses);
    fewest.push_back(static_cast<double>(pixel.misses_again));
  }
  times = lattice.expected_of_packets(times, packets);
  misses = lattice.expected_of_packets(misses, packets);
  for (const double of_packet : lattice.expected_of_packets(fewest, packets)) {
    fewest_misses_ += of_packet;
  }
  for (std::size_t packet = 0; packet < times.size(); ++packet) {
    of_packets_.push_back({times[packet], misses[packet]});
    all_.hit_time += times[packet];
    all_.misses += misses[packet];
  }
}

double LatticeWork::expected_use(const processors::machine::MachineConfig& machine) const {
  const Tenures tenures = tenures_of(machine);
  const double busy = all_.misses * tenures.read + pixels_ * tenures.write;
  const double nodes = (all_.hit_time + all_.misses * tenures.miss) / machine.all_nodes();
  return busy > 0.0 ? busy / std::max(busy, nodes) : 0.0;
}

double LatticeWork::half_width(const KnownWork& counts_for) const {
  const std::vector<double> values = sim::mapped(of_pixels_, [&](const KnownWork& pixel) {
    return counts_for.hit_time * pixel.hit_time + counts_for.misses * pixel.misses;
  });
  return lattice_.half_width(values);
}

SampledMachine sample_machine(const processors::program::WorkLog& log,
                              const processors::machine::MachineConfig& machine, const PacketWindows& windows,
                              const LatticeWork& work, processors::walk::KeptVisits& visits) {
  const std::vector<std::uint64_t> chosen = windows.chosen();
  const processors::walk::PacketSample sample(chosen, windows.packets().size(),
                                              processors::walk::PacketSample::all_before);
  const processors::replay::MachineResult result =
      processors::replay::replay(log, machine, {.sample = &sample, .visits = &visits});
  SampledMachine sampled;
  Estimate& estimate = sampled.estimate;
  const WindowTotals totals = totals_of_windows(windows, machine, result.packet_figures, work);
  estimate.value = figures_of(machine, result);
  estimate.events = result.events;
  const auto total_of = [&](const std::vector<double>& measured) {
    return regression_estimate(windows.strata(), totals.known, measured, work.all());
  };
  estimate.references = total_of(totals.references).total;
  if (windows.has_all()) {
    sampled.residues.assign(totals.times.size(), 0.0);
    return sampled;
  }
  const RegressionEstimate time = total_of(totals.times);
  const RegressionEstimate missed = total_of(totals.misses);
  auto end =
      static_cast<double>(schedule_packets(machine.host, machine.all_nodes(), packet_times(work, time)));
  // The frame cannot end before the links have carried all of its transfers: misses and pixels.
  const auto part =
      static_cast<double>(result.references().all_misses()) + static_cast<double>(result.pixels);
  const double pixels = static_cast<double>(log.width) * static_cast<double>(log.height);
  const double busy =
      estimate.value[Figure::use] * static_cast<double>(result.end) * (missed.total + pixels) / part;
  const double of_misses =
      std::hypot(missed.half_width,
                 missed.total > 0.0 ? work.half_width(missed.counts_for) / missed.total : not_bounded);
  if (busy > end) {
    describe_end(missed, pixels, work, sampled);
    end = busy;
  } else {
    describe_end(time, 0.0, work, sampled);
  }
  estimate.value[Figure::use] = end > 0.0 ? busy / end : 0.0;
  estimate.value[Figure::end] = end;
  estimate.value[Figure::misses] = missed.total;
  estimate.half_width[Figure::misses] = of_misses;
  estimate.fewest_misses = work.fewest_misses();
  if (busy > 0.0) {
    estimate.half_width[Figure::use] =
        estimate.value[Figure::use] * std::max(estimate.half_width[Figure::end], of_misses);
  }
  return sampled;
}

SampledRun add_one_node(const SampledMachine& machine, const SampledMachine& one_node,
                        const PacketWindows& windows, const LatticeWork& work) {
  SampledRun run{machine.estimate, one_node.estimate, {}};
  add_speed_up(run.machine, run.one_node);
  run.lattice[Figure::end] = machine.lattice;
  if (!windows.has_all()) {
    sim::ensure(machine.residues.size() == one_node.residues.size(), "machines of different samples");
    std::vector<double> residues = machine.residues;
    for (std::size_t i = 0; i < residues.size(); ++i) {
      residues[i] -= one_node.residues[i];
    }
    const std::uint64_t degrees = std::min(machine.degrees, one_node.degrees);
    run.lattice[Figure::speed_up] =
        work.half_width({machine.counts_for.hit_time - one_node.counts_for.hit_time,
                         machine.counts_for.misses - one_node.counts_for.misses});
    run.machine.half_width[Figure::speed_up] =
        degrees == 0
            ? not_bounded
            : std::hypot(half_width_of(windows.strata(), residues, degrees), run.lattice[Figure::speed_up]);
  }
  run.one_node.value[Figure::speed_up] = 1.0;
  run.one_node.half_width[Figure::speed_up] = 0.0;
  return run;
}

SampledRun estimate_by_sample(const processors::program::WorkLog& log,
                              const processors::machine::MachineConfig& machine, const PacketWindows& windows,
                              const PixelLattice& lattice) {
  check_sample(machine);
  processors::walk::KeptVisits visits;
  const LatticeWork work(log, machine, lattice, windows.packets(), visits);
  const SampledMachine sampled = sample_machine(log, machine, windows, work, visits);
  return machine.all_nodes() == 1
             ? add_one_node(sampled, sampled, windows, work)
             : add_one_node(
                   sampled,
                   sample_machine(log, processors::machine::one_node_of(machine), windows, work, visits),
                   windows, work);
}

}  // namespace marti::studies::estimate
