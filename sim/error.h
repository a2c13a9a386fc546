// Errors. A UserError is a fault of the user's input (exit status 2); an InternalError is a fault of the
// program (exit status 1). Library code throws one of the two; it never prints and never ends the process.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

namespace marti::sim {

/// A fault of the user's input. The message is complete: where that helps it begins with "file:line: key:",
/// and it says what would be right.
class UserError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
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
