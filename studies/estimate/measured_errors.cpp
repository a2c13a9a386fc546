#include "studies/estimate/measured_errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "sim/error.h"
#include "sim/parse_number.h"
#include "studies/estimate/simulator_methods.h"

namespace marti::studies::estimate {

namespace {

constexpr std::size_t first_figure = 5;
constexpr std::size_t column_count = first_figure + figure_count;

[[noreturn]] void fail(const std::string& reason) {
  throw sim::InternalError("the table of measured errors: " + reason);
}

// The text up to `separator`, which is taken off with it.
std::string_view take(std::string_view& text, std::string_view separator) {
  const std::size_t end = std::min(text.find(separator), text.size());
  const std::string_view part = text.substr(0, end);
  text.remove_prefix(std::min(text.size(), end + separator.size()));
  return part;
}

// A compiler may leave the carriage returns of an embedded text out.
std::string_view take_line(std::string_view& text) {
  std::string_view line = take(text, "\n");
  if (line.ends_with('\r')) {
    line.remove_suffix(1);
  }
  return line;
}

std::array<std::string_view, column_count> cells_of(std::string_view line) {
  std::array<std::string_view, column_count> cells;
  for (std::string_view& cell : cells) {
    if (line.empty()) {
      fail("a row of too few cells");
    }
    cell = take(line, ",");
  }
  if (!line.empty()) {
    fail("a row of too many cells");
  }
  return cells;
}

double number_of(std::string_view text) {
  if (text == "inf") {
    return std::numeric_limits<double>::infinity();
  }
  const std::optional<double> value = sim::parse_number<double>(text);
  if (!value || !(*value >= 0.0)) {
    fail("\"" + std::string(text) + "\" is no number from 0 on");
  }
  return *value;
}

std::size_t whole_number_of(std::string_view text) {
  const double value = number_of(text);
  if (value != std::floor(value) || value > 1e9) {
    fail("\"" + std::string(text) + "\" is no whole number");
  }
  return static_cast<std::size_t>(value);
}

}  // namespace

std::size_t load_class_of(double use) {
  const auto* const found = std::ranges::lower_bound(load_classes, use);
  return std::min<std::size_t>(static_cast<std::size_t>(found - load_classes.begin()),
                               load_classes.size() - 1);
}

std::size_t size_class_of(std::uint64_t windows) {
  const auto* const above = std::ranges::upper_bound(sample_sizes, windows);
  sim::ensure(above != sample_sizes.begin(), "no errors are known of so few windows");
  return static_cast<std::size_t>(above - sample_sizes.begin()) - 1;
}

MeasuredErrors parse_measured_errors(std::string_view csv) {
  const std::array<std::string_view, column_count> header = cells_of(take_line(csv));
  constexpr std::array<std::string_view, first_figure> first = {"version", "use_to", "windows", "cases",
                                                                "covered"};
  for (std::size_t i = 0; i < column_count; ++i) {
    const std::string_view wanted = i < first_figure ? first[i] : figure_names[i - first_figure];
    if (header[i] != wanted) {
      fail("a column \"" + std::string(header[i]) + "\" where \"" + std::string(wanted) + "\" should be");
    }
  }
  MeasuredErrors errors;
  for (std::size_t row = 0; row < load_classes.size() * sample_sizes.size(); ++row) {
    const std::size_t load = row / sample_sizes.size();
    const std::size_t size = row % sample_sizes.size();
    const std::array<std::string_view, column_count> cells = cells_of(take_line(csv));
    if (whole_number_of(cells[0]) != methods_version) {
      fail("version " + std::string(cells[0]) + ", but the program's methods are of version " +
           std::to_string(methods_version));
    }
    MeasuredError& error = errors[load][size];
    error.use_to = number_of(cells[1]);
    error.windows = whole_number_of(cells[2]);
    error.cases = whole_number_of(cells[3]);
    error.covered = number_of(cells[4]);
    if (error.use_to != load_classes[load] || error.windows != sample_sizes[size]) {
      fail("a class of load or of size that is not known, or not in its place");
    }
    for (std::size_t i = 0; i < figure_count; ++i) {
      error.allowance[static_cast<Figure>(i)] = number_of(cells[first_figure + i]);
    }
  }
  if (!csv.empty()) {
    fail("more rows than classes");
  }
  return errors;
}

}  // namespace marti::studies::estimate
