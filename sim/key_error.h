// Errors in a key's value that are found where the source of the value is not known: the code that read the
// configuration adds the place (sim/config_errors.h).
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "sim/error.h"

namespace marti::sim {

/// A fault in the value of one key. what() is "key: reason".
class KeyError : public UserError {
 public:
  KeyError(const std::string& key, std::string reason)
      : UserError(Place{key, {}, 0, key}, reason), reason_(std::move(reason)) {}

  [[nodiscard]] const std::string& key() const { return place().key; }
  [[nodiscard]] const std::string& reason() const { return reason_; }

  /// Calls `work`. A UserError that names no key becomes one about `key`, with `prefix` before its text.
  template <class Work>
  static decltype(auto) reported_under(std::string_view key, const Work& work, std::string_view prefix = {}) {
    try {
      return work();
    } catch (const KeyError&) {
      throw;
    } catch (const UserError& error) {
      throw KeyError(std::string(key), std::string(prefix) + error.what());
    }
  }

 private:
  std::string reason_;
};

/// A simulated time that overflows Ticks. The key at fault is found by comparing all durations.
class TimeOverflow : public UserError {
 public:
  using UserError::UserError;
};

}  // namespace marti::sim
