#include "studies/estimate/sample_machine.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "memory/link.h"
#include "processors/node/packet_schedule.h"
#include "processors/passes/pixel_figures.h"
#include "processors/replay/replay.h"
#include "sim/error.h"
#include "sim/mapped.h"
#include "studies/figures/derived_figures.h"

namespace marti::studies::estimate {

namespace {

constexpr std::uint64_t shortest_window = 16;
constexpr double not_bounded = std::numeric_limits<double>::infinity();

// How long one read of a line, and one write of a pixel, hold a machine's interconnect, and how long a read
// takes, in ticks and without contention. A crossbar is taken as one of its links.
struct Tenures {
  double read = 0.0;
  double write = 0.0;
  double miss = 0.0;
};

Tenures tenures_of(const processors::machine::MachineConfig& machine) {
  const memory::InterconnectConfig& config = machine.interconnect;
  if (config.kind == memory::InterconnectKind::ideal) {
    return {0.0, 0.0, static_cast<double>(config.clock.cycles(config.latency_cycles))};
  }
  const memory::BeatTime beats(config);
  const auto address = static_cast<double>(config.clock.cycles(config.address_cycles));
  const auto line = static_cast<double>(beats(machine.cache.cache.line));
  const auto pixel = static_cast<double>(beats(machine.layout.pixel_bytes));
  const auto bank = static_cast<double>(machine.banks.clock.cycles(machine.banks.access_cycles));
  const bool held = config.mode == memory::BusMode::held;
  return {address + line + (held ? bank : 0.0), address + pixel, address + bank + line};
}

// What a window drawn took.
struct Window {
  KnownWork known;  // what it would have taken had every reference hit, and the misses expected
  double time = 0.0;
  double misses = 0.0;
  double references = 0.0;
};

std::vector<Window> windows_of(const PacketWindows& windows,
                               const processors::machine::MachineConfig& machine,
                               std::span<const processors::walk::PacketFigures> packets,
                               const LatticeWork& work) {
  const auto hit = static_cast<double>(machine.clock.cycles(machine.cache.hit_cycles));
  std::vector<Window> all;
  std::size_t at = 0;
  windows.for_each_drawn([&](std::uint64_t number) {
    Window& window = all.emplace_back();
    for (std::uint64_t packet = windows.first(number); packet < windows.end(number); ++packet, ++at) {
      window.time += static_cast<double>(packets[at].time);
      window.misses += static_cast<double>(packets[at].misses);
      window.references += static_cast<double>(packets[at].references);
      window.known.hit_time += static_cast<double>(packets[at].busy);
      window.known.misses += work.of_packets()[packet].misses;
    }
    window.known.hit_time += hit * window.misses;
  });
  return all;
}

// The times of all packets by what is known of each, with the sum `time.total`.
std::vector<sim::Ticks> packet_times(const LatticeWork& work, const RegressionEstimate& time) {
  const std::vector<double> times = sim::mapped(work.of_packets(), [&](const KnownWork& packet) {
    return std::max(0.0, time.counts_for.hit_time * packet.hit_time + time.counts_for.misses * packet.misses);
  });
  const double sum = std::accumulate(times.begin(), times.end(), 0.0);
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

MachineFigures figures_of(const processors::machine::MachineConfig& machine,
                          const processors::replay::MachineResult& result) {
  MachineFigures figures;
  figures[Figure::end] = static_cast<double>(result.end);
  figures[Figure::misses] = static_cast<double>(result.references().all_misses());
  figures[Figure::use] = figures::figure_of(machine, result, "interconnect_utilisation").value_or(0.0);
  double waited = 0.0;
  double tenures = 0.0;
  for (const processors::replay::ClusterResult& cluster : result.clusters) {
    waited += static_cast<double>(cluster.interconnect.waits.sum);
    tenures += static_cast<double>(cluster.interconnect.waits.count);
  }
  figures[Figure::wait] = tenures > 0.0 ? waited / tenures : 0.0;
  return figures;
}

std::uint64_t window_length(std::uint32_t nodes) { return std::max<std::uint64_t>(nodes, shortest_window); }

LatticeWork::LatticeWork(const processors::program::WorkLog& log,
                         const processors::machine::MachineConfig& machine, const PixelLattice& lattice,
                         const processors::machine::PacketList& packets, processors::walk::KeptVisits& visits)
    : lattice_(lattice), pixels_(static_cast<double>(log.width) * static_cast<double>(log.height)) {
  const std::vector<processors::passes::PixelFigures> figures =
      processors::passes::pixel_figures(log, machine, lattice.pixels(), visits);
  // A pixel whose neighbour the node has just walked misses what it misses when it is walked twice in a row,
  // because its lines do not fit the cache together; and a share of the rest, because a step of one pixel
  // brings in fewer lines than a step of the lattice.
  of_pixels_ = sim::mapped(figures, [](const processors::passes::PixelFigures& pixel) {
    const auto brought_in = static_cast<double>(std::max<std::int64_t>(0, pixel.misses - pixel.misses_again));
    return KnownWork{static_cast<double>(pixel.hit_time),
                     static_cast<double>(pixel.misses_again) + brought_in / PixelLattice::step};
  });
  of_packets_.resize(packets.size());
  for (std::uint64_t number = 0; number < packets.size(); ++number) {
    KnownWork& packet = of_packets_[number];
    for_each_pixel(packets[number], [&](std::uint32_t x, std::uint32_t y) {
      const std::size_t pixel = lattice.next_to(x, y);
      packet.hit_time += of_pixels_[pixel].hit_time;
      packet.misses += of_pixels_[pixel].misses;
      fewest_misses_ += static_cast<double>(figures[pixel].misses_again);
    });
    all_.hit_time += packet.hit_time;
    all_.misses += packet.misses;
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
  const std::vector<Window> drawn = windows_of(windows, machine, result.packet_figures, work);
  const std::vector<KnownWork> known = sim::mapped(drawn, [](const Window& window) { return window.known; });
  estimate.value = figures_of(machine, result);
  const auto total_of = [&](double Window::*measured) {
    return regression_estimate(windows.strata(), known,
                               sim::mapped(drawn, [&](const Window& window) { return window.*measured; }),
                               work.all());
  };
  estimate.references = total_of(&Window::references).total;
  if (windows.has_all()) {
    sampled.residues.assign(drawn.size(), 0.0);
    return sampled;
  }
  const RegressionEstimate time = total_of(&Window::time);
  const RegressionEstimate missed = total_of(&Window::misses);
  auto end = static_cast<double>(
      processors::node::schedule_packets(machine.host, machine.all_nodes(), packet_times(work, time)));
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

SampledRun with_one_node(const SampledMachine& sampled, const processors::program::WorkLog& log,
                         const processors::machine::MachineConfig& machine, const PacketWindows& windows,
                         const LatticeWork& work, processors::walk::KeptVisits& visits) {
  const bool is_one = machine.all_nodes() == 1;
  const SampledMachine one_node =
      is_one ? sampled
             : sample_machine(log, processors::machine::one_node_of(machine), windows, work, visits);
  SampledRun run{sampled.estimate, one_node.estimate, {}};
  const double end = run.machine.value[Figure::end];
  run.machine.value[Figure::speed_up] = end > 0.0 ? run.one_node.value[Figure::end] / end : 0.0;
  run.one_node.value[Figure::speed_up] = 1.0;
  run.lattice[Figure::end] = sampled.lattice;
  if (windows.has_all()) {
    return run;
  }
  const std::uint64_t degrees = std::min(sampled.degrees, one_node.degrees);
  run.lattice[Figure::speed_up] = work.half_width({sampled.counts_for.hit_time - one_node.counts_for.hit_time,
                                                   sampled.counts_for.misses - one_node.counts_for.misses});
  std::vector<double> residues = sampled.residues;
  for (std::size_t i = 0; i < residues.size(); ++i) {
    residues[i] -= one_node.residues[i];
  }
  run.machine.half_width[Figure::speed_up] =
      degrees == 0
          ? not_bounded
          : std::hypot(half_width_of(windows.strata(), residues, degrees), run.lattice[Figure::speed_up]);
  return run;
}

}  // namespace marti::studies::estimate
