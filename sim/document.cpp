#include "sim/document.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "sim/schema.h"
#include "sim/shown.h"
#include "sim/units.h"

namespace marti::sim {

namespace {

struct Words {
  std::string operator()(std::monostate /*date*/) const { return "a date or time"; }
  std::string operator()(bool /*value*/) const { return "a boolean"; }
  std::string operator()(std::int64_t value) const { return "the integer " + std::to_string(value); }
  std::string operator()(double value) const {
    std::ostringstream out;
    out << "the real " << value;
    return out.str();
  }
  std::string operator()(const std::string& value) const { return "the text \"" + shown(value) + "\""; }
  std::string operator()(const DocumentValue::List& /*list*/) const { return "a list"; }
  std::string operator()(const DocumentValue::Table& /*table*/) const { return "a table"; }
};

std::string print_text(const std::string& text) {
  const bool literal = std::none_of(text.begin(), text.end(), [](char c) {
    const auto code = static_cast<unsigned char>(c);
    return c == '\'' || code < 0x20 || code == 0x7f;
  });
  return literal ? "'" + text + "'" : print_value(ValueType::text, text);
}

std::string print_name(const std::string& name) {
  constexpr std::string_view bare = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
  return !name.empty() && name.find_first_not_of(bare) == std::string::npos ? name : print_text(name);
}

struct InLine {
  std::string operator()(std::monostate /*date*/) const { return print_text(""); }
  std::string operator()(bool value) const { return value ? "true" : "false"; }
  std::string operator()(std::int64_t value) const { return std::to_string(value); }
  std::string operator()(double value) const {
    return std::isfinite(value) ? print_real(value)
           : std::isnan(value)  ? "nan"
           : value > 0.0        ? "inf"
                                : "-inf";
  }
  std::string operator()(const std::string& value) const { return print_text(value); }
  std::string operator()(const DocumentValue::List& list) const {
    std::string text;
    for (const DocumentValue& element : list) {
      text += (text.empty() ? "" : ", ") + print_in_line(element);
    }
    return "[" + text + "]";
  }
  std::string operator()(const DocumentValue::Table& table) const {
    std::string text;
    for (const DocumentEntry& entry : table) {
      text += (text.empty() ? "" : ", ") + print_name(entry.name) + " = " + print_in_line(entry.value);
    }
    return "{" + text + "}";
  }
};

}  // namespace

std::string print_in_line(const DocumentValue& value) { return std::visit(InLine{}, value.content); }

std::string describe(const DocumentValue& value) { return std::visit(Words{}, value.content); }

const DocumentEntry* find(const DocumentValue::Table& table, std::string_view name) {
  const auto found = std::find_if(table.begin(), table.end(),
                                  [&](const DocumentEntry& entry) { return entry.name == name; });
  return found == table.end() ? nullptr : &*found;
}

}  // namespace marti::sim
