// A run as result.json has it.
#pragma once

#include <map>
#include <string>

#include "studies/run/run_result.h"

namespace marti::studies::show {

/// The result for programs, as docs/internals/result-json.md describes it. The same run gives the same bytes.
/// `files`: hashes (SHA-256, 64 hexadecimal digits) of the files written beside it, by name.
[[nodiscard]] std::string json_of(const run::RunResult& result,
                                  const std::map<std::string, std::string>& files = {});

}  // namespace marti::studies::show
