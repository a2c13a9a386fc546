// The place of an error in a configuration: file and line, or the --set option, and the key.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "sim/config.h"
#include "sim/key_error.h"

namespace marti::sim {

/// "file:line: key", both shown as sim/shown.h says: how a message about a key in a file begins. Line 0:
/// "file: key".
[[nodiscard]] std::string place_in_file(std::string_view file, int line, std::string_view key);

/// Throws the UserError "file:line: key: message" of what stands in that line of the configuration's file.
[[noreturn]] void fail_at(const Config& config, int line, std::string_view key, std::string_view message);

/// The key that makes the longest duration, of those that had these values: a number of cycles
/// ("bus.latency_cycles", "costs.test") or the clock by which it is counted (KEY'S SECTION.clock, else
/// node.clock), whichever is further from usual. Empty when there is none.
[[nodiscard]] std::string longest_duration(std::span<const EffectiveValue> values);

/// Throws `error` again with the place of its key among `values`, which were read from the file of that name.
[[noreturn]] void fail_placed(std::span<const EffectiveValue> values, std::string_view file,
                              const KeyError& error);

/// Likewise at the key of longest_duration().
[[noreturn]] void fail_overflow(std::span<const EffectiveValue> values, std::string_view file,
                                const TimeOverflow& error);

/// Calls `work`; a KeyError or TimeOverflow out of it gets the place of its key in the configuration.
template <class Work>
decltype(auto) placed(const Config& config, const Work& work) {
  try {
    return work();
  } catch (const KeyError& error) {
    config.fail(error.key(), error.reason());
  } catch (const TimeOverflow& error) {
    fail_overflow(config.effective_values(), config.name(), error);
  }
}

/// Likewise with the values that a configuration of that file had.
template <class Work>
decltype(auto) placed(std::span<const EffectiveValue> values, std::string_view file, const Work& work) {
  try {
    return work();
  } catch (const KeyError& error) {
    fail_placed(values, file, error);
  } catch (const TimeOverflow& error) {
    fail_overflow(values, file, error);
  }
}

}  // namespace marti::sim
