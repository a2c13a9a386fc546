#include "studies/tables/text_units.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "studies/tables/cell_number.h"

namespace marti::studies::tables {

namespace {

constexpr sim::Ticks ticks_per_nanosecond = sim::ticks_per_second / 1'000'000'000;

// A figure from here on is shown in the larger unit: in the smaller one it would be rounded to 1000.000.
constexpr double least_whole = 0.9999995;

// The longest time that ticks hold, ps, as a double.
constexpr double longest = 0x1.fffffffffffffp62;

}  // namespace

std::string seconds(sim::Ticks ticks) {
  if (ticks == 0) {
    return "0 s";
  }
  if (ticks > 0 && ticks < ticks_per_nanosecond) {
    return fmt::format("{} ps", ticks);
  }
  const double s = static_cast<double>(ticks) / static_cast<double>(sim::ticks_per_second);
  if (s >= least_whole) {
    return fmt::format("{:.3f} s", s);
  }
  if (s >= least_whole * 1e-3) {
    return fmt::format("{:.3f} ms", s * 1e3);
  }
  return fmt::format("{:.3f} us", s * 1e6);
}

std::string computed_seconds(double ps) {
  return seconds(static_cast<sim::Ticks>(std::llround(std::clamp(ps, 0.0, longest))));
}

std::string signed_seconds(sim::Ticks ticks) {
  if (ticks == 0) {
    return seconds(ticks);
  }
  return (ticks < 0 ? "-" : "+") + seconds(ticks < 0 ? -ticks : ticks);
}

std::string fixed(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", value, decimals);
  const bool minus_zero = text.front() == '-' && text.find_first_not_of("-0.") == std::string::npos;
  return minus_zero ? text.substr(1) : text;
}

std::string percent(double share) { return fixed(100.0 * share, 2) + " %"; }

std::string rough_percent(double share) { return fixed(100.0 * share, 1) + " %"; }

std::string signed_percent(double share) {
  const double percents = 100.0 * share;
  return percents != 0.0 && std::abs(percents) < 0.005 ? fmt::format("{:+.1e} %", percents)
                                                       : fmt::format("{:+.2f} %", percents);
}

std::string change_percent(double share) {
  if (100.0 * share >= 999.995) {
    return share + 1.0 < 1000.0 ? times(share + 1.0) + " times"
                                : grouped(std::llround(std::min(share + 1.0, 0x1p62))) + " times";
  }
  return signed_percent(share);
}

std::string times(double ratio) { return fmt::format("{:.2f}", ratio); }

std::string joules(double j) {
  if (j >= least_whole) {
    return fmt::format("{:.3f} J", j);
  }
  if (j >= least_whole * 1e-3) {
    return fmt::format("{:.3f} mJ", j * 1e3);
  }
  return j >= least_whole * 1e-6 ? fmt::format("{:.3f} uJ", j * 1e6) : fmt::format("{:.3f} nJ", j * 1e9);
}

std::string counted(std::uint64_t count, std::string_view what) {
  return fmt::format("{} {}{}", grouped(static_cast<std::int64_t>(count)), what, count == 1 ? "" : "s");
}

std::string bytes(double count) {
  constexpr double least_mebibyte = 1023.95 * 1024.0;  // what is less is not rounded to 1024.0 KiB
  if (count >= least_mebibyte) {
    return fmt::format("{:.1f} MiB", count / (1024.0 * 1024.0));
  }
  return count >= 1024.0 ? fmt::format("{:.1f} KiB", count / 1024.0) : fmt::format("{:.0f} B", count);
}

std::string duration_text(double seconds) {
  // Rounded before it is divided, so that no part of it becomes 60.
  if (seconds < 59.95) {
    return fmt::format("{:.1f} s", seconds);
  }
  const double whole = std::round(seconds);
  if (whole < 3600.0) {
    return fmt::format("{:.0f} min {:02.0f} s", std::floor(whole / 60.0), std::fmod(whole, 60.0));
  }
  const double minutes = std::round(seconds / 60.0);
  return fmt::format("{:.0f} h {:02.0f} min", std::floor(minutes / 60.0), std::fmod(minutes, 60.0));
}

std::string grouped(std::int64_t value) {
  std::string digits = std::to_string(value);
  const std::size_t first = value < 0 ? 1 : 0;
  for (std::size_t at = digits.size(); at > first + 3;) {
    at -= 3;
    digits.insert(at, ",");
  }
  return digits;
}

std::string figure_text(const Cell& cell, std::string_view unit, std::string_view missing) {
  const std::optional<double> number = number_of(cell);
  if (!number || !std::isfinite(*number)) {
    return short_text(cell, missing);
  }
  if (unit == "ps" && std::abs(*number) > longest) {
    return fmt::format("{:.4g} s", *number * 1e-12);  // a sum over nodes
  }
  if (unit == "ps") {
    const auto* ticks = std::get_if<std::int64_t>(&cell);
    const std::string text = signed_seconds(ticks != nullptr ? *ticks : std::llround(*number));
    return text.starts_with('+') ? text.substr(1) : text;
  }
  if (unit == "byte") {
    return bytes(*number);
  }
  if (unit == "fraction") {
    return std::abs(*number) < 1e-3 && *number != 0.0 ? fmt::format("{:.2g} %", 100.0 * *number)
                                                      : percent(*number);
  }
  if (unit == "fJ" || unit == "mJ") {
    return joules(*number * (unit == "fJ" ? 1e-15 : 1e-3));
  }
  const auto* count = std::get_if<std::int64_t>(&cell);
  std::string text = count != nullptr ? grouped(*count) : fmt::format("{:.4g}", *number);
  if (!unit.empty() && unit != "1") {
    text += " ";
    text += unit;
  }
  return text;
}

std::string short_text(const Cell& cell, std::string_view missing) {
  if (const auto* integer = std::get_if<std::int64_t>(&cell)) {
    return std::to_string(*integer);
  }
  if (const auto* real = std::get_if<double>(&cell)) {
    return std::isfinite(*real) ? fmt::format("{:.6g}", *real) : std::string(missing);
  }
  const auto* text = std::get_if<std::string>(&cell);
  return text == nullptr ? std::string(missing) : *text;
}

}  // namespace marti::studies::tables
