// What a run says in sentences.
#pragma once

#include <string>
#include <vector>

#include "studies/report/run_json.h"

namespace marti::studies {

/// "16 nodes", "4 clusters of 16 nodes".
[[nodiscard]] std::string machine_text(const RunJson& run);

/// How fast, what limits it, what to change: the most important first.
[[nodiscard]] std::vector<std::string> answer_of(const RunJson& run);

}  // namespace marti::studies
