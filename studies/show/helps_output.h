// What would make the frame shorter, in the summary and in result.json.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "studies/helps/what_helps.h"

namespace marti::studies::show {

/// The field machine.what_helps, as docs/result-schema.md describes it.
[[nodiscard]] nlohmann::ordered_json helps_json(const helps::WhatHelps& what);

/// Lines of the summary: the sentence, the next best steps, and how many were not replayed.
[[nodiscard]] std::string helps_lines(const helps::WhatHelps& what);

}  // namespace marti::studies::show
