// What the declarations of configuration keys share.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "sim/config.h"
#include "sim/schema.h"

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

/// The value of a key that counts something.
[[nodiscard]] inline std::uint32_t count(const sim::Config& config, std::string_view key) {
  return static_cast<std::uint32_t>(config.integer(key));
}

/// Says which command reads the sections that this schema does not declare: a file is often given to the
/// wrong one.
inline void declare_sections_of_other_commands(sim::Schema& schema) {
  for (const std::string_view study : {"paper", "schemes", "error", "stability"}) {
    schema.elsewhere(study, "marti study " + std::string(study));
  }
  schema.elsewhere("sweep", "marti sweep");
  schema.elsewhere("prices", "marti sweep");
}

/// The choices of a key, from the names of an enumeration.
template <std::size_t N>
std::vector<std::string> names(const std::array<std::string_view, N>& list) {
  return {list.begin(), list.end()};
}

}  // namespace marti::studies::keys
