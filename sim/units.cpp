#include "sim/units.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <system_error>

#include "sim/parse_number.h"
#include "sim/shown.h"

namespace marti::sim {

namespace {

struct Unit {
  std::string_view name;
  std::int64_t scale;  // in the base unit
};

constexpr std::int64_t kibi = 1024;
constexpr std::array size_units{Unit{"B", 1}, Unit{"KiB", kibi}, Unit{"MiB", kibi* kibi},
                                Unit{"GiB", kibi* kibi* kibi}, Unit{"TiB", kibi* kibi* kibi* kibi}};
constexpr std::array duration_units{Unit{"ps", 1}, Unit{"ns", 1'000}, Unit{"us", 1'000'000},
                                    Unit{"ms", 1'000'000'000}, Unit{"s", ticks_per_second}};
constexpr std::array frequency_units{Unit{"Hz", 0}, Unit{"kHz", 3}, Unit{"MHz", 6}, Unit{"GHz", 9},
                                     Unit{"THz", 12}};  // powers of ten

constexpr std::string_view size_hint =
    "a size is a number with a unit, such as \"16 KiB\" (B, KiB, MiB, GiB, TiB)";
constexpr std::string_view duration_hint =
    "a duration is a number with a unit, such as \"10 ns\" (ps, ns, us, ms, s)";
constexpr std::string_view frequency_hint =
    "a frequency is a number with a unit, such as \"33 MHz\" (Hz, kHz, MHz, GHz, THz)";
constexpr std::string_view percentage_hint =
    "a percentage is a number from 0 on with its sign, such as \"42 %\"";

[[noreturn]] void refuse(std::string_view text, std::string_view reason) {
  throw UserError("\"" + shown(text) + "\": " + std::string(reason));
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::string_view trim(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) {
    text.remove_prefix(1);
  }
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) {
    text.remove_suffix(1);
  }
  return text;
}

struct Quantity {
  std::string_view whole;     // digits before the point, at least one
  std::string_view fraction;  // digits after it, at least one if there is a point
  std::string_view unit;
};

Quantity split(std::string_view text, std::string_view hint) {
  const std::string_view trimmed = trim(text);
  std::size_t at = 0;
  const auto digits = [&] {
    const std::size_t begin = at;
    while (at < trimmed.size() && is_digit(trimmed[at])) {
      ++at;
    }
    return trimmed.substr(begin, at - begin);
  };
  Quantity quantity;
  quantity.whole = digits();
  bool wrong = quantity.whole.empty();
  if (at < trimmed.size() && trimmed[at] == '.') {
    ++at;
    quantity.fraction = digits();
    wrong = wrong || quantity.fraction.empty();
  }
  if (wrong) {
    refuse(text, hint);
  }
  quantity.unit = trim(trimmed.substr(at));
  return quantity;
}

const Unit* find_unit(std::span<const Unit> units, std::string_view name) {
  for (const Unit& unit : units) {
    if (unit.name == name) {
      return &unit;
    }
  }
  return nullptr;
}

/// whole.fraction * scale, if it is a whole number that fits in 63 bits.
std::int64_t exact_product(std::string_view text, const Quantity& quantity, std::int64_t scale,
                           std::string_view base) {
  const std::string not_whole = "is not a whole number of " + std::string(base);
  std::string_view fraction = quantity.fraction;
  while (!fraction.empty() && fraction.back() == '0') {
    fraction.remove_suffix(1);
  }
  // A scale up to 2^40 or 10^12 has at most 40 factors of 2 and 12 of 5, so further digits cannot cancel.
  constexpr std::size_t most_digits = 40;
  if (fraction.size() > most_digits) {
    refuse(text, not_whole);
  }
  // Long division of scale * 0.fraction: each step, from the last digit on, must leave no remainder.
  __int128 part = 0;
  constexpr __int128 limit = std::numeric_limits<std::int64_t>::max();
  for (std::size_t i = fraction.size(); i-- > 0;) {
    part += static_cast<__int128>(fraction[i] - '0') * scale;
    if (part % 10 != 0) {
      refuse(text, not_whole);
    }
    part /= 10;
  }
  __int128 whole = 0;
  for (const char digit : quantity.whole) {
    whole = whole * 10 + (digit - '0');
    if (whole > limit) {
      break;
    }
  }
  if (whole > limit || whole * scale + part > limit) {
    refuse(text, "is too large: at most 2^63 - 1 " + std::string(base));
  }
  return static_cast<std::int64_t>(whole * scale + part);
}

/// The digits of a decimal text with the point moved left by `places`: 33300000, 6 -> 33.3.
std::string shift_point(std::string digits, int places) {
  std::size_t point = digits.find('.');
  if (point == std::string::npos) {
    point = digits.size();
  } else {
    digits.erase(point, 1);
  }
  const auto shift = static_cast<std::size_t>(places);
  if (point <= shift) {
    digits.insert(0, shift - point + 1, '0');
    point = shift + 1;
  }
  digits.insert(point - shift, ".");
  while (digits.back() == '0') {
    digits.pop_back();
  }
  if (digits.back() == '.') {
    digits.pop_back();
  }
  return digits;
}

std::string decimal(double value) {
  std::array<char, 400> buffer{};
  const auto [end, error] =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::fixed);
  ensure(error == std::errc{}, "a number does not fit its buffer");
  return {buffer.data(), end};
}

/// The double nearest to whole.fraction * 10^exponent.
double nearest_real(std::string_view text, const Quantity& quantity, int exponent) {
  const std::string written =
      std::string(quantity.whole) + "." + std::string(quantity.fraction) + "0e" + std::to_string(exponent);
  const std::optional<double> value = parse_number<double>(written);
  if (!value || !std::isfinite(*value)) {
    refuse(text, "is too large or too small for a number");
  }
  return *value;
}

/// The value with the largest unit that divides it.
std::string print_exact(std::int64_t value, std::span<const Unit> units) {
  const Unit* best = &units.front();
  for (const Unit& unit : units) {
    if (value != 0 && value % unit.scale == 0) {
      best = &unit;
    }
  }
  return std::to_string(value / best->scale) + " " + std::string(best->name);
}

}  // namespace

std::int64_t parse_size(std::string_view text) {
  const Quantity quantity = split(text, size_hint);
  if (quantity.unit.empty()) {
    return exact_product(text, quantity, 1, "bytes");
  }
  if (const Unit* unit = find_unit(size_units, quantity.unit)) {
    return exact_product(text, quantity, unit->scale, "bytes");
  }
  constexpr std::array<std::string_view, 8> ambiguous{"kB", "KB", "K", "k", "MB", "M", "GB", "G"};
  for (const std::string_view name : ambiguous) {
    if (quantity.unit == name) {
      refuse(text, "the unit " + std::string(name) + " is ambiguous: write KiB, MiB or GiB (powers of 1024)");
    }
  }
  refuse(text, size_hint);
}

std::string print_size(std::int64_t bytes) {
  ensure(bytes >= 0, "a size is not negative");
  return print_exact(bytes, size_units);
}

double parse_frequency(std::string_view text) {
  const Quantity quantity = split(text, frequency_hint);
  const Unit* unit = find_unit(frequency_units, quantity.unit);
  if (unit == nullptr) {
    refuse(text, frequency_hint);
  }
  return nearest_real(text, quantity, static_cast<int>(unit->scale));
}

std::string print_frequency(double hertz) {
  ensure(std::isfinite(hertz) && hertz >= 0, "a frequency is finite and not negative");
  const Unit* best = frequency_units.data();
  for (const Unit& unit : frequency_units) {
    if (hertz >= std::pow(10.0, static_cast<double>(unit.scale))) {
      best = &unit;
    }
  }
  // The shortest digits in hertz, the point moved as text: not rounded, so they read back as the same double.
  return shift_point(decimal(hertz), static_cast<int>(best->scale)) + " " + std::string(best->name);
}

Ticks parse_duration(std::string_view text) {
  const Quantity quantity = split(text, duration_hint);
  const Unit* unit = find_unit(duration_units, quantity.unit);
  if (unit == nullptr) {
    refuse(text, duration_hint);
  }
  return exact_product(text, quantity, unit->scale, "picoseconds");
}

std::string print_duration(Ticks duration) {
  ensure(duration >= 0, "a printed duration is not negative");
  return print_exact(duration, duration_units);
}

double parse_percentage(std::string_view text) {
  const Quantity quantity = split(text, percentage_hint);
  if (quantity.unit != "%") {
    refuse(text, percentage_hint);
  }
  return nearest_real(text, quantity, -2);
}

std::string print_percentage(double fraction) {
  ensure(std::isfinite(fraction) && fraction >= 0, "a percentage is finite and not negative");
  // The point is moved two places to the right in the text of the number, so nothing is rounded.
  std::string digits = decimal(fraction);
  std::size_t point = digits.find('.');
  if (point == std::string::npos) {
    point = digits.size();
  } else {
    digits.erase(point, 1);
  }
  if (digits.size() < point + 2) {
    digits.append(point + 2 - digits.size(), '0');
  }
  digits.insert(point + 2, ".");
  digits.erase(0, std::min(digits.find_first_not_of('0'), point + 1));
  if (digits.front() == '.') {
    digits.insert(0, 1, '0');
  }
  return shift_point(digits, 0) + " %";
}

std::string print_real(double value) {
  ensure(std::isfinite(value), "a printed number is finite");
  std::array<char, 40> buffer{};
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  ensure(error == std::errc{}, "a number does not fit its buffer");
  std::string digits(buffer.data(), end);
  if (digits.find_first_of(".e") == std::string::npos) {
    digits += ".0";
  }
  return digits;
}

}  // namespace marti::sim
