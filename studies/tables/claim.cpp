#include "studies/tables/claim.h"

#include <fmt/format.h>

#include "sim/error.h"

namespace marti::studies::tables {

std::string_view name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::agrees:
      return "agrees";
    case Verdict::in_part:
      return "in part";
    case Verdict::differs:
      return "differs";
    case Verdict::not_measured:
      return "not measured";
  }
  throw sim::InternalError("an unknown verdict");
}

Table claim_table(std::span<const Claim> claims) {
  Table table("claims", "Statements beside what was measured",
              {text_column("subject", "what it is about"), text_column("says", "what is said of it"),
               text_column("here", "what was measured"),
               text_column("verdict", "agrees, in part, differs, or not measured")});
  for (const Claim& claim : claims) {
    table.add_row(
        {claim.subject, claim.says, claim.here.empty() ? Cell() : Cell(claim.here), name_of(claim.verdict)});
  }
  return table;
}

std::string text_of(std::span<const Claim> claims) {
  std::string text = "Statements beside what was measured\n";
  for (const Claim& claim : claims) {
    text +=
        fmt::format("  {:12}  {}\n                says: {}\n                here: {}\n",
                    name_of(claim.verdict), claim.subject, claim.says, claim.here.empty() ? "-" : claim.here);
  }
  return text;
}

}  // namespace marti::studies::tables
