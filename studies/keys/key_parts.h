// What the declarations of configuration keys share.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "sim/config.h"
#include "sim/schema.h"
#include "sim/shown.h"
#include "sim/time.h"

namespace marti::studies::keys {

/// What a duration in cycles may be: enough for any ratio of latencies, and no product of two overflows.
inline constexpr std::int64_t most_cycles = 1'000'000'000'000;

/// The deepest level of any structure's tree: a bsp tree has three times an octree's, less two.
inline constexpr std::uint32_t most_levels = 61;

/// Declares a number of cycles.
inline void cycles(sim::Schema& schema, std::string_view name, std::int64_t fallback,
                   std::string_view meaning) {
  schema.integer(name, fallback, {0, most_cycles}, "cycles", meaning);
}

/// Declares a clock.
inline void clock(sim::Schema& schema, std::string_view name, std::string_view meaning) {
  schema.frequency(name, "33 MHz", {"1 Hz", "1 THz"}, meaning);
}

/// The text or choice of a key, given or by default; empty where the schema does not have it. Does not mark
/// the key as used.
[[nodiscard]] inline std::string value_if_declared(const sim::Config& config, std::string_view key) {
  const std::optional<std::size_t> index = config.schema().find(key);
  return index ? std::get<std::string>(config.values_at(*index).front()) : "";
}

/// The value of a clock.
[[nodiscard]] inline sim::Clock clock(const sim::Config& config, std::string_view key) {
  return sim::Clock::from_hertz(config.frequency(key));
}

/// The value of a key that counts something.
[[nodiscard]] inline std::uint32_t count(const sim::Config& config, std::string_view key) {
  return static_cast<std::uint32_t>(config.integer(key));
}

/// The numbers of a list, ascending and each once. `T` holds all that the key allows.
template <class T>
std::vector<T> ascending(const sim::Config& config, std::string_view key) {
  std::vector<T> numbers;
  for (const sim::Value& value : config.values(key)) {
    const auto* const whole = std::get_if<std::int64_t>(&value);
    numbers.push_back(whole != nullptr ? static_cast<T>(*whole) : static_cast<T>(std::get<double>(value)));
  }
  std::ranges::sort(numbers);
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  return numbers;
}

/// The scenes of a study: at least one, none twice.
[[nodiscard]] inline std::vector<std::string> study_scenes(const sim::Config& config, std::string_view key) {
  std::vector<std::string> names = config.texts(key);
  if (names.empty()) {
    config.fail(key, "must name a scene");
  }
  for (auto name = names.begin(); name != names.end(); ++name) {
    if (std::find(names.begin(), name, *name) != name) {
      config.fail(key, "names " + sim::shown(*name) + " twice");
    }
  }
  return names;
}

/// The choices of a key, from the names of an enumeration.
template <std::size_t N>
std::vector<std::string> names(const std::array<std::string_view, N>& list) {
  return {list.begin(), list.end()};
}

}  // namespace marti::studies::keys
