#include "studies/estimate/simulator_sample.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "processors/passes/one_pass.h"
#include "processors/replay/replay.h"
#include "studies/estimate/error_metrics.h"
#include "studies/estimate/packet_schedule.h"

namespace marti::studies {

std::vector<Stratum> draw_strata(std::uint64_t packets, std::uint64_t wanted, std::uint64_t seed) {
  wanted = std::min(wanted, packets);
  const std::uint64_t count = std::max<std::uint64_t>(1, wanted / 2);
  std::mt19937_64 random(seed);
  std::vector<Stratum> strata(count);
  for (std::uint64_t i = 0; i < count; ++i) {
    Stratum& stratum = strata[i];
    stratum.first = packets * i / count;
    stratum.end = packets * (i + 1) / count;
    const std::uint64_t drawn = std::min(wanted * (i + 1) / count - wanted * i / count, stratum.size());
    // Selection sampling (D. E. Knuth, The Art of Computer Programming 2, algorithm 3.4.2 S).
    std::uint64_t left = drawn;
    for (std::uint64_t packet = stratum.first; packet < stratum.end && left > 0; ++packet) {
      if (random() % (stratum.end - packet) < left) {
        stratum.chosen.push_back(packet);
        --left;
      }
    }
  }
  return strata;
}

RatioEstimate ratio_estimate(std::span<const Stratum> strata, std::span<const std::uint64_t> known,
                             std::span<const double> measured) {
  double all_known = 0.0;
  for (const std::uint64_t value : known) {
    all_known += static_cast<double>(value);
  }
  // Sums over the strata of a mean times the stratum's size.
  double sum_known = 0.0;
  double sum_measured = 0.0;
  std::size_t at = 0;
  std::uint64_t chosen = 0;
  for (const Stratum& stratum : strata) {
    const double weight = static_cast<double>(stratum.size()) / static_cast<double>(stratum.chosen.size());
    for (const std::uint64_t packet : stratum.chosen) {
      sum_known += weight * static_cast<double>(known[packet]);
      sum_measured += weight * measured[at++];
    }
    chosen += stratum.chosen.size();
  }
  if (sum_known <= 0.0) {
    return {sum_measured, chosen == known.size() ? 0.0 : std::numeric_limits<double>::infinity()};
  }
  const double ratio = sum_measured / sum_known;
  RatioEstimate estimate;
  estimate.total = ratio * all_known;
  double variance = 0.0;
  at = 0;
  for (const Stratum& stratum : strata) {
    const auto n = static_cast<double>(stratum.chosen.size());
    const auto size = static_cast<double>(stratum.size());
    double sum = 0.0;
    double squares = 0.0;
    for (const std::uint64_t packet : stratum.chosen) {
      const double residue = measured[at++] - ratio * static_cast<double>(known[packet]);
      sum += residue;
      squares += residue * residue;
    }
    if (stratum.chosen.size() > 1) {
      const double spread = std::max(0.0, (squares - sum * sum / n) / (n - 1.0));
      variance += size * size * (1.0 - n / size) * spread / n;
    }
  }
  if (chosen == known.size()) {
    estimate.total = sum_measured;
  } else if (chosen <= strata.size() || estimate.total == 0.0) {
    estimate.half_width = std::numeric_limits<double>::infinity();
  } else {
    estimate.half_width = student_95(chosen - strata.size()) * std::sqrt(variance) / estimate.total;
  }
  return estimate;
}

namespace {

// Words of the packets replayed, and roughly of those that warm the caches: with full warming all packets
// before the last one, else `warm_up` packets before each.
std::uint64_t words_walked(const processors::PacketSample& sample, std::span<const std::uint64_t> words,
                           std::uint32_t nodes, std::uint64_t warm_up) {
  std::uint64_t walked = 0;
  for (const std::uint64_t packet : sample.chosen()) {
    walked += words[packet];
    if (warm_up != processors::PacketSample::all_before) {
      sample.for_each_warmed(0, packet, nodes, [&](std::uint64_t before) { walked += words[before]; });
    }
  }
  for (std::uint64_t packet = 0; packet < sample.chosen().back(); ++packet) {
    const bool warms = warm_up == processors::PacketSample::all_before && !sample.has(packet);
    walked += warms ? words[packet] : 0;
  }
  return walked;
}

}  // namespace

Estimate estimate_by_sample(const processors::WorkLog& log, const processors::MachineConfig& machine,
                            const SampleOptions& options) {
  processors::check_sampled(machine);
  const std::vector<std::uint64_t> words = processors::words_of_packets(log, machine.packets);
  const std::uint64_t packets = words.size();
  const std::uint64_t wanted = std::max((packets + options.one_in - 1) / options.one_in,
                                        least_sampled_a_node * std::uint64_t{machine.all_nodes()});
  const std::vector<Stratum> strata =
      draw_strata(packets, std::max(wanted, std::min<std::uint64_t>(packets, 2)), options.seed);
  std::vector<std::uint64_t> chosen;
  for (const Stratum& stratum : strata) {
    chosen.insert(chosen.end(), stratum.chosen.begin(), stratum.chosen.end());
  }
  const processors::PacketSample sample(chosen, packets, options.warm_up);
  const processors::MachineResult result = processors::replay(log, machine, {.sample = &sample});

  std::vector<double> times;
  std::vector<double> misses;
  std::vector<double> references;
  Estimate estimate;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const processors::PacketFigures& figures = result.packet_figures[i];
    times.push_back(static_cast<double>(figures.time));
    misses.push_back(static_cast<double>(figures.misses));
    references.push_back(static_cast<double>(figures.references));
  }
  const RatioEstimate time = ratio_estimate(strata, words, times);
  const RatioEstimate missed = ratio_estimate(strata, words, misses);
  estimate.value = figures_of(machine, result);
  estimate.events = result.events;
  estimate.words = words_walked(sample, words, machine.all_nodes(), options.warm_up);
  estimate.references = ratio_estimate(strata, words, references).total;
  if (chosen.size() == packets) {
    return estimate;
  }

  // The time of packets that were not replayed is estimated from their words.
  double all_words = 0.0;
  for (const std::uint64_t count : words) {
    all_words += static_cast<double>(count);
  }
  const double each_word = all_words > 0.0 ? time.total / all_words : 0.0;
  std::vector<sim::Ticks> packet_times(packets);
  for (std::uint64_t packet = 0; packet < packets; ++packet) {
    packet_times[packet] = std::llround(each_word * static_cast<double>(words[packet]));
  }
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    packet_times[chosen[i]] = result.packet_figures[i].time;
  }
  auto end = static_cast<double>(schedule_packets(machine.host, machine.all_nodes(), packet_times));
  const auto part =
      static_cast<double>(result.references().all_misses()) + static_cast<double>(result.pixels);
  const double whole = missed.total + static_cast<double>(log.width) * static_cast<double>(log.height);
  // The frame cannot end before the links have carried all of its transfers.
  const double busy = estimate.value[Figure::use] * static_cast<double>(result.end) * whole / part;
  end = std::max(end, busy);
  estimate.value[Figure::use] = end > 0.0 ? busy / end : 0.0;
  estimate.value[Figure::end] = end;
  estimate.value[Figure::misses] = missed.total;
  estimate.half_width[Figure::end] = time.half_width;
  estimate.half_width[Figure::misses] = missed.half_width;
  estimate.half_width[Figure::use] =
      estimate.value[Figure::use] * std::max(time.half_width, missed.half_width);
  return estimate;
}

}  // namespace marti::studies
