// The filter of a sweep, evaluated by SQLite.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "sim/schema.h"
#include "studies/sweep/plan/filter_text.h"

namespace marti::studies {

/// Decides point by point. The expression is SQLite's, over values and functions only: no table can be read.
class SweepFilter {
 public:
  /// See translate_filter. Throws the UserError "place: message" for a text that is not an expression.
  SweepFilter(const sim::Schema& schema, std::string_view text, bool points, std::string_view place);
  ~SweepFilter();
  SweepFilter(SweepFilter&&) noexcept;
  SweepFilter& operator=(SweepFilter&&) = delete;

  /// The columns it compares: indices of keys, or FilterText::point, whose value is a text.
  [[nodiscard]] std::span<const std::size_t> columns() const;

  /// Is the expression true (not false, not null) for these values, one for each of columns()? Sizes are in
  /// bytes, frequencies in hertz, durations in ticks, percentages fractions, booleans 0 or 1. Throws
  /// UserError when it cannot be computed.
  [[nodiscard]] bool passes(std::span<const sim::Value> values);

 private:
  struct Statement;
  std::unique_ptr<Statement> statement_;
};

}  // namespace marti::studies
