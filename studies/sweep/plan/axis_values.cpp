#include "studies/sweep/plan/axis_values.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>
#include <unordered_set>
#include <utility>

#include "sim/config_errors.h"
#include "sim/nearest.h"
#include "sim/shown.h"
#include "studies/sweep/plan/sweep_table.h"

namespace marti::studies::sweep {

namespace {

using sim::DocumentEntry;
using sim::DocumentValue;

struct Range {
  sim::Value from;
  sim::Value to;
  std::int64_t steps = 0;
  bool logarithmic = false;
  int line = 0;
};

class RangeReader {
 public:
  RangeReader(const sim::Config& config, std::size_t key, const DocumentValue& value)
      : config_(config), index_(key), key_(config.schema().keys()[key]), value_(value) {}

  Range read() const {
    for (const DocumentEntry& entry : *value_.table()) {
      const std::vector<std::string> parts = {"from", "to", "steps", "scale"};
      if (std::ranges::find(parts, entry.name) == parts.end()) {
        fail(entry.line, "a range has from, to, steps and scale, not \"" + sim::shown(entry.name) + "\"" +
                             sim::did_you_mean(entry.name, parts));
      }
    }
    if (!whole() && !real()) {
      fail(value_.line, "only numbers have ranges; write a list of values in brackets");
    }
    Range range{end("from"), end("to"), steps(), logarithmic(), value_.line};
    if (range.steps == 1 && range.from != range.to) {
      fail(part("steps").line, "one step cannot reach from \"from\" to \"to\"");
    }
    if (range.logarithmic) {
      for (const char* name : {"from", "to"}) {
        const sim::Value& at = name == std::string_view("from") ? range.from : range.to;
        if (!(whole() ? std::get<std::int64_t>(at) > 0 : std::get<double>(at) > 0.0)) {
          fail(part(name).line, "a logarithmic range must lie above 0");
        }
      }
    }
    return range;
  }

 private:
  [[noreturn]] void fail(int line, const std::string& message) const {
    sim::fail_at(config_, line, key_.name, message);
  }
  [[nodiscard]] bool whole() const {
    return key_.type == sim::ValueType::integer || key_.type == sim::ValueType::size ||
           key_.type == sim::ValueType::duration;
  }
  [[nodiscard]] bool real() const {
    return key_.type == sim::ValueType::real || key_.type == sim::ValueType::frequency ||
           key_.type == sim::ValueType::percentage;
  }
  [[nodiscard]] const DocumentEntry& part(std::string_view name) const {
    const DocumentEntry* entry = sim::find(*value_.table(), name);
    if (entry == nullptr) {
      fail(value_.line,
           "the range lacks \"" + std::string(name) + "\"; as { from = ..., to = ..., steps = 5 }");
    }
    return *entry;
  }
  [[nodiscard]] sim::Value end(const std::string& name) const {
    return config_.parse(index_, part(name).value, key_.name + "." + name).front();
  }
  [[nodiscard]] std::int64_t steps() const {
    const DocumentEntry& entry = part("steps");
    const std::int64_t* steps = std::get_if<std::int64_t>(&entry.value.content);
    if (steps == nullptr || *steps < 1 || *steps > most_sweep_steps) {
      fail(entry.line, "steps must be an integer from 1 to " + std::to_string(most_sweep_steps) + ", not " +
                           describe(entry.value));
    }
    return *steps;
  }
  [[nodiscard]] bool logarithmic() const {
    const DocumentEntry* entry = sim::find(*value_.table(), "scale");
    if (entry == nullptr) {
      return false;
    }
    const std::string* text = entry->value.text();
    if (text == nullptr || (*text != "linear" && *text != "log")) {
      fail(entry->line, "scale must be \"linear\" or \"log\", not " + describe(entry->value));
    }
    return *text == "log";
  }

