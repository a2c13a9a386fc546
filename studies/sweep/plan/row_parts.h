// Columns and values of a row, made in one go so that they cannot differ: the same function describes the
// columns, without values, and fills in the values of a row.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/error.h"
#include "sim/statistics.h"
#include "studies/tables/table.h"

namespace marti::studies {

class RowParts {
 public:
  /// Describes columns when `columns` is not null, else collects values.
  explicit RowParts(std::vector<Column>* columns) : columns_(columns) {}

  void add(std::string_view prefix, std::string_view name, std::string_view unit,
           std::string_view description, std::optional<std::int64_t> value) {
    if (columns_ != nullptr) {
      columns_->push_back({std::string(prefix) + std::string(name), ColumnType::integer, std::string(unit),
                           std::string(description)});
    } else {
      values_.push_back(value);
    }
  }
  void add(std::string_view name, std::string_view unit, std::string_view description,
           std::optional<std::int64_t> value) {
    add("", name, unit, description, value);
  }
  /// A count that must fit.
  void add_count(std::string_view name, std::string_view unit, std::string_view description,
                 std::optional<std::uint64_t> value) {
    sim::ensure(!value || *value <= static_cast<std::uint64_t>(INT64_MAX), "a counter of a row overflowed");
    add("", name, unit, description, value ? std::optional(static_cast<std::int64_t>(*value)) : std::nullopt);
  }
  /// Every declared counter; without values for std::nullopt. `whose` goes before the descriptions.
  template <class S>
  void add_all(std::string_view prefix, std::string_view whose, const std::optional<S>& statistics) {
    const S counted = statistics.value_or(S{});
    sim::for_each_counter(counted, [&](const sim::Counter<S>& counter, std::int64_t value) {
      const std::string description =
          columns_ == nullptr ? std::string()
                              : std::string(whose) + ": " + std::string(counter.description) +
                                    (counter.rule == sim::MergeRule::maximum ? " (the largest)" : "");
      add(prefix, counter.name, counter.unit, description, statistics ? std::optional(value) : std::nullopt);
    });
  }

  [[nodiscard]] std::vector<std::optional<std::int64_t>> take_values() { return std::move(values_); }

 private:
  std::vector<Column>* columns_;
  std::vector<std::optional<std::int64_t>> values_;
};

}  // namespace marti::studies
