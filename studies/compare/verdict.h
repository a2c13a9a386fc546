// What a comparison says in sentences: which is faster, by how much and why.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "studies/compare/comparison.h"

namespace marti::studies::compare {

/// The most important sentence first. Of frames that differ it says what differs in them, and not that a
/// machine is faster. Two results without a frame time have none.
[[nodiscard]] std::vector<std::string> verdict_of(const Comparison& found);

/// What would make each frame shorter, where it is recorded; of two results.
[[nodiscard]] std::vector<std::string> helps_of(const Comparison& found);

/// The geometric mean of the ratios B / A of the comparable points; std::nullopt without one.
[[nodiscard]] std::optional<double> mean_ratio(const Comparison& found);

}  // namespace marti::studies::compare
