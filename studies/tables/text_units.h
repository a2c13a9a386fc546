// Numbers as people read them: every text for people takes them from here, so that a time, a size or a share
// looks alike wherever it stands (docs/results.md, "Numbers in texts for people").
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "sim/time.h"
#include "studies/tables/table.h"

namespace marti::studies::tables {

/// "1.234 s", "1.234 ms", "1.234 us", below 1 ns "123 ps"; "0 s".
[[nodiscard]] std::string seconds(sim::Ticks ticks);

/// Like seconds(), for a time in ps that was computed: rounded; below 0 ps as 0, above 2^63 ps as 2^63.
[[nodiscard]] std::string computed_seconds(double ps);

/// A change of a time: "+1.234 ms", "-1.234 us"; "0 s".
[[nodiscard]] std::string signed_seconds(sim::Ticks ticks);

/// A number with so many decimals; what is rounded to 0 has no sign.
[[nodiscard]] std::string fixed(double value, int decimals);

/// A share in a table, with two decimals: "24.90 %".
[[nodiscard]] std::string percent(double share);

/// A share in a sentence, with one decimal: "24.9 %".
[[nodiscard]] std::string rough_percent(double share);

/// A change as a share of anything: "+69.02 %"; one that two decimals do not show "+1.2e-05 %".
[[nodiscard]] std::string signed_percent(double share);

/// A relative change from a value above 0: "+69.02 %"; from +1000 % on "20.07 times"; one that two decimals
/// do not show "+1.2e-05 %".
[[nodiscard]] std::string change_percent(double share);

/// How many times as much: "1.69" in a sentence, with two decimals.
[[nodiscard]] std::string times(double ratio);

/// "1.234 J", "1.234 mJ", "1.234 uJ", "1.234 nJ".
[[nodiscard]] std::string joules(double j);

/// Of real time: "1.2 s", "2 min 05 s", "3 h 20 min".
[[nodiscard]] std::string duration_text(double seconds);

/// Digits in groups of three: "1,234,567".
[[nodiscard]] std::string grouped(std::int64_t value);

/// A number of things, for nouns whose plural has an s: "1 node", "1,024 nodes".
[[nodiscard]] std::string counted(std::uint64_t count, std::string_view what);

/// "1.2 MiB", "1.2 KiB", "12 B".
[[nodiscard]] std::string bytes(double count);

/// A figure in its unit (studies/figures): ps as seconds(), byte as bytes(), fractions as percent() but below
/// 0.1 % with two digits, fJ and mJ as joules(), counts as grouped(), other numbers with four digits and
/// their unit; `missing` for what has no value.
[[nodiscard]] std::string figure_text(const Cell& cell, std::string_view unit, std::string_view missing);

/// A cell in short: reals with six digits, `missing` for what has no value or is not finite.
[[nodiscard]] std::string short_text(const Cell& cell, std::string_view missing);

}  // namespace marti::studies::tables
