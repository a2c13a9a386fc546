// A log as ranks send it.
#pragma once

#include <memory>
#include <string>

#include "studies/sweep/sweep_worker.h"

namespace marti::studies {

/// Of a frame whose log is on the site's shelf.
[[nodiscard]] std::string log_bytes(const SweepSite& site, std::size_t frame);
/// Brings the log to the site's shelf.
void put_log(const SweepSite& site, std::size_t frame, std::string_view bytes);

/// What two ranks must agree on: program, frames and machines, the content of scenes included.
[[nodiscard]] std::string digest_of(const SweepPlan& plan);

}  // namespace marti::studies
