// The nodes' time in so few parts that each has a colour of its own.
#pragma once

#include <array>
#include <functional>
#include <string_view>

namespace marti::studies::report {

inline constexpr std::size_t cycle_groups = 9;

/// In the order in which they are stacked; as names of columns.
inline constexpr std::array<std::string_view, cycle_groups> cycle_group_names = {"traversal",
                                                                                 "intersection",
                                                                                 "shading_and_building",
                                                                                 "cache_access_and_switching",
                                                                                 "transfer_and_bank",
                                                                                 "interconnect_wait",
                                                                                 "bank_wait",
                                                                                 "other_waits",
                                                                                 "idle"};

/// `of_activity` gives the time of an activity by its name (processors/cost/accounting.h). The parts' sum is
/// the sum of all activities.
[[nodiscard]] std::array<double, cycle_groups> group_cycles(
    const std::function<double(std::string_view)>& of_activity);

}  // namespace marti::studies::report
