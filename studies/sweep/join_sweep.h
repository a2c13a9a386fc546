// `marti sweep` on a rank that does not hold the store.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "studies/sweep/ranks/ranks.h"
#include "studies/sweep/sweep.h"

namespace marti::studies {

/// What a rank makes of the configuration.
struct JoinedSweep {
  SweepPlan plan;
  std::uint64_t memory_limit = 0;
};

/// Takes part until rank 0 says that all is done. Work logs that do not fit in memory go to the directory of
/// the results or, if this computer does not have it, to the directory of temporary files.
void join_sweep(Ranks& ranks, const SweepOptions& options,
                const std::function<JoinedSweep(const std::string& configuration)>& read);

}  // namespace marti::studies
