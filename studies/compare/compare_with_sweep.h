// One result beside every point of a sweep.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "studies/compare/compare.h"
#include "studies/compare/figures.h"

namespace marti::studies {

/// Which of A and B the sweep is; the result is the other.
enum class SweepSide : std::uint8_t { a, b };

/// Frame times and settings of the points that have been timed, the shortest frame first. Throws UserError
/// when no point has been timed, and when the result or a point has no frame time.
[[nodiscard]] std::string compare_with_sweep(const ComparedResult& result, const std::filesystem::path& sweep,
                                             SweepSide side, const CompareOptions& options);

}  // namespace marti::studies
