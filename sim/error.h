// Errors. A UserError is the user's input being wrong (exit status 2); an InternalError is a fault of
// ours (exit status 1). Library code throws one of the two; it never prints and never ends the process.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

namespace marti::sim {

/// The user's input is wrong. The message is complete as it stands: where it helps it begins with
/// "file:line: key:", and it says what would be right.
class UserError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A broken invariant of the program itself.
class InternalError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// Throws InternalError with `what` unless `holds`. For invariants that a release build keeps checking.
inline void ensure(bool holds, const char* what) {
  if (!holds) [[unlikely]] {
    throw InternalError(what);
  }
}

}  // namespace marti::sim
