#include "sim/statistics.h"

#include <cmath>
#include <limits>

namespace marti::sim {

namespace {

/// An unsigned number of 256 bits, least significant limb first, with the operations for an exact variance.
struct Number256 {
  std::array<std::uint64_t, 4> limbs{};
};

/// a * b modulo 2^256.
Number256 multiply(const Number256& a, const Number256& b) {
  Number256 product;
  for (std::size_t i = 0; i < 4; ++i) {
    unsigned __int128 carry = 0;
    for (std::size_t j = 0; i + j < 4; ++j) {
      carry += static_cast<unsigned __int128>(a.limbs[i]) * b.limbs[j] + product.limbs[i + j];
      product.limbs[i + j] = static_cast<std::uint64_t>(carry);
      carry >>= 64;
    }
  }
  return product;
}

/// a - b for a >= b.
Number256 subtract(const Number256& a, const Number256& b) {
  Number256 result;
  std::uint64_t borrow = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const unsigned __int128 take = static_cast<unsigned __int128>(b.limbs[i]) + borrow;
    result.limbs[i] = a.limbs[i] - static_cast<std::uint64_t>(take);
    borrow = a.limbs[i] < take ? 1 : 0;
  }
  return result;
}

long double to_real(const Number256& number) {
  long double value = 0;
  for (std::size_t i = 4; i-- > 0;) {
    value = value * 0x1p64L + static_cast<long double>(number.limbs[i]);
  }
  return value;
}

Number256 widen(unsigned __int128 low, std::uint64_t high = 0) {
  return {{static_cast<std::uint64_t>(low), static_cast<std::uint64_t>(low >> 64), high, 0}};
}

}  // namespace

void Moments::merge(const Moments& other) {
  ensure(!__builtin_add_overflow(count_, other.count_, &count_), "a count of samples overflowed");
  sum_ += other.sum_;
  add_square(other.squares_);
  squares_carry_ += other.squares_carry_;
  minimum_ = std::min(minimum_, other.minimum_);
  maximum_ = std::max(maximum_, other.maximum_);
}

std::int64_t Moments::sum() const {
  const auto narrow = static_cast<std::int64_t>(sum_);
  ensure(narrow == sum_, "a sum of samples does not fit in 64 bits");
  return narrow;
}

std::optional<double> Moments::mean() const {
  if (count_ == 0) {
    return std::nullopt;
  }
  // Quotient and remainder are converted separately, as the sum may have more bits than a long double.
  const __int128 whole = sum_ / count_;
  const __int128 rest = sum_ % count_;
  return static_cast<double>(static_cast<long double>(whole) +
                             static_cast<long double>(rest) / static_cast<long double>(count_));
}

std::optional<double> Moments::variance() const {
  if (count_ == 0) {
    return std::nullopt;
  }
  const Number256 n = widen(static_cast<Wide>(count_));
  const Number256 magnitude = widen(static_cast<Wide>(sum_ < 0 ? -sum_ : sum_));
  const Number256 spread =
      subtract(multiply(widen(squares_, squares_carry_), n), multiply(magnitude, magnitude));
  const auto divisor = static_cast<long double>(count_);
  return static_cast<double>(to_real(spread) / divisor / divisor);
}

void LogHistogram::merge(const LogHistogram& other) {
  if (other.buckets_.size() > buckets_.size()) {
    add_bucket(other.buckets_.size() - 1);
  }
  for (std::size_t i = 0; i < other.buckets_.size(); ++i) {
    ensure(!__builtin_add_overflow(buckets_[i], other.buckets_[i], &buckets_[i]),
           "a count of samples overflowed");
  }
  maximum_ = std::max(maximum_, other.maximum_);
}

std::int64_t LogHistogram::count() const {
  std::int64_t count = 0;
  for (const std::int64_t bucket : buckets_) {
    ensure(!__builtin_add_overflow(count, bucket, &count), "a count of samples overflowed");
  }
  return count;
}

void LogHistogram::add_bucket(std::size_t bucket) {
  ensure(bucket <= bucket_of(INT64_MAX), "a histogram takes no negative sample");
  buckets_.resize(bucket + 1);
}

std::int64_t LogHistogram::lowest_of(std::size_t bucket) {
  if (bucket < 16) {
    return static_cast<std::int64_t>(bucket);
  }
  const std::size_t octave = (bucket - 16) / 8;  // of samples from 2^(octave + 4) on
  const std::size_t part = (bucket - 16) % 8;
  return static_cast<std::int64_t>(8 + part) << (octave + 1);
}

std::int64_t LogHistogram::highest_of(std::size_t bucket) {
  if (bucket == bucket_of(std::numeric_limits<std::int64_t>::max())) {
    return std::numeric_limits<std::int64_t>::max();
  }
  return lowest_of(bucket + 1) - 1;
}

std::optional<std::int64_t> LogHistogram::percentile(double p) const {
  ensure(p > 0 && p <= 100, "a percentile lies above 0 and not above 100");
  const std::int64_t all = count();
  if (all == 0) {
    return std::nullopt;
  }
  const auto exact = std::ceil(static_cast<long double>(p) / 100 * static_cast<long double>(all));
  const auto rank = std::clamp<std::int64_t>(static_cast<std::int64_t>(exact), 1, all);
  std::int64_t seen = 0;
  for (std::size_t i = 0; i < buckets_.size(); ++i) {
    seen += buckets_[i];
    if (seen >= rank) {
      return std::min(highest_of(i), maximum_);
    }
  }
  return maximum_;
}

std::vector<LogHistogram::Bucket> LogHistogram::buckets() const {
  std::vector<Bucket> filled;
  for (std::size_t i = 0; i < buckets_.size(); ++i) {
    if (buckets_[i] != 0) {
      filled.push_back({lowest_of(i), highest_of(i), buckets_[i]});
    }
  }
  return filled;
}

}  // namespace marti::sim
