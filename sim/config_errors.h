// Locates an error in a configuration: file and line, or the --set option, and the key.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "sim/config.h"
#include "sim/key_error.h"

namespace marti::sim {

/// A key in a file: "file:line: key", both parts shown as in sim/shown.h. Line 0: "file: key".
[[nodiscard]] Place place_in_file(std::string_view file, int line, std::string_view key);

/// Throws the UserError "file:line: key: message" for that line of the configuration's file.
[[noreturn]] void fail_at(const Config& config, int line, std::string_view key, std::string_view message);

/// The key behind the longest duration among those with these values: a number of cycles
/// ("bus.latency_cycles", "costs.test") or the clock in which it is counted (SECTION OF THE KEY.clock, else
/// node.clock), whichever is further from usual values. Empty when there is no such key.
[[nodiscard]] std::string longest_duration(std::span<const EffectiveValue> values);

/// Throws `error` again with the place of its key in `values`, which were read from `file`.
[[noreturn]] void fail_placed(std::span<const EffectiveValue> values, std::string_view file,
                              const KeyError& error);

/// Throws `error` again with the place of the key from longest_duration().
[[noreturn]] void fail_overflow(std::span<const EffectiveValue> values, std::string_view file,
                                const TimeOverflow& error);

/// Calls `work`; adds to a KeyError or TimeOverflow from it the place of its key in the configuration.
template <class Work>
decltype(auto) with_places(const Config& config, const Work& work) {
  try {
    return work();
  } catch (const KeyError& error) {
    config.fail(error.key(), error.reason());
  } catch (const TimeOverflow& error) {
    fail_overflow(config.effective_values(), config.name(), error);
  }
}

/// Calls `work`; places errors from it in the configuration of `file` that had these values.
template <class Work>
decltype(auto) with_places(std::span<const EffectiveValue> values, std::string_view file, const Work& work) {
  try {
    return work();
  } catch (const KeyError& error) {
    fail_placed(values, file, error);
  } catch (const TimeOverflow& error) {
    fail_overflow(values, file, error);
  }
}

}  // namespace marti::sim
