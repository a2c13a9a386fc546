// What a user writes as sweep.filter, as an SQL expression.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "sim/error.h"
#include "sim/schema.h"

namespace marti::studies::sweep {

/// An expression whose columns are quoted names: of keys, or "point".
struct FilterText {
  /// Index of the column that is not a key but holds the name of a named point.
  static constexpr std::size_t point = static_cast<std::size_t>(-1);

  std::string sql;
  std::vector<std::size_t> columns;  ///< indices into the schema's keys, or `point`; each once
};

/// Translates an expression of SQLite's language over dotted names of keys, `point`, numbers with units
/// ("64 KiB", "33 MHz", "10 ns"; they become bytes, hertz and ticks), texts in single quotation marks, the
/// words and, or, not, in, between, is, null, like, glob, case, when, then, else, end, true and false, and
/// functions that only compute. Anything else, with it every query, comment and second statement, is refused
/// with a UserError at `place`. `points`: are there named points?
[[nodiscard]] FilterText translate_filter(const sim::Schema& schema, std::string_view text, bool points,
                                          const sim::Place& place);

/// May the filter call this function? Names are in lower case.
[[nodiscard]] bool is_filter_function(std::string_view name);

}  // namespace marti::studies::sweep
