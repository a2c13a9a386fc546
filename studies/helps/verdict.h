// What a measurement says in words.
#pragma once

#include <string>
#include <utility>

#include "studies/figures/figure_parts.h"
#include "studies/helps/what_helps.h"

namespace marti::studies::helps {

/// The order of helps: the larger, the better the advice. A step that is worth naming comes before one that
/// is not; with prices a step that raises no price comes first, by the share it saves, and behind it those
/// that do, by the share they save for each unit of the price.
[[nodiscard]] std::pair<int, double> worth(const Help& help);
/// This order, for a step that saves this share of the frame and raises the price by `price`, which is 0
/// without prices.
[[nodiscard]] std::pair<int, double> worth(double saved, double price);

// Everywhere `counts` are the counted figures of the result.

/// About how much of the frame a step of this resource saves, a first guess that needs no replay: what the
/// resource takes of the time grows shorter by its factor, and no frame is shorter than its busiest
/// bus, bank or link is busy.
[[nodiscard]] double expected_saving(const Help& help, double factor,
                                     const processors::machine::MachineConfig& machine,
                                     const processors::replay::MachineResult& result,
                                     const figures::Counts& counts);

/// Why the part matters: how busy it is, or what share of the nodes' time it takes.
[[nodiscard]] std::string why(const Help& help, const processors::machine::MachineConfig& machine,
                              const processors::replay::MachineResult& result, const figures::Counts& counts);

/// The sentence of `what`, without a full stop.
[[nodiscard]] std::string verdict(const WhatHelps& what, const processors::machine::MachineConfig& machine,
                                  const processors::replay::MachineResult& result,
                                  const figures::Counts& counts);

}  // namespace marti::studies::helps
