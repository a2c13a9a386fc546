// Declared statistics. A component counts in a plain struct of members of 64 bits, or of 128 bits for times
// of many that run at the same time, and declares each member once, with name, unit and description, in a
// static constexpr function counters(). Ratios are never stored.
//
//   struct CacheCounters {
//     std::int64_t hits = 0;
//     std::int64_t misses = 0;
//     static constexpr auto counters() {
//       using C = Counter<CacheCounters>;
//       return std::array{C{"hits", "1", "lines found", &CacheCounters::hits, MergeRule::sum,
//       Better::higher},
//                         C{"misses", "1", "lines brought in", &CacheCounters::misses}};
//     }
//   };
//
// Counting is one raw increment. Merging is exact integer arithmetic, hence associative and commutative:
// the result does not depend on the number of threads. Statistics know no output format.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <type_traits>
#include <vector>

#include "sim/error.h"
#include "sim/time.h"

namespace marti::sim {

enum class MergeRule {
  sum,
  maximum,  // for a peak, such as the longest queue
};

/// Whether a machine with a lower or a higher value is the better one.
enum class Better : std::uint8_t {
  lower,
  higher,
  neither,  // it says how large something is
  program,  // it says how the program worked; it is no property of the machine
};

/// One declared counter. `unit` is "1" for a plain count, else "byte", "ps", "ps2", "cycle", ...
template <class S>
struct Counter {
  constexpr Counter(std::string_view name_, std::string_view unit_, std::string_view description_,
                    std::int64_t S::*member_, MergeRule rule_ = MergeRule::sum,
                    Better better_ = Better::lower)
      : name(name_), unit(unit_), description(description_), member(member_), rule(rule_), better(better_) {}
  constexpr Counter(std::string_view name_, std::string_view unit_, std::string_view description_,
                    Sum S::*sum_)
      : name(name_), unit(unit_), description(description_), sum(sum_) {}

  std::string_view name;
  std::string_view unit;
  std::string_view description;
  std::int64_t S::*member = nullptr;
  Sum S::*sum = nullptr;  ///< instead of `member`, of a time that may not fit in 64 bits when it is added up
  MergeRule rule = MergeRule::sum;
  Better better = Better::lower;

  [[nodiscard]] constexpr Sum value(const S& statistics) const {
    return sum != nullptr ? statistics.*sum : Sum{statistics.*member};
  }
  /// An InternalError when the value does not fit.
  constexpr void set(S& statistics, Sum value) const {
    if (sum != nullptr) {
      statistics.*sum = value;
    } else {
      ensure(value == static_cast<std::int64_t>(value), "a counter overflowed");
      statistics.*member = static_cast<std::int64_t>(value);
    }
  }
};

/// numerator / denominator; std::nullopt when the denominator is zero.
constexpr std::optional<double> ratio(std::int64_t numerator, std::int64_t denominator) {
  if (denominator == 0) {
    return std::nullopt;
  }
  return static_cast<double>(numerator) / static_cast<double>(denominator);
}

template <class S>
concept HasCounters = requires {
  { S::counters()[0].member } -> std::convertible_to<std::int64_t S::*>;
};

/// For structs with no members but counters: whether each member is declared exactly once. For static_assert.
template <HasCounters S>
constexpr bool declares_every_member() {
  constexpr auto table = S::counters();
  for (std::size_t i = 0; i < table.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if ((table[i].member == table[j].member && table[i].sum == table[j].sum) ||
          table[i].name == table[j].name) {
        return false;
      }
    }
  }
  std::size_t bytes = 0;
  for (const auto& counter : table) {
    bytes += counter.sum != nullptr ? sizeof(Sum) : sizeof(std::int64_t);
  }
  return sizeof(S) == (bytes + alignof(S) - 1) / alignof(S) * alignof(S);
}

template <HasCounters S>
constexpr bool has_sums() {
  constexpr auto table = S::counters();
  return std::ranges::any_of(table, [](const auto& counter) { return counter.sum != nullptr; });
}

/// Calls visit(const Counter<S>&, value) for each counter in the order of declaration. Values are Sum where
/// the struct has one, else std::int64_t.
template <HasCounters S, class Visitor>
void for_each_counter(const S& statistics, Visitor&& visit) {
  using Value = std::conditional_t<has_sums<S>(), Sum, std::int64_t>;
  constexpr auto table = S::counters();
  for (const auto& counter : table) {
    visit(counter, static_cast<Value>(counter.value(statistics)));
  }
}

/// Adds `from` to `into`. A count that does not fit in 64 bits is an InternalError.
template <HasCounters S>
void merge(S& into, const S& from) {
  constexpr auto table = S::counters();
  for (const auto& counter : table) {
    const Sum here = counter.value(into);
    const Sum more = counter.value(from);
    counter.set(into, counter.rule == MergeRule::maximum ? std::max(here, more) : here + more);
  }
}

