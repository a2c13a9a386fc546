// What a sweep says in sentences: the fastest machine, the one that is worth its price, what would
// help them, and which axis to turn.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "studies/report/model/report_points.h"

namespace marti::studies::report {

/// Indices into ReportPoints::points.
struct Chosen {
  std::size_t fastest = 0;         ///< the shortest frame; of equal ones the cheapest, then the first
  std::size_t knee = 0;            ///< of the front, the machine where more money begins to buy less
  std::vector<std::size_t> front;  ///< that no other beats in price and frame time, ascending by price
  /// That no other beats in energy and frame time, ascending by energy; empty if none has an energy.
  std::vector<std::size_t> energy_front;
  std::optional<double> budget;       ///< as given
  std::optional<std::size_t> within;  ///< the fastest whose price is within it
};

/// Among the machines of one frame, the one with the shortest time of all: frames of different work are not
/// compared. The price is the cost by [prices], or the number of nodes where all costs are equal. The knee is
/// the point of the front that lies farthest below the line from its first to its last, both in logarithms;
/// the price as it is where a machine of the front is free.
[[nodiscard]] Chosen choose(const ReportPoints& sweep, std::optional<double> budget = std::nullopt);

/// "machine.nodes = 16, cache.size = 16 KiB".
[[nodiscard]] std::string place_text(const ReportPoints& sweep, const ReportPoint& point);

[[nodiscard]] std::vector<std::string> answer_of(const ReportPoints& sweep, const Chosen& chosen);

}  // namespace marti::studies::report
