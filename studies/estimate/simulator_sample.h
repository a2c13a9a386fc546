// Estimates from a stratified random sample of packets.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "processors/machine/machine_config.h"
#include "processors/program/work_log.h"
#include "studies/estimate/simulator_figures.h"

namespace marti::studies {

/// A stratum: the packets first .. end - 1 in the order in which the host hands them out, of which
/// chosen[0 .. ] are in the sample.
struct Stratum {
  std::uint64_t first = 0;
  std::uint64_t end = 0;
  std::vector<std::uint64_t> chosen;  ///< ascending
  [[nodiscard]] std::uint64_t size() const { return end - first; }
};

/// Cuts `packets` packets into strata of nearly equal size and draws two from each at random, three from some
/// when `wanted` is odd: two are the fewest that show the variance in a stratum. A stratum of fewer packets
/// than are drawn is taken whole. `wanted` is at least 1; if it is below 4, there is one stratum.
[[nodiscard]] std::vector<Stratum> draw_strata(std::uint64_t packets, std::uint64_t wanted,
                                               std::uint64_t seed);

/// A total over all packets, estimated with the help of what is known of every packet.
struct RatioEstimate {
  double total = 0.0;
  double half_width = 0.0;  ///< of the 95 % interval, relative to the total
};

/// The combined ratio estimator (W. G. Cochran, "Sampling techniques", 3rd ed. 1977, section 6.11): `known`
/// of all packets, `measured` of the strata's chosen ones, in order. Its variance is 6.51 there; the interval
/// takes Student's distribution, with chosen packets less strata as its degrees of freedom. If all packets
/// are chosen, the result is the total, with half-width 0; without a degree of freedom the half-width is
/// infinite.
[[nodiscard]] RatioEstimate ratio_estimate(std::span<const Stratum> strata,
                                           std::span<const std::uint64_t> known,
                                           std::span<const double> measured);

/// A sample has at least so many packets for each node: with fewer, the contention between nodes is not that
/// of the whole frame.
inline constexpr std::uint64_t least_sampled_a_node = 2;

struct SampleOptions {
  std::uint64_t one_in = 8;   ///< packets for each that is replayed, at least 1
  std::uint64_t warm_up = 0;  ///< packets that warm the caches before each (processors/walk/packet_sample.h)
  std::uint64_t seed = 1;
};

/// Replays a sample of `machine`'s packets, at least two and least_sampled_a_node. With one_in = 1 all
/// packets are replayed, and the result is exact. Times of the other packets are estimated from the number of
/// their words in the log. The frame time is that of a host that hands out packets of these times, or the
/// time that the interconnect needs for all transfers, if that is longer. Throws UserError for a machine that
/// processors::check_sampled() refuses.
[[nodiscard]] Estimate estimate_by_sample(const processors::WorkLog& log,
                                          const processors::MachineConfig& machine,
                                          const SampleOptions& options);

}  // namespace marti::studies
