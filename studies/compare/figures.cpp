#include "studies/compare/figures.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "processors/cost/accounting.h"
#include "sim/error.h"
#include "studies/figures/derived_figures.h"
#include "studies/run/frame_figures.h"

namespace marti::studies::compare {

namespace {

const figures::FigureEntry* entry_of(std::string_view name) {
  constexpr std::string_view of_frame = "frame.";
  const auto found = [](std::span<const figures::FigureEntry> entries, std::string_view wanted) {
    const auto at = std::ranges::find(entries, wanted, &figures::FigureEntry::name);
    return at == entries.end() ? nullptr : &*at;
  };
  if (name.starts_with(of_frame)) {
    return found(run::frame_figures(), name.substr(of_frame.size()));
  }
  const figures::FigureEntry* const counted = found(figures::counted_figures(), name);
  return counted != nullptr ? counted : found(figures::derived_figures(), name);
}

std::optional<std::int64_t> integer_figure(const ComparedResult& result, const std::string& name) {
  const auto at = result.figures.find(name);
  const auto* value = at == result.figures.end() ? nullptr : std::get_if<std::int64_t>(&at->second);
  return value != nullptr ? std::optional(*value) : std::nullopt;
}

// A figure that is not negative; a sum of 2^63 or more is a real in results.
std::optional<sim::Sum> count_of(const ComparedResult& result, const std::string& name) {
  const auto at = result.figures.find(name);
  if (at == result.figures.end()) {
    return std::nullopt;
  }
  if (const auto* const real = std::get_if<double>(&at->second)) {
    return *real >= 0x1p63 && *real <= figures::largest_count ? std::optional(static_cast<sim::Sum>(*real))
                                                              : std::nullopt;
  }
  const auto* const integer = std::get_if<std::int64_t>(&at->second);
  return integer != nullptr && *integer >= 0 ? std::optional(sim::Sum{*integer}) : std::nullopt;
}

// The nodes' time in each activity; none unless all together are the nodes' frame times.
std::vector<sim::Sum> times_of(const ComparedResult& result) {
  std::vector<sim::Sum> times;
  sim::Sum off = 0;
  sim::Sum rounding = 0;
  for (const std::string_view activity : processors::cost::activity_names) {
    const std::optional<sim::Sum> time = count_of(result, "time_" + std::string(activity));
    if (!time) {
      return {};
    }
    times.push_back(*time);
    off += *time;
    // A real has 53 bits.
    rounding += *time >> 63 != 0 ? *time >> 53 : 0;
  }
  const std::int64_t nodes = integer_figure(result, "nodes").value_or(0);
  off -= sim::Sum{nodes} * frame_time_if_any(result);
  return nodes > 0 && frame_time_if_any(result) > 0 && off >= -rounding && off <= rounding
             ? times
             : std::vector<sim::Sum>();
}

double mean(sim::Sum sum, std::int64_t nodes) {
  const sim::Sum whole = sum / nodes;
  return static_cast<double>(whole) + static_cast<double>(sum % nodes) / static_cast<double>(nodes);
}

}  // namespace

std::int64_t frame_time_if_any(const ComparedResult& result) {
  return std::max<std::int64_t>(0, integer_figure(result, "end").value_or(0));
}

std::int64_t frame_time(const ComparedResult& result) {
  const std::int64_t ticks = frame_time_if_any(result);
  if (ticks == 0) {
    throw sim::UserError(result.name + ": has no frame time (a figure \"end\" above 0)");
  }
  return ticks;
}

bool is_compared(std::string_view name) {
  const figures::FigureEntry* const entry = entry_of(name);
  return entry == nullptr || entry->of_machine();
}

std::string unit_of_figure(std::string_view name) {
  const figures::FigureEntry* const entry = entry_of(name);
  return entry == nullptr ? std::string() : entry->unit;
}

std::string meaning_of_figure(std::string_view name) {
  const figures::FigureEntry* const entry = entry_of(name);
  return entry == nullptr ? std::string() : entry->description;
}

void ActivityTimes::add(const ComparedResult& a, const ComparedResult& b) {
  const std::vector<sim::Sum> of_a = times_of(a);
  const std::vector<sim::Sum> of_b = times_of(b);
  if (of_a.empty() || of_b.empty()) {
    return;
  }
  pairs_ += 1.0;
  sums_.resize(of_a.size());
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    ActivityTime& time = sums_[i];
    time.activity = processors::cost::activity_names[i];
    time.a += of_a[i];
    time.b += of_b[i];
    const double mean_a = mean(of_a[i], *integer_figure(a, "nodes"));
    const double mean_b = mean(of_b[i], *integer_figure(b, "nodes"));
    time.mean_a += mean_a;
    time.mean_b += mean_b;
    time.change += mean_b - mean_a;
    time.of_frame += (mean_b - mean_a) / static_cast<double>(frame_time(a));
  }
}

std::vector<ActivityTime> ActivityTimes::means() const {
  std::vector<ActivityTime> times = sums_;
  std::erase_if(times, [](const ActivityTime& time) { return time.a == 0 && time.b == 0; });
  for (ActivityTime& time : times) {
    for (double* sum : {&time.mean_a, &time.mean_b, &time.change, &time.of_frame}) {
      *sum /= pairs_;
    }
  }
  std::ranges::stable_sort(times, [](const ActivityTime& x, const ActivityTime& y) {
    return std::abs(x.of_frame) > std::abs(y.of_frame);
  });
  return times;
}

}  // namespace marti::studies::compare
