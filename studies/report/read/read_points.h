// The timed points of a sweep's store.
#pragma once

#include <filesystem>

#include "studies/report/model/report_points.h"

namespace marti::studies::report {

/// Figures of a point are those of the catalogue, and "price" (the cost by [prices], or the number of nodes
/// where all costs are equal). Times are from 1 ps to 2^62 ps, other figures that the store holds from 0 to
/// 2^62, and no two points have the same values. Throws UserError when the store cannot be read, holds no
/// timed point, more than a page can show, or a point that is not so, which it names by its ordinal.
[[nodiscard]] ReportPoints read_report_points(const std::filesystem::path& store);

}  // namespace marti::studies::report
