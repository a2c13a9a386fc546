// The paper's statements about parallel machines beside what the study measured. (McNeill et al. 1992,
// section 3; the space-parallel one after Birtwistle, Cleary, Wyvill, Vatti 1986.)
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "studies/paper/claims.h"
#include "studies/schemes/scaling_table.h"
#include "studies/schemes/tree_tables.h"

namespace marti::studies::schemes {

/// The largest number of nodes with an efficiency of at least one half, between the measured ones by a
/// straight line in log(nodes), which begins at one node's efficiency of 1; std::nullopt when it never falls
/// so far.
[[nodiscard]] std::optional<double> half_efficiency_nodes(std::span<const ScalingPoint> machine);

/// Statements whose machines were not timed have the verdict not_measured.
[[nodiscard]] std::vector<tables::Claim> check_arguments(std::span<const ScalingPoint> points,
                                                         std::span<const CellPoint> cells,
                                                         std::span<const StagePoint> stages);

}  // namespace marti::studies::schemes
