#include "sim/statistics.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>
#include <string>

namespace marti::sim {
namespace {

struct QueueCounters {
  Sum waits = 0;
  std::int64_t arrivals = 0;
  std::int64_t longest = 0;

  static constexpr auto counters() {
    using C = Counter<QueueCounters>;
    return std::array{C{"arrivals", "1", "customers that came", &QueueCounters::arrivals},
                      C{"waits", "ps", "sum of their waits", &QueueCounters::waits},
                      C{"longest", "1", "longest queue", &QueueCounters::longest, MergeRule::maximum}};
  }
  friend bool operator==(const QueueCounters&, const QueueCounters&) = default;
};
static_assert(declares_every_member<QueueCounters>());
static_assert(HasCounters<QueueCounters> && !HasCounters<Moments>);

struct Incomplete {
  std::int64_t seen = 0;
  std::int64_t forgotten = 0;
  static constexpr auto counters() {
    return std::array{Counter<Incomplete>{"seen", "1", "", &Incomplete::seen}};
  }
};
static_assert(!declares_every_member<Incomplete>());

TEST(Statistics, CountersMergeByTheirRule) {
  QueueCounters a{30, 3, 2};
  merge(a, QueueCounters{5, 4, 1});
  EXPECT_TRUE(a == (QueueCounters{35, 7, 2}));
  constexpr std::int64_t most = std::numeric_limits<std::int64_t>::max();
  merge(a, QueueCounters{most, 0, 0});
  EXPECT_TRUE(a == (QueueCounters{Sum{most} + 35, 7, 2})) << "a sum of times has more than 64 bits";
  EXPECT_THROW(merge(a, QueueCounters{0, most, 0}), InternalError);
  Sums<QueueCounters> sums;
  sums.merge({1, most, 4});
  sums.merge({2, most, 3});
  sums.for_each([](const auto& counter, Sum value) {
    EXPECT_TRUE(value == (counter.name == "waits" ? 3 : counter.name == "longest" ? 4 : Sum{most} * 2));
  });
}

TEST(Statistics, DeclaredNamesAreVisitedInOrder) {
  std::string seen;
  for_each_counter(QueueCounters{35, 7, 2}, [&](const auto& counter, Sum value) {
    seen += std::string(counter.name) + "=" + std::to_string(ticks_of(value)) + " " +
            std::string(counter.unit) + ";";
  });
  EXPECT_EQ(seen, "arrivals=7 1;waits=35 ps;longest=2 1;");
}

TEST(Statistics, NoSamplesHaveNoMean) {
  const Moments none;
  EXPECT_FALSE(none.mean());
  EXPECT_FALSE(none.variance());
  EXPECT_EQ(none.sum(), 0);
  EXPECT_EQ(none.maximum(), 0);
  EXPECT_FALSE(LogHistogram().percentile(50));
}

RC_GTEST_PROP(Statistics, MomentsEqualTheTextbookOnSmallNumbers, ()) {
  const auto samples =
      *rc::gen::nonEmpty(rc::gen::container<std::vector<int>>(rc::gen::inRange(-9999, 9999)));
  Moments moments;
  std::int64_t sum = 0;
  std::int64_t squares = 0;
  for (const int sample : samples) {
    moments.add(sample);
    sum += sample;
    squares += std::int64_t{sample} * sample;
  }
  const auto n = static_cast<std::int64_t>(samples.size());
  RC_ASSERT(moments.sum() == sum);
  RC_ASSERT(moments.mean() == static_cast<double>(static_cast<long double>(sum) / n));
  const long double spread = static_cast<long double>(n * squares - sum * sum);
  RC_ASSERT(moments.variance() == static_cast<double>(spread / n / n));
}

/// Splits samples at random, adds the parts in another order and grouping, and compares.
template <class Collector>
void check_merging(const std::vector<std::int64_t>& samples) {
  Collector whole;
  std::array<Collector, 3> parts;
  for (const std::int64_t sample : samples) {
    whole.add(sample);
    parts[static_cast<std::size_t>(*rc::gen::inRange(0, 3))].add(sample);
  }
  Collector left = parts[0];
  left.merge(parts[1]);
  left.merge(parts[2]);
  Collector right = parts[2];
  right.merge(parts[1]);
  Collector other = parts[0];
  other.merge(right);
  RC_ASSERT(left == whole);
  RC_ASSERT(other == whole);
}

RC_GTEST_PROP(Statistics, MergingDoesNotDependOnTheOrder, (const std::vector<std::int64_t>& samples)) {
  check_merging<Moments>(samples);
  std::vector<std::int64_t> positive;
  for (const std::int64_t sample : samples) {
    positive.push_back(sample & std::numeric_limits<std::int64_t>::max());
  }
  check_merging<LogHistogram>(positive);
}

TEST(Statistics, BucketsCoverEverySampleOnce) {
  constexpr std::int64_t last = std::numeric_limits<std::int64_t>::max();
  const std::size_t buckets = LogHistogram::bucket_of(last) + 1;
  EXPECT_EQ(buckets, 488U);
  std::int64_t next = 0;
  for (std::size_t i = 0; i < buckets; ++i) {
    const std::int64_t lowest = LogHistogram::lowest_of(i);
    const std::int64_t highest = LogHistogram::highest_of(i);
    ASSERT_EQ(lowest, next);
    ASSERT_GE(highest, lowest);
    ASSERT_LE(highest - lowest, lowest / 8);
    ASSERT_EQ(LogHistogram::bucket_of(lowest), i);
    ASSERT_EQ(LogHistogram::bucket_of(highest), i);
    next = highest == last ? 0 : highest + 1;
  }
  EXPECT_EQ(next, 0);
  EXPECT_THROW(LogHistogram().add(-1), InternalError);
}

RC_GTEST_PROP(Statistics, PercentilesAreWithinAnEighth, ()) {
  const auto exponents = *rc::gen::nonEmpty(rc::gen::container<std::vector<int>>(rc::gen::inRange(0, 64)));
  std::vector<std::int64_t> samples;
  LogHistogram histogram;
  for (const int exponent : exponents) {
    const auto bits = *rc::gen::arbitrary<std::uint64_t>();
    samples.push_back(
        static_cast<std::int64_t>(exponent == 0 ? 0 : (bits | (1ULL << 63)) >> (64 - exponent)));
    histogram.add(samples.back());
  }
  std::sort(samples.begin(), samples.end());
  RC_ASSERT(histogram.percentile(100) == samples.back());
  RC_ASSERT(histogram.maximum() == samples.back());
  for (const double p : {0.01, 1.0, 25.0, 50.0, 90.0, 99.0, 99.99}) {
    const auto n = static_cast<double>(samples.size());
    const auto rank = static_cast<std::size_t>(std::max(1.0, std::ceil(p / 100 * n)));
    const std::int64_t exact = samples[rank - 1];
    const std::int64_t reported = *histogram.percentile(p);
    RC_ASSERT(reported >= exact);
    RC_ASSERT(reported - exact <= exact / 8);
  }
  std::int64_t total = 0;
  for (const auto& bucket : histogram.buckets()) {
    const auto inside = std::count_if(samples.begin(), samples.end(), [&](std::int64_t sample) {
      return sample >= bucket.lowest && sample <= bucket.highest;
    });
    RC_ASSERT(bucket.count == inside);
    total += bucket.count;
  }
  RC_ASSERT(total == histogram.count());
}

}  // namespace
}  // namespace marti::sim
