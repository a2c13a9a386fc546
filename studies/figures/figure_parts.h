// Entries and values of figures, made in one go so that they cannot differ: one function describes the
// figures, without values, and fills in the values of a result.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/error.h"
#include "studies/figures/figure_entry.h"

namespace marti::studies::figures {

/// The value of a counted figure: an integer. One of 2^63 or more, which only a sum over nodes can be, is
/// rounded to the nearest that a double holds, because that is how stores and files have it.
using Count = sim::Sum;
/// No sum over nodes is above it: 2^24 nodes of 2^8 contexts wait for less than 2^63 ps each.
inline constexpr double largest_count = 0x1p95;
[[nodiscard]] inline Count rounded(Count sum) {
  const auto fits = static_cast<std::int64_t>(sum);
  return fits == sum ? sum : static_cast<Count>(static_cast<double>(sum));
}

/// The values of counted figures, one for each entry; std::nullopt where a machine has no such part.
using Counts = std::vector<std::optional<Count>>;

/// Calls visit(name, value) for each that has a value.
template <class Visit>
void for_each_count(std::span<const FigureEntry> entries, const Counts& counts, Visit&& visit) {
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (counts[i]) {
      visit(entries[i].name, *counts[i]);
    }
  }
}

class FigureParts {
 public:
  /// Describes figures when `entries` is not null, else collects values.
  explicit FigureParts(std::vector<FigureEntry>* entries) : entries_(entries) {}

  struct Description {
    std::string_view unit;
    std::string_view text;
    Merge merge = Merge::sum;
    Better better = Better::lower;
  };
  void add(std::string_view prefix, std::string_view name, const Description& description,
           std::optional<Count> value) {
    if (entries_ != nullptr) {
      entries_->push_back({std::string(prefix) + std::string(name), std::string(description.unit),
                           std::string(description.text), description.merge, description.better});
    } else {
      values_.push_back(value ? std::optional(rounded(*value)) : std::nullopt);
    }
  }
  void add(std::string_view name, const Description& description, std::optional<Count> value) {
    add("", name, description, value);
  }
  /// A count that must fit.
  void add_count(std::string_view name, const Description& description, std::optional<std::uint64_t> value) {
    sim::ensure(!value || *value <= static_cast<std::uint64_t>(INT64_MAX), "a counted figure overflowed");
    add("", name, description, value);
  }
  /// Every declared counter of a part, or of the sums of many; without values for std::nullopt. `whose` goes
  /// before the descriptions.
  template <class S>
  void add_all(std::string_view prefix, std::string_view whose, const std::optional<S>& statistics) {
    const auto enter = [&](const auto& counter, Count value) {
      const std::string text =
          entries_ == nullptr ? std::string() : std::string(whose) + ": " + std::string(counter.description);
      const Merge merge = counter.rule == sim::MergeRule::maximum ? Merge::largest : Merge::sum;
      add(prefix, counter.name, {counter.unit, text, merge, counter.better},
          statistics ? std::optional(value) : std::nullopt);
    };
    const S counted = statistics.value_or(S{});
    if constexpr (sim::HasCounters<S>) {
      sim::for_each_counter(counted, enter);
    } else {
      counted.for_each(enter);
    }
  }

  [[nodiscard]] Counts take_values() { return std::move(values_); }

 private:
  std::vector<FigureEntry>* entries_;
  Counts values_;
};

}  // namespace marti::studies::figures
