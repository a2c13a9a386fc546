// Times and sizes as people read them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "sim/time.h"
#include "studies/tables/table.h"

namespace marti::studies {

/// "1.234 s", "1.234 ms", "1.234 us".
[[nodiscard]] std::string seconds(sim::Ticks ticks);

/// "1.234 J", "1.234 mJ", "1.234 uJ", "1.234 nJ".
[[nodiscard]] std::string joules(double j);

/// Of real time: "1.2 s", "2 min 05 s", "3 h 20 min".
[[nodiscard]] std::string duration_text(double seconds);

/// Digits in groups of three: "1,234,567".
[[nodiscard]] std::string grouped(std::int64_t value);

/// "1.2 MiB", "1.2 KiB", "12 B".
[[nodiscard]] std::string bytes(double count);

/// A cell in short: reals with six digits, `missing` for what has no value or is not finite.
[[nodiscard]] std::string short_text(const Cell& cell, std::string_view missing);

}  // namespace marti::studies
