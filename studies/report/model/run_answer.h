// What a run says in sentences.
#pragma once

#include <string>
#include <vector>

#include "studies/tables/run_json.h"

namespace marti::studies::report {

/// "16 nodes", "4 clusters of 16 nodes". Throws UserError, naming the field, when the result does not have
/// them.
[[nodiscard]] std::string machine_text(const tables::RunJson& run);

/// How fast, what helps, what was lost: the most important first. `base`: what the speed-up is measured
/// against. Throws UserError, naming the file and
/// the field, when a figure that it needs is missing or one that it uses is out of range.
[[nodiscard]] std::vector<std::string> answer_of(const tables::RunJson& run, const std::string& base);

}  // namespace marti::studies::report
