#include "studies/compare/figures.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>

#include "processors/cost/accounting.h"
#include "sim/error.h"
#include "studies/figures/derived_figures.h"
#include "studies/keys/setting_value.h"
#include "studies/run/frame_figures.h"
#include "studies/sweep/store/point_result.h"
#include "studies/tables/json_table.h"
#include "studies/tables/run_json.h"

namespace marti::studies::compare {

namespace {

using Json = nlohmann::ordered_json;

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

// Whether the figure says something about the machine or frame, not about the program.
bool is_compared(std::string_view name) {
  const figures::FigureEntry* const entry = entry_of(name);
  return entry == nullptr || entry->of_machine();
}

void add(const tables::RunJson& run, const std::string& part, const std::string& prefix, Figures& figures) {
  for (const auto& [name, value] : run.at(part).items()) {
    const tables::Cell cell = tables::cell_of(value);
    if (!std::holds_alternative<std::monostate>(cell) && is_compared(prefix + name)) {
      figures[prefix + name] = cell;
    }
  }
}

void enter(std::span<const figures::FigureEntry> entries, const figures::Counts& counts,
           const std::string& prefix, Figures& figures) {
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (counts[i] && entries[i].of_machine()) {
      figures[prefix + entries[i].name] = *counts[i];
    }
  }
}

ComparedResult compared(const tables::RunJson& run, const std::string& name) {
  ComparedResult result;
  result.name = name;
  const Json& version = run.find("marti.version");
  result.version = version.is_string() ? version.get<std::string>() : "unknown";
  result.settings = keys::settings_of(run);
  add(run, "figures.frame", "frame.", result.figures);
  add(run, "figures.machine", "", result.figures);
  result.scene_hash = run.text("scene.hash");
  result.noise = run.optional_number("machine.what_helps.noise.band", 0.0, 1e18);
  result.helps = run.text("machine.what_helps.sentence");
  return result;
}

}  // namespace

ComparedResult read_run(const std::filesystem::path& path, const std::string& name) {
  return compared(tables::read_run_json(path), name);
}

ComparedResult read_point(const sweep::SweepReader& sweep, std::int64_t ordinal, const std::string& name) {
  return compared(sweep::point_result(sweep, ordinal, name), name);
}

void add_counters(const sweep::SweepRow& row, Figures& figures) {
  enter(figures::counted_figures(), row.counters, "", figures);
}

void add_frame(const sweep::FrameRow& row, ComparedResult& result) {
  Figures& figures = result.figures;
  result.scene_hash = row.scene_hash;
  figures["frame.scene"] = row.scene;
  figures["frame.image_hash"] = row.image_hash;
  figures["frame.hit_hash"] = row.hit_hash;
  enter(run::frame_figures(), row.counters, "frame.", figures);
}

std::optional<std::int64_t> integer_figure(const ComparedResult& result, const std::string& name) {
  const auto at = result.figures.find(name);
  const auto* value = at == result.figures.end() ? nullptr : std::get_if<std::int64_t>(&at->second);
  return value != nullptr ? std::optional(*value) : std::nullopt;
}

std::optional<std::int64_t> frame_time_if_any(const ComparedResult& result) {
  const std::optional<std::int64_t> ticks = integer_figure(result, "end");
  return ticks && *ticks > 0 ? ticks : std::nullopt;
}

std::int64_t frame_time(const ComparedResult& result) {
  const std::optional<std::int64_t> ticks = frame_time_if_any(result);
  if (!ticks) {
    throw sim::UserError(result.name + ": has no frame time (a figure \"end\" above 0)");
  }
  return *ticks;
}

std::string unit_of_figure(std::string_view name) {
  const figures::FigureEntry* const entry = entry_of(name);
  return entry == nullptr ? std::string() : entry->unit;
}

std::string meaning_of_figure(std::string_view name) {
  const figures::FigureEntry* const entry = entry_of(name);
  return entry == nullptr ? std::string() : entry->description;
}

void keep_what_sweeps_have(ComparedResult& result) {
  for (const figures::FigureEntry& entry : figures::derived_figures()) {
    if (entry.formula->is_relative()) {
      result.figures.erase(entry.name);
    }
  }
  std::erase_if(result.settings, [](const auto& setting) {
    return setting.first.starts_with("host_machine.") || setting.first.starts_with("prices.") ||
           setting.first.starts_with("record.");
  });
}

namespace {

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

// The nodes of a result whose times of all activities add up to those nodes' frame times; else 0.
std::int64_t nodes_of(const ComparedResult& result) {
  const std::optional<std::int64_t> nodes = integer_figure(result, "nodes");
  const std::optional<std::int64_t> end = integer_figure(result, "end");
  sim::Sum sum = 0;
  sim::Sum rounding = 0;
  for (const std::string_view activity : processors::cost::activity_names) {
    const std::optional<sim::Sum> time = count_of(result, "time_" + std::string(activity));
    if (!time) {
      return 0;
    }
    sum += *time;
    // A real has 53 bits.
    rounding += *time >> 63 != 0 ? *time >> 53 : 0;
  }
  if (!nodes || !end || *nodes <= 0 || *end < 0) {
    return 0;
  }
  const sim::Sum off = sum - sim::Sum{*nodes} * *end;
  return off >= -rounding && off <= rounding ? *nodes : 0;
}

std::int64_t rounded_mean(sim::Sum sum, std::int64_t nodes) {
  return sim::ticks_of(sum / nodes + (sum % nodes >= nodes - sum % nodes ? 1 : 0));
}

double mean(sim::Sum sum, std::int64_t nodes) {
  const sim::Sum whole = sum / nodes;
  return static_cast<double>(whole) + static_cast<double>(sum % nodes) / static_cast<double>(nodes);
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
    const sim::Sum of_a = *count_of(a, "time_" + time.activity);
    const sim::Sum of_b = *count_of(b, "time_" + time.activity);
    if (of_a == 0 && of_b == 0) {
      continue;
    }
    time.a = of_a;
    time.b = of_b;
    time.mean_a = rounded_mean(of_a, nodes_a);
    time.mean_b = rounded_mean(of_b, nodes_b);
    time.change = mean(of_b, nodes_b) - mean(of_a, nodes_a);
    times.push_back(time);
  }
  std::ranges::stable_sort(times, [](const ActivityTime& x, const ActivityTime& y) {
    return std::abs(x.change) > std::abs(y.change);
  });
  return times;
}

}  // namespace marti::studies::compare
