// [question] of a sweep: what it asks, and the SQL queries that answer it from the sweep's points.
#pragma once

#include <string>
#include <vector>

#include "sim/config.h"
#include "sim/error.h"

namespace marti::studies::sweep {

/// A SELECT over the table `points`, whose columns are those of points.csv (tables/query_sandbox.h).
struct Query {
  std::string sql;   ///< empty: none is given
  sim::Place place;  ///< in the configuration, for messages
};

struct QuestionTable {
  std::string name;  ///< lower-case letters, digits and '_'
  std::string title;
  Query rows;
};

struct QuestionClaim {
  std::string subject;  ///< what it is about
  std::string says;     ///< what somebody says of it
  Query here;           ///< what the points say: the first column of the first row
  Query agrees;         ///< 1: they agree; 0: they do not; null: they cannot tell
};

struct Question {
  std::string asks;  ///< one line; empty: there is no [question]
  Query answer;      ///< a sentence in the first column of each row
  std::vector<QuestionTable> tables;
  std::vector<QuestionClaim> claims;
};

/// Reads the free section "question". Throws UserError naming file, line and key. Queries are not run, or
/// even parsed.
[[nodiscard]] Question read_question(const sim::Config& config);

}  // namespace marti::studies::sweep
