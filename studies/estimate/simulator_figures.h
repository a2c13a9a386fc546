// The counters of a timed machine that cheaper methods estimate.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string_view>

#include "processors/machine/machine_config.h"
#include "processors/replay/replay.h"

namespace marti::studies::estimate {

/// What is estimated. Errors of all but `use` are relative to the true value; that of `use` is a difference.
enum class Figure : std::uint8_t {
  end,       ///< frame time, ps
  speed_up,  ///< over the same machine with one node
  misses,    ///< of the private caches
  use,       ///< share of the frame in which the interconnect's links were busy
  wait       ///< mean wait of a transaction for the interconnect, ps
};
inline constexpr std::size_t figure_count = 5;
inline constexpr std::array<std::string_view, figure_count> figure_names = {"end", "speed_up", "misses",
                                                                            "use", "wait"};

/// One value for each figure. For a single machine the speed-up is 0: it compares two machines.
class MachineFigures {
 public:
  double& operator[](Figure figure) { return values_[static_cast<std::size_t>(figure)]; }
  double operator[](Figure figure) const { return values_[static_cast<std::size_t>(figure)]; }
  friend bool operator==(const MachineFigures&, const MachineFigures&) = default;

 private:
  std::array<double, figure_count> values_{};
};

/// What an estimate says: values, the half-widths of the 95 % intervals that the method itself states
/// (relative as errors are; 0 where it states none), and the work that it took.
struct Estimate {
  MachineFigures value;
  MachineFigures half_width;
  /// The misses of a frame in which a node has always just walked the same pixel: the interval of the misses
  /// begins no higher. Infinite where the method does not know them.
  double fewest_misses = std::numeric_limits<double>::infinity();
  double references = 0.0;   ///< lines touched by the machine in the whole frame; the method's own figure
  std::uint64_t events = 0;  ///< handled to get it
  std::uint64_t words = 0;   ///< of the log, walked to get it
};

/// The figures of a replay of all packets.
[[nodiscard]] MachineFigures figures_of(const processors::machine::MachineConfig& machine,
                                        const processors::replay::MachineResult& result);

/// The error of an estimate: relative, or for `use` a difference. With a true value of 0: 0 when the estimate
/// is 0 too, else infinite.
[[nodiscard]] double error_of(Figure figure, double estimate, double truth);

/// Adds the speed-up of `machine` over `one_node`, with the sum of both half-widths of the time.
void add_speed_up(Estimate& machine, const Estimate& one_node);

}  // namespace marti::studies::estimate
