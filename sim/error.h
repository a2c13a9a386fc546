// Errors. A UserError is a fault of the user's input (exit status 2); an InternalError is a fault of the
// program (exit status 1). Library code throws one of the two; it never prints and never ends the process.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>

namespace marti::sim {

/// Where a fault of the input is: as text for people, and its parts for programs. A part that is not known is
/// empty.
struct Place {
  std::string text{};  ///< "file:line: key", "--set key=value"
  std::string file{};
  int line = 0;       ///< from 1; 0: not known
  std::string key{};  ///< "cache.size"
};

/// A fault of the user's input. The message is complete: where that helps it begins with "file:line: key:",
/// and it says what would be right.
class UserError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  /// The message "PLACE.text: reason".
  UserError(Place place, const std::string& reason)
      : std::runtime_error(place.text + ": " + reason), place_(std::move(place)) {}
  /// The same fault in other words.
  UserError(const std::string& message, const UserError& error)
      : std::runtime_error(message), place_(error.place_) {}

  [[nodiscard]] const Place& place() const { return place_; }

 private:
  Place place_;
};

/// A broken invariant of the program itself.
class InternalError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// Throws InternalError with `what` unless `holds`. For invariants that release builds check too.
inline void ensure(bool holds, const char* what) {
  if (!holds) [[unlikely]] {
    throw InternalError(what);
  }
}

}  // namespace marti::sim
