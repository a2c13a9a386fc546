// The answer to a sweep's question, computed from its points.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "studies/sweep/plan/question.h"
#include "studies/sweep/store/sweep_reader.h"
#include "studies/tables/claim.h"
#include "studies/tables/table.h"

namespace marti::studies::sweep {

struct Answers {
  std::string asks;                 ///< empty: the sweep has no question
  std::vector<std::string> answer;  ///< sentences; none where the points do not give one
  std::vector<tables::Table> tables;
  std::vector<tables::Claim> claims;
};

/// Runs each query of the question on no points of these axes. Throws the UserError "FILE:LINE: KEY: reason"
/// for one that is wrong.
void check_question(const Question& question, std::span<const std::string> axes);

/// Runs the queries on the points that have been timed. Throws UserError, as check_question() does.
[[nodiscard]] Answers answers_of(const SweepReader& reader);

/// {"asks", "answer", "tables", "claims"}; null without a question.
[[nodiscard]] nlohmann::ordered_json answers_json(const Answers& answers);

/// The question and its answer, as lines of a summary; empty without a question.
[[nodiscard]] std::string answer_text(const Answers& answers);

/// Tables and claims, for people, each after an empty line; empty without any.
[[nodiscard]] std::string tables_text(const Answers& answers);

}  // namespace marti::studies::sweep
