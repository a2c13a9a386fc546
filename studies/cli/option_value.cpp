#include "studies/cli/option_value.h"

#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "sim/document.h"
#include "sim/key_value.h"
#include "sim/shown.h"

namespace marti::studies::cli {

namespace {

template <class Number>
bool reads_as(std::string_view text, Number& number) {
  const char* const end = text.data() + text.size();
  const auto [rest, fault] = std::from_chars(text.data(), end, number);
  return fault == std::errc() && rest == end;
}

// A number as one, anything else as a text.
sim::DocumentValue value_of(const std::string& text) {
  if (std::int64_t integer = 0; reads_as(text, integer)) {
    return {integer};
  }
  if (double real = 0.0; reads_as(text, real)) {
    return {real};
  }
  return {text};
}

}  // namespace

CLI::Option* takes_value(CLI::Option* option, const sim::Key& key) {
  // Completion reads a set of words in this form (shell_completion.cpp).
  const std::string values =
      key.choices.empty() ? sim::print_range(key) : fmt::format("{{{}}}", fmt::join(key.choices, ","));
  return option->check(CLI::Validator(
      [option, key](std::string& text) {
        (void)sim::read_values(key, value_of(text), sim::Place{option->get_name() + "=" + sim::shown(text)});
        return std::string();
      },
      values));
}

}  // namespace marti::studies::cli
