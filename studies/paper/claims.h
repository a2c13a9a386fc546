// The statements of the 1992 paper beside what the study measured.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "studies/paper/building_table.h"
#include "studies/paper/traced_run.h"
#include "studies/paper/tree_table.h"
#include "studies/results/table.h"

namespace marti::studies {

/// in_part: agrees, but not under the conditions that the paper recommends.
enum class Verdict : std::uint8_t { agrees, in_part, differs, not_measured };

/// "agrees", "in part", "differs", "not measured".
[[nodiscard]] std::string_view name_of(Verdict verdict);

struct Claim {
  std::string subject;
  std::string paper;  ///< what it says
  std::string here;   ///< what was measured
  Verdict verdict = Verdict::not_measured;
};

/// The claims about trees and accesses. A claim about a scene that the study did not measure has the verdict
/// not_measured.
[[nodiscard]] std::vector<Claim> check_tree_claims(std::span<const SceneTrees> scenes);
[[nodiscard]] std::vector<Claim> check_access_claims(std::span<const TracedRun> runs);

/// The claims about trees that are built while they are used.
[[nodiscard]] std::vector<Claim> check_build_claims(std::span<const RunOutcomes> runs);

/// "claims": one row each.
[[nodiscard]] Table claim_table(std::span<const Claim> claims);

/// The claims as a list for people.
[[nodiscard]] std::string text_of(std::span<const Claim> claims);

}  // namespace marti::studies
