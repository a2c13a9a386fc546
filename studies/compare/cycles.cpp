#include "studies/compare/cycles.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "processors/cost/accounting.h"

namespace marti::studies::compare {

namespace {

std::optional<std::int64_t> count_of(const ComparedResult& result, const std::string& name) {
  const std::optional<std::int64_t> count = integer_figure(result, name);
  return count && *count >= 0 ? count : std::nullopt;
}

// The nodes of a result whose times of all activities add up to those nodes' frame times; else 0.
std::int64_t nodes_of(const ComparedResult& result) {
  const std::optional<std::int64_t> nodes = count_of(result, "nodes");
  const std::optional<std::int64_t> end = count_of(result, "end");
  std::int64_t sum = 0;
  for (const std::string_view activity : processors::cost::activity_names) {
    const std::optional<std::int64_t> time = count_of(result, "time_" + std::string(activity));
    if (!time || __builtin_add_overflow(sum, *time, &sum)) {
      return 0;
    }
  }
  std::int64_t all = 0;
  return nodes && end && !__builtin_mul_overflow(*nodes, *end, &all) && all == sum ? *nodes : 0;
}

std::int64_t rounded_mean(std::int64_t sum, std::int64_t nodes) {
  return sum / nodes + (sum % nodes >= nodes - sum % nodes ? 1 : 0);
}

double mean(std::int64_t sum, std::int64_t nodes) {
  const std::int64_t whole = sum / nodes;
  const std::int64_t rest = sum % nodes;
  return static_cast<double>(whole) + static_cast<double>(rest) / static_cast<double>(nodes);
}

}  // namespace

std::vector<ActivityTime> activity_times(const ComparedResult& a, const ComparedResult& b) {
  const std::int64_t nodes_a = nodes_of(a);
  const std::int64_t nodes_b = nodes_of(b);
  std::vector<ActivityTime> times;
  if (nodes_a == 0 || nodes_b == 0) {
    return times;
  }
  for (const std::string_view activity : processors::cost::activity_names) {
    ActivityTime time;
    time.activity = activity;
    time.a = *count_of(a, "time_" + time.activity);
    time.b = *count_of(b, "time_" + time.activity);
    if (time.a == 0 && time.b == 0) {
      continue;
    }
    time.mean_a = rounded_mean(time.a, nodes_a);
    time.mean_b = rounded_mean(time.b, nodes_b);
    time.change = mean(time.b, nodes_b) - mean(time.a, nodes_a);
    times.push_back(time);
  }
  std::ranges::stable_sort(times, [](const ActivityTime& x, const ActivityTime& y) {
    return std::abs(x.change) > std::abs(y.change);
  });
  return times;
}

}  // namespace marti::studies::compare
