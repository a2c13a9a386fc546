// A statement of a paper, or of anybody, beside what was measured.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "studies/tables/table.h"

namespace marti::studies::tables {

/// in_part: agrees, but not under the conditions that the paper recommends.
enum class Verdict : std::uint8_t { agrees, in_part, differs, not_measured };

/// "agrees", "in part", "differs", "not measured".
[[nodiscard]] std::string_view name_of(Verdict verdict);

/// agrees or differs.
[[nodiscard]] constexpr Verdict verdict_of(bool agrees) {
  return agrees ? Verdict::agrees : Verdict::differs;
}

struct Claim {
  std::string subject;
  std::string says;  ///< the statement
  std::string here;  ///< what was measured
  Verdict verdict = Verdict::not_measured;
};

/// "claims": one row each.
[[nodiscard]] Table claim_table(std::span<const Claim> claims);

/// The claims as a list for people.
[[nodiscard]] std::string text_of(std::span<const Claim> claims);

}  // namespace marti::studies::tables