  const sim::Config& config_;
  std::size_t index_;
  const sim::Key& key_;
  const DocumentValue& value_;
};

// Whole numbers, and whether each was one before rounding.
struct Whole {
  std::int64_t value = 0;
  bool exact = true;
};

Whole linear_step(std::int64_t from, std::int64_t to, std::uint64_t i, std::uint64_t gaps) {
  const bool up = to >= from;
  const std::uint64_t distance = up ? static_cast<std::uint64_t>(to) - static_cast<std::uint64_t>(from)
                                    : static_cast<std::uint64_t>(from) - static_cast<std::uint64_t>(to);
  const std::uint64_t rest = distance % gaps * i;  // gaps are few: this fits
  const std::uint64_t way = distance / gaps * i + (rest + gaps / 2) / gaps;
  const std::uint64_t start = static_cast<std::uint64_t>(from);
  return {static_cast<std::int64_t>(up ? start + way : start - way), rest % gaps == 0};
}

Whole log_step(std::int64_t from, std::int64_t to, std::uint64_t i, std::uint64_t gaps) {
  const auto a = static_cast<std::uint64_t>(from);
  const auto b = static_cast<std::uint64_t>(to);
  if (i == 0 || i == gaps) {
    return {i == 0 ? from : to, true};
  }
  if (std::has_single_bit(a) && std::has_single_bit(b)) {
    const int first = std::countr_zero(a);
    const int way = (std::countr_zero(b) - first) * static_cast<int>(i);
    if (way % static_cast<int>(gaps) == 0) {
      return {std::int64_t{1} << (first + way / static_cast<int>(gaps)), true};
    }
  }
  const long double share = static_cast<long double>(i) / static_cast<long double>(gaps);
  const long double exact = static_cast<long double>(from) *
                            std::pow(static_cast<long double>(to) / static_cast<long double>(from), share);
  const long double nearest = std::round(exact);
  return {static_cast<std::int64_t>(nearest), std::abs(exact - nearest) <= 1e-12L * exact};
}

double real_step(double from, double to, bool logarithmic, std::uint64_t i, std::uint64_t gaps) {
  if (i == 0 || i == gaps) {
    return i == 0 ? from : to;
  }
  const double share = static_cast<double>(i) / static_cast<double>(gaps);
  return logarithmic ? std::exp(std::lerp(std::log(from), std::log(to), share)) : std::lerp(from, to, share);
}

std::vector<sim::Value> steps_of(const Range& range, bool& rounded) {
  std::vector<sim::Value> values;
  const auto gaps = static_cast<std::uint64_t>(range.steps > 1 ? range.steps - 1 : 1);
  for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(range.steps); ++i) {
    if (const auto* from = std::get_if<std::int64_t>(&range.from)) {
      const std::int64_t to = std::get<std::int64_t>(range.to);
      const Whole step = range.logarithmic ? log_step(*from, to, i, gaps) : linear_step(*from, to, i, gaps);
      rounded = rounded || !step.exact;
      values.emplace_back(step.value);
    } else {
      values.emplace_back(
          real_step(std::get<double>(range.from), std::get<double>(range.to), range.logarithmic, i, gaps));
    }
  }
  return values;
}

std::vector<sim::Setting> range_values(const sim::Config& config, std::size_t index,
                                       const DocumentValue& value, std::vector<std::string>& notes) {
  const sim::Key& key = config.schema().keys()[index];
  if (key.is_list) {
    sim::fail_at(config, value.line, key.name, "each value is a list itself; only numbers have ranges");
  }
  const Range range = RangeReader(config, index, value).read();
  bool rounded = false;
  std::vector<sim::Setting> settings;
  for (sim::Value& step : steps_of(range, rounded)) {
    // Steps ascend or descend, so equal ones are neighbours.
    if (settings.empty() || settings.back().values.front() != step) {
      settings.push_back({index, {std::move(step)}, range.line, {}});
    }
  }
  const std::string place = sim::place_in_file(config.name(), range.line, key.name) + ": ";
  if (rounded) {
    notes.push_back(place + "the steps of the range are rounded to whole numbers");
  }
  if (settings.size() < static_cast<std::size_t>(range.steps)) {
    notes.push_back(place + "of " + std::to_string(range.steps) + " steps " +
                    std::to_string(settings.size()) + " differ; the others are left out");
  }
  return settings;
}

}  // namespace

std::vector<sim::Setting> axis_values(const sim::Config& config, std::size_t key, const DocumentValue& value,
                                      bool repeats, std::vector<std::string>& notes) {
  if (value.table() != nullptr) {
    return range_values(config, key, value, notes);
  }
  const sim::Key& declared = config.schema().keys()[key];
  const auto fail = [&](int line, const std::string& message) {
    sim::fail_at(config, line, declared.name, message);
  };
  const DocumentValue::List* list = value.list();
  if (list == nullptr) {
    fail(value.line,
         "an axis is a list of values in brackets or { from = ..., to = ..., steps = ... }, not " +
             describe(value));
  }
  if (list->empty()) {
    fail(value.line, "the list of its values is empty");
  }
  if (list->size() > static_cast<std::size_t>(most_sweep_steps)) {
    fail(value.line, "an axis has at most " + std::to_string(most_sweep_steps) + " values, not " +
                         std::to_string(list->size()));
  }
  std::vector<sim::Setting> settings;
  std::unordered_set<std::string> seen;
  for (const DocumentValue& element : *list) {
    sim::Setting setting{key, config.parse(key, element), element.line, {}};
    const std::string printed = print_values(declared, setting.values);
    if (!repeats && !seen.insert(printed).second) {
      fail(element.line, "lists " + sim::shown(printed) + " twice");
    }
    settings.push_back(std::move(setting));
  }
  return settings;
}

}  // namespace marti::studies::sweep
