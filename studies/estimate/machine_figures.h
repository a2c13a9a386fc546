// The counters of a timed machine that a sample estimates.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>

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
struct MachineFigures {
  std::array<double, figure_count> values{};
  constexpr double& operator[](Figure figure) { return values[static_cast<std::size_t>(figure)]; }
  constexpr double operator[](Figure figure) const { return values[static_cast<std::size_t>(figure)]; }
  friend bool operator==(const MachineFigures&, const MachineFigures&) = default;
};

/// What a sample says: values, and the half-widths of their 95 % intervals (relative as errors are).
struct Estimate {
  MachineFigures value;
  MachineFigures half_width;
  /// The misses of a frame in which a node has always just walked the same pixel: the interval of the misses
  /// begins no higher.
  double fewest_misses = std::numeric_limits<double>::infinity();
  double references = 0.0;  ///< lines touched by the machine in the whole frame
};

}  // namespace marti::studies::estimate
