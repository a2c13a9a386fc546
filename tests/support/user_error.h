// The message of the error that a call throws.
#pragma once

#include <string>

#include "sim/error.h"

namespace marti::test {

/// The message of the UserError, or of the given kind of it, that `call` throws, or "no UserError".
template <class Error = sim::UserError, class Call>
std::string user_error_of(Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "no UserError";
}

inline bool says(const std::string& message, const std::string& part) {
  return message.find(part) != std::string::npos;
}

}  // namespace marti::test
