// Differences as text and as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "studies/compare/differences.h"

namespace marti::studies::compare {

struct ComparedPair;

/// Without `all`, no list is longer than this.
inline constexpr std::size_t most_lines = 20;

/// A text of somebody's file without control characters, which must not reach the terminal.
[[nodiscard]] std::string printable(std::string text);

/// "1 point differs", "3 points differ".
[[nodiscard]] std::string differ(std::size_t number, std::string_view what);

/// A setting's value as people write it, a text without the quotation marks that it has in a TOML file; "-"
/// where the machine does not use the setting.
[[nodiscard]] std::string setting_text(const tables::Cell& value);

/// A setting that has a number: a size in bytes, a frequency in Hz and so on.
[[nodiscard]] std::optional<double> setting_number(const std::string& key, const tables::Cell& value);

/// "cache.size 4 KiB, machine.nodes 8": the values of one side. A setting that only one side has is listed if
/// `all`; it follows from another one, as the ways of a cache from its being there.
[[nodiscard]] std::string values_text(const std::vector<Difference>& settings, tables::Cell Difference::*side,
                                      bool all);

/// "and 5 more: --all lists them", or nothing.
[[nodiscard]] std::string and_more(std::size_t shown, std::size_t of);

/// A sentence a line, the first behind the word "verdict".
[[nodiscard]] std::string verdict_lines(const std::vector<std::string>& sentences);

/// Lines of settings with both values.
[[nodiscard]] std::string settings_lines(const std::vector<Difference>& settings);

/// Two results: the verdict, the settings, where the nodes' time went, the figures.
[[nodiscard]] std::string differences_text(const ComparedPair& pair, bool all);
[[nodiscard]] std::string differences_json(const ComparedPair& pair, bool all);

/// Settings have the values that their keys have: sizes in bytes, frequencies in Hz, times in ps, shares,
/// booleans and lists.
[[nodiscard]] nlohmann::ordered_json settings_json(const std::vector<Difference>& settings);
[[nodiscard]] nlohmann::ordered_json json_of(const Difference& figure);
[[nodiscard]] nlohmann::ordered_json json_of(const std::vector<Difference>& figures);

}  // namespace marti::studies::compare
