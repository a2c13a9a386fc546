#include "sim/config_errors.h"

#include <algorithm>
#include <charconv>
#include <optional>

#include "sim/shown.h"
#include "sim/units.h"

namespace marti::sim {

namespace {

const EffectiveValue* find(std::span<const EffectiveValue> values, std::string_view key) {
  const auto found = std::find_if(values.begin(), values.end(),
                                  [&](const EffectiveValue& value) { return value.key == key; });
  return found == values.end() ? nullptr : &*found;
}

// The period of the clock in whose cycles a section counts; 0 seconds when there is none.
struct Period {
  double seconds = 0.0;
  std::string key;
};

Period period_of(std::span<const EffectiveValue> values, std::string_view section) {
  for (const std::string& key : {std::string(section) + ".clock", std::string("node.clock")}) {
    if (const EffectiveValue* const clock = find(values, key)) {
      const std::string_view quoted = clock->value;
      const double hertz = parse_frequency(quoted.substr(1, quoted.size() - 2));
      if (hertz > 0.0) {  // 0: the clock of another part, which has a key itself
        return {1.0 / hertz, clock->key};
      }
    }
  }
  return {};
}

std::optional<double> cycles_of(const EffectiveValue& value) {
  if (!value.key.ends_with("_cycles") && !value.key.ends_with(".cycles_per_beat") &&
      !value.key.starts_with("costs.")) {
    return std::nullopt;
  }
  double cycles = 0.0;
  const char* const end = value.value.data() + value.value.size();
  return std::from_chars(value.value.data(), end, cycles).ec == std::errc{} ? std::optional(cycles)
                                                                            : std::nullopt;
}

}  // namespace

Place place_in_file(std::string_view file, int line, std::string_view key) {
  return {shown(file) + (line > 0 ? ":" + std::to_string(line) : "") + ": " + shown(key), std::string(file),
          line, std::string(key)};
}

void fail_at(const Config& config, int line, std::string_view key, std::string_view message) {
  throw UserError(place_in_file(config.name(), line, key), shown(message, all_shown));
}

std::string longest_duration(std::span<const EffectiveValue> values) {
  // Usual clocks have periods of some nanoseconds, and usual latencies are some cycles.
  constexpr double usual_period = 1e-9;
  double longest = 0.0;
  std::string key;
  for (const EffectiveValue& value : values) {
    const std::optional<double> cycles = cycles_of(value);
    if (!cycles && !value.key.ends_with(".clock")) {
      continue;
    }
    const Period period = period_of(values, std::string_view(value.key).substr(0, value.key.rfind('.')));
    const double seconds = cycles.value_or(1.0) * period.seconds;
    if (seconds > longest) {
      longest = seconds;
      key = cycles && *cycles > period.seconds / usual_period ? value.key : period.key;
    }
  }
  return key;
}

void fail_overflow(std::span<const EffectiveValue> values, std::string_view file, const TimeOverflow& error) {
  const std::string key = longest_duration(values);
  if (key.empty()) {
    throw UserError(Place{shown(file), std::string(file)}, error.what());
  }
  fail_placed(values, file, KeyError(key, error.what()));
}

void fail_placed(std::span<const EffectiveValue> values, std::string_view file, const KeyError& error) {
  const EffectiveValue* const value = find(values, error.key());
  const std::string source = value == nullptr || !value->given ? "" : value->source;
  if (source.starts_with("--set ")) {
    throw UserError(Place{shown(source), {}, 0, error.key()}, shown(error.reason(), all_shown));
  }
  const std::size_t colon = source.rfind(':');
  int line = 0;
  if (colon != std::string::npos) {
    (void)std::from_chars(source.data() + colon + 1, source.data() + source.size(), line);
  }
  throw UserError(place_in_file(file, line, error.key()), shown(error.reason(), all_shown));
}

}  // namespace marti::sim