/// The counters of many components of a kind, added up without a limit.
template <HasCounters S>
class Sums {
 public:
  void merge(const S& part) {
    std::size_t i = 0;
    for_each_counter(part, [&](const Counter<S>& counter, Sum value) {
      Sum& all = values_[i++];
      all = counter.rule == MergeRule::maximum ? std::max(all, value) : all + value;
    });
  }
  /// Calls visit(const Counter<S>&, Sum value) for each counter in the order of declaration.
  template <class Visitor>
  void for_each(Visitor&& visit) const {
    constexpr auto table = S::counters();
    for (std::size_t i = 0; i < table.size(); ++i) {
      visit(table[i], values_[i]);
    }
  }
  /// Of the counter of this name, which there must be.
  [[nodiscard]] Sum named(std::string_view name) const {
    std::optional<Sum> found;
    for_each([&](const Counter<S>& counter, Sum value) { found = counter.name == name ? value : found; });
    ensure(found.has_value(), "there is no such counter");
    return *found;
  }

 private:
  std::array<Sum, S::counters().size()> values_{};
};

/// Count, sum, sum of squares and extremes of int64 samples, all exact: 128 bits hold the sum and 192 the
/// sum of squares of any 2^63 samples. Mean and variance are rounded once, at the end; running means in
/// floating point freeze or lose all digits at large offsets.
class Moments {
 public:
  void add(std::int64_t sample) {
    ++count_;
    sum_ += sample;
    add_square(static_cast<Wide>(static_cast<__int128>(sample) * sample));
    minimum_ = std::min(minimum_, sample);
    maximum_ = std::max(maximum_, sample);
  }
  void merge(const Moments& other);

  [[nodiscard]] std::int64_t count() const { return count_; }
  /// The sum, or an InternalError when it does not fit in 64 bits.
  [[nodiscard]] std::int64_t sum() const;
  /// Zero if there are no samples.
  [[nodiscard]] std::int64_t minimum() const { return count_ == 0 ? 0 : minimum_; }
  [[nodiscard]] std::int64_t maximum() const { return count_ == 0 ? 0 : maximum_; }
  /// The mean; std::nullopt if there are no samples.
  [[nodiscard]] std::optional<double> mean() const;
  /// The variance of the samples themselves, E[x^2] - E[x]^2, computed as (n sum(x^2) - sum(x)^2) / n^2 in
  /// integers of 256 bits; std::nullopt if there are no samples.
  [[nodiscard]] std::optional<double> variance() const;

  friend bool operator==(const Moments&, const Moments&) = default;

 private:
  using Wide = unsigned __int128;
  void add_square(Wide square) {
    squares_ += square;
    squares_carry_ += squares_ < square ? 1U : 0U;
  }

  std::int64_t count_ = 0;
  std::int64_t minimum_ = INT64_MAX;
  std::int64_t maximum_ = INT64_MIN;
  std::uint64_t squares_carry_ = 0;  // the sum of squares is squares_carry_ 2^128 + squares_
  __int128 sum_ = 0;
  Wide squares_ = 0;
};

/// A histogram of samples >= 0: exact below 16, then with 8 buckets for each power of two, so that a bucket's
/// width is at most 12.5 % of its lower bound. Its memory grows with the logarithm of the largest sample (at
/// most 4 KB).
class LogHistogram {
 public:
  /// An InternalError when `sample` is negative.
  [[gnu::always_inline]] void add(std::int64_t sample) {
    const std::size_t bucket = bucket_of(sample);
    if (bucket >= buckets_.size()) [[unlikely]] {
      add_bucket(bucket);
    }
    ++buckets_[bucket];
    maximum_ = std::max(maximum_, sample);
  }
  /// Adds a sample `times` times, at least 0.
  void add_repeated(std::int64_t sample, std::int64_t times) {
    if (times == 0) {
      return;
    }
    add(sample);
    buckets_[bucket_of(sample)] += times - 1;
  }
  void merge(const LogHistogram& other);

  /// The sum over all buckets, which is not kept. An InternalError when it does not fit in 64 bits.
  [[nodiscard]] std::int64_t count() const;
  /// The largest sample, exact; zero if there are no samples.
  [[nodiscard]] std::int64_t maximum() const { return maximum_; }
  /// The p-th percentile by nearest rank, 0 < p <= 100: never below the exact value and at most 12.5 % above
  /// it; percentile(100) is the maximum. std::nullopt if there are no samples.
  [[nodiscard]] std::optional<std::int64_t> percentile(double p) const;

  struct Bucket {
    std::int64_t lowest = 0;  // smallest and largest sample that falls into it
    std::int64_t highest = 0;
    std::int64_t count = 0;
  };
  /// The buckets that are not empty, in ascending order.
  [[nodiscard]] std::vector<Bucket> buckets() const;

  /// Of a negative sample one that no other has.
  static std::size_t bucket_of(std::int64_t sample) {
    const auto value = static_cast<std::uint64_t>(sample);
    // The bits below the leading four. Without a branch: whether a sample is small is often not predictable.
    const auto dropped = static_cast<unsigned>(std::bit_width(value | 8U)) - 4;
    return std::size_t{8} * dropped + static_cast<std::size_t>(value >> dropped);
  }
  static std::int64_t lowest_of(std::size_t bucket);
  static std::int64_t highest_of(std::size_t bucket);

  friend bool operator==(const LogHistogram&, const LogHistogram&) = default;

 private:
  // Makes room for a bucket, or fails for that of a negative sample.
  [[gnu::noinline]] void add_bucket(std::size_t bucket);

  std::vector<std::int64_t> buckets_;  // up to the last non-empty one
  std::int64_t maximum_ = 0;
};

}  // namespace marti::sim
