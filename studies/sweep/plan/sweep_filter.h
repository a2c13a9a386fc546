// The filter of a sweep, evaluated by SQLite.
#pragma once

#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Statement.h>

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "sim/error.h"
#include "sim/schema.h"
#include "studies/sweep/plan/filter_text.h"

namespace marti::studies::sweep {

/// Decides point by point. The expression is SQLite's, over values and functions only: no table can be read.
class SweepFilter {
 public:
  /// See translate_filter. Throws a UserError at `place` for a text that is not an expression.
  SweepFilter(const sim::Schema& schema, std::string_view text, bool points, const sim::Place& place);

  /// The columns it compares: indices of keys, or FilterText::point, whose value is a text.
  [[nodiscard]] std::span<const std::size_t> columns() const { return text_.columns; }

  /// Is the expression true (not false, not null) for these values, one for each of columns()? Sizes are in
  /// bytes, frequencies in hertz, durations in ticks, percentages fractions, booleans 0 or 1. Throws
  /// UserError when it cannot be computed.
  [[nodiscard]] bool passes(std::span<const sim::Value> values);

 private:
  [[noreturn]] void fail(const char* what, const SQLite::Exception& error) const;

  FilterText text_;
  sim::Place place_;
  SQLite::Database database_;
  std::optional<SQLite::Statement> statement_;
};

}  // namespace marti::studies::sweep
