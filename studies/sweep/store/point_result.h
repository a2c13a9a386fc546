// A point of a sweep as a result.json has a run: its settings, its figures, the histograms of its waits. What
// reads results of runs reads points from it.
#pragma once

#include <cstdint>
#include <string>

#include "studies/sweep/store/sweep_reader.h"
#include "studies/tables/run_json.h"

namespace marti::studies::sweep {

/// `name` is that of the point on the command line, for messages. Throws UserError when the point has not
/// been run yet, or there is no such point.
[[nodiscard]] tables::RunJson point_result(const SweepReader& sweep, std::int64_t ordinal,
                                           const std::string& name);

}  // namespace marti::studies::sweep
