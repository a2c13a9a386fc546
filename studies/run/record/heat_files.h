// The files of a heat map.
#pragma once

#include "studies/run/record/heat_map.h"
#include "studies/tables/pending_files.h"

namespace marti::studies::run {

/// Adds heat.exr, with a channel for each Heat, and heat-cycles.png, heat-misses.png and heat-waits.png in
/// false colours. Throws UserError with the reason.
void add_heat_files(const HeatMap& map, tables::PendingFiles& files);

}  // namespace marti::studies::run
