#include "studies/estimate/measured_errors.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>

#include "sim/error.h"
#include "studies/estimate/simulator_methods.h"

namespace marti::studies::estimate {

namespace {

constexpr std::size_t first_figure = 4;
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
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !(value >= 0.0)) {
    fail("\"" + std::string(text) + "\" is no number from 0 on");
  }
  return value;
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
  const auto* const found = std::lower_bound(load_classes.begin(), load_classes.end(), use);
  return std::min<std::size_t>(static_cast<std::size_t>(found - load_classes.begin()),
                               load_classes.size() - 1);
}

std::vector<MeasuredError> parse_measured_errors(std::string_view csv) {
  const std::array<std::string_view, column_count> header = cells_of(take_line(csv));
  constexpr std::array<std::string_view, first_figure> first = {"version", "use_to", "cases", "covered"};
  for (std::size_t i = 0; i < column_count; ++i) {
    const std::string_view wanted = i < first_figure ? first[i] : figure_names[i - first_figure];
    if (header[i] != wanted) {
      fail("a column \"" + std::string(header[i]) + "\" where \"" + std::string(wanted) + "\" should be");
    }
  }
  std::vector<MeasuredError> errors;
  while (!csv.empty()) {
    const std::array<std::string_view, column_count> cells = cells_of(take_line(csv));
    if (whole_number_of(cells[0]) != methods_version) {
      fail("version " + std::string(cells[0]) + ", but the program's methods are of version " +
           std::to_string(methods_version));
    }
    MeasuredError error;
    error.use_to = number_of(cells[1]);
    error.cases = whole_number_of(cells[2]);
    error.covered = number_of(cells[3]);
    if (errors.size() == load_classes.size() || error.use_to != load_classes[errors.size()]) {
      fail("a class of load that is not known, or not in its place");
    }
    for (std::size_t i = 0; i < figure_count; ++i) {
      error.allowance[static_cast<Figure>(i)] = number_of(cells[first_figure + i]);
    }
    errors.push_back(error);
  }
  if (errors.size() != load_classes.size()) {
    fail("classes of load are missing");
  }
  return errors;
}

}  // namespace marti::studies::estimate
