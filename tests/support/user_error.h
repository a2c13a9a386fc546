// The message of the error that a call throws.
#pragma once

#include <string>

#include "sim/error.h"

namespace marti::test {

/// The message of the UserError that `call` throws, or "no UserError".
template <class Call>
std::string user_error_of(Call&& call) {
  try {
    call();
  } catch (const sim::UserError& error) {
    return error.what();
  }
  return "no UserError";
}

}  // namespace marti::test
