// Differences as text and as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "studies/compare/differences.h"

namespace marti::studies {

/// Without `all`, no list is longer than this.
inline constexpr std::size_t most_lines = 20;

/// A text of somebody's file without control characters, which must not reach the terminal.
[[nodiscard]] std::string printable(std::string text);

/// "1 setting", "2 settings".
[[nodiscard]] std::string count(std::size_t number, const char* what);

/// Two results, settings first.
[[nodiscard]] std::string differences_text(const ComparedResult& a, const ComparedResult& b,
                                           const Differences& found, bool all);
[[nodiscard]] std::string differences_json(const ComparedResult& a, const ComparedResult& b,
                                           const Differences& found, bool all);

/// A table of what differs, at most most_lines of it unless `all`. Texts beside numbers have no change.
[[nodiscard]] std::string lines_of(const std::vector<Difference>& differences, bool all);

[[nodiscard]] nlohmann::ordered_json json_of(const Difference& difference);
[[nodiscard]] nlohmann::ordered_json json_of(const std::vector<Difference>& differences);

}  // namespace marti::studies
