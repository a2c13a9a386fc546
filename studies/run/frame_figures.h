// The figures of a frame: of its scene, structure, rays and work log. They are the columns of table
// `frame_results` of a sweep's store, and fields of `figures.frame` in result.json.
#pragma once

#include <span>

#include "studies/figures/figure_parts.h"
#include "studies/run/functional_run.h"

namespace marti::studies::run {

/// In order; all are counted.
[[nodiscard]] std::span<const figures::FigureEntry> frame_figures();

/// One value for each of frame_figures(). Throws InternalError when the run has no work log.
[[nodiscard]] figures::Counts frame_counts(const FunctionalRun& run);

}  // namespace marti::studies::run
