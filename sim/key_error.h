// Errors of a configuration that are found where nobody knows who gave the key: the reader of the
// configuration adds the place (sim/config_errors.h).
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "sim/error.h"

namespace marti::sim {

/// What is wrong with the value of one key. what() is "key: reason".
class KeyError : public UserError {
 public:
  KeyError(std::string key, std::string reason)
      : UserError(key + ": " + reason), key_(std::move(key)), reason_(std::move(reason)) {}

  [[nodiscard]] const std::string& key() const { return key_; }
  [[nodiscard]] const std::string& reason() const { return reason_; }

  /// Calls `work`. A UserError that names no key is thrown on as one about `key`, with `prefix` before it.
  template <class Work>
  static decltype(auto) laid_at(std::string_view key, const Work& work, std::string_view prefix = {}) {
    try {
      return work();
    } catch (const KeyError&) {
      throw;
    } catch (const UserError& error) {
      throw KeyError(std::string(key), std::string(prefix) + error.what());
    }
  }

 private:
  std::string key_;
  std::string reason_;
};

/// A simulated time that does not fit in Ticks. Which key is to blame follows from all durations together.
class TimeOverflow : public UserError {
 public:
  using UserError::UserError;
};

}  // namespace marti::sim
