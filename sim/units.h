// Numbers with units as people write them: sizes ("16 KiB"), frequencies ("33 MHz"), durations ("10 ns") and
// percentages ("42 %"). A number is decimal digits with an optional fraction; blanks between number and unit
// are optional; units are case-sensitive. Parsing is exact: a value that is not a whole number of bytes or
// ticks, or does not fit, is a UserError that says what would be right. Every parse_x(print_x(v)) == v.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "sim/time.h"

namespace marti::sim {

/// Bytes, from 0 to 2^63 - 1. Units: none or B, KiB, MiB, GiB, TiB (powers of 1,024). The ambiguous kB,
/// KB, MB, ... are refused.
std::int64_t parse_size(std::string_view text);
std::string print_size(std::int64_t bytes);

/// Hertz, the double nearest to the decimal number. Units: Hz, kHz, MHz, GHz, THz; one is required.
double parse_frequency(std::string_view text);
/// `hertz` must be finite and not negative.
std::string print_frequency(double hertz);

/// Ticks (picoseconds). Units: ps, ns, us, ms, s; one is required.
Ticks parse_duration(std::string_view text);
/// `duration` must not be negative.
std::string print_duration(Ticks duration);

/// A fraction: "42 %" is 0.42. The sign % is required.
double parse_percentage(std::string_view text);
/// `fraction` must be finite and not negative.
std::string print_percentage(double fraction);

/// The shortest decimal text that reads back as the same double; always with a point or an exponent, so
/// that it is a TOML and JSON real. `value` must be finite.
std::string print_real(double value);

}  // namespace marti::sim
