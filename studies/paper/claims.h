// The statements of the 1992 paper beside what the study measured.
#pragma once

#include <span>
#include <vector>

#include "studies/paper/traced_run.h"
#include "studies/paper/tree_table.h"
#include "studies/tables/claim.h"

namespace marti::studies::paper {

/// The claims about trees and accesses. A claim about a scene that the study did not measure has the verdict
/// not_measured.
[[nodiscard]] std::vector<tables::Claim> check_tree_claims(std::span<const SceneTrees> scenes);
[[nodiscard]] std::vector<tables::Claim> check_access_claims(std::span<const TracedRun> runs);

}  // namespace marti::studies::paper
