#include "sim/schema.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/error.h"
#include "sim/joined.h"
#include "sim/units.h"

namespace marti::sim {

namespace {

std::string quote(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    constexpr std::string_view hex = "0123456789abcdef";
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      quoted += '\\';
      quoted += c;
    } else if (code < 0x20 || code == 0x7f) {
      quoted += "\\u00";
      quoted += hex[code >> 4U];
      quoted += hex[code & 15U];
    } else {
      quoted += c;
    }
  }
  return quoted + "\"";
}

/// A value without TOML's quotation marks.
std::string print_bare(ValueType type, const Value& value) {
  switch (type) {
    case ValueType::boolean:
      return std::get<bool>(value) ? "true" : "false";
    case ValueType::integer:
      return std::to_string(std::get<std::int64_t>(value));
    case ValueType::real:
      return print_real(std::get<double>(value));
    case ValueType::text:
    case ValueType::choice:
      return std::get<std::string>(value);
    case ValueType::size:
      return print_size(std::get<std::int64_t>(value));
    case ValueType::frequency:
      return print_frequency(std::get<double>(value));
    case ValueType::duration:
      return print_duration(std::get<std::int64_t>(value));
    case ValueType::percentage:
      return print_percentage(std::get<double>(value));
  }
  throw InternalError("unknown type of value");
}

bool valid_name(std::string_view name) {
  const bool letters = std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '.';
  });
  return letters && !name.empty() && name.front() != '.' && name.back() != '.' &&
         name.find("..") == std::string_view::npos;
}

Value parse_default(ValueType type, std::string_view text) {
  switch (type) {
    case ValueType::size:
      return parse_size(text);
    case ValueType::frequency:
      return parse_frequency(text);
    case ValueType::duration:
      return Value(std::int64_t{parse_duration(text)});
    case ValueType::percentage:
      return parse_percentage(text);
    default:
      return std::string(text);
  }
}

Key make_key(std::string_view name, ValueType type, std::string_view unit, std::string_view meaning) {
  Key key;
  key.name = name;
  key.type = type;
  key.unit = unit;
  key.meaning = meaning;
  return key;
}

Key make_quantity(std::string_view name, ValueType type, std::string_view default_value,
                  const Schema::Range<std::string_view>& range, std::string_view meaning) {
  Key key = make_key(name, type, "", meaning);
  key.default_value.push_back(parse_default(type, default_value));
  if (range.minimum) {
    key.minimum = parse_default(type, *range.minimum);
  }
  if (range.maximum) {
    key.maximum = parse_default(type, *range.maximum);
  }
  return key;
}

template <class T>
Key make_number(std::string_view name, ValueType type, const Schema::Range<T>& range, std::string_view unit,
                std::string_view meaning) {
  Key key = make_key(name, type, unit, meaning);
  if (range.minimum) {
    key.minimum = Value(*range.minimum);
  }
  if (range.maximum) {
    key.maximum = Value(*range.maximum);
  }
  return key;
}

std::size_t alternative_of(ValueType type) {
  switch (type) {
    case ValueType::boolean:
      return Value(true).index();
    case ValueType::integer:
    case ValueType::size:
    case ValueType::duration:
      return Value(std::int64_t{0}).index();
    case ValueType::real:
    case ValueType::frequency:
    case ValueType::percentage:
      return Value(0.0).index();
    case ValueType::text:
    case ValueType::choice:
      break;
  }
  return Value(std::string()).index();
}

}  // namespace

std::string_view name_of(ValueType type) {
  switch (type) {
    case ValueType::boolean:
      return "boolean";
    case ValueType::integer:
      return "integer";
    case ValueType::real:
      return "real";
    case ValueType::text:
      return "text";
    case ValueType::choice:
      return "choice";
    case ValueType::size:
      return "size";
    case ValueType::frequency:
      return "frequency";
    case ValueType::duration:
      return "duration";
    case ValueType::percentage:
      return "percentage";
  }
  throw InternalError("unknown type of value");
}

std::string print_value(ValueType type, const Value& value) {
  const bool bare = type == ValueType::boolean || type == ValueType::integer || type == ValueType::real;
  return bare ? print_bare(type, value) : quote(print_bare(type, value));
}

std::string print_values(const Key& key, std::span<const Value> values) {
  if (!key.is_list) {
    return print_value(key.type, values.front());
  }
  std::string printed = "[";
  for (const Value& value : values) {
    printed += printed.size() > 1 ? ", " : "";
    printed += print_value(key.type, value);
  }
  return printed + "]";
}

std::string print_range(const Key& key) {
  if (key.type == ValueType::choice) {
    return listed(key.choices, " or ");
  }
  if (key.minimum && key.maximum) {
    return print_bare(key.type, *key.minimum) + " to " + print_bare(key.type, *key.maximum);
  }
  if (key.minimum) {
    return "at least " + print_bare(key.type, *key.minimum);
  }
  if (key.maximum) {
    return "at most " + print_bare(key.type, *key.maximum);
  }
  return "";
}

bool in_range(const Key& key, const Value& value) {
  // Values of one type are ordered as their numbers are.
  return (!key.minimum || value >= *key.minimum) && (!key.maximum || value <= *key.maximum) &&
         (key.choices.empty() || std::find(key.choices.begin(), key.choices.end(),
                                           std::get<std::string>(value)) != key.choices.end());
}

void Schema::section(std::string_view name, std::string_view meaning) {
  ensure(valid_name(name), "a section's name is not made of lower-case letters, digits and '_'");
  sections_.push_back({std::string(name), std::string(meaning)});
}

void Schema::free_section(std::string_view name, std::string_view meaning) {
  ensure(valid_name(name) && name.find('.') == std::string_view::npos && !find(name),
         "a free section needs a name of one part that is no key");
  section(name, meaning);
  free_sections_.emplace_back(name);
}

void Schema::boolean(std::string_view name, bool default_value, std::string_view meaning) {
  Key key = make_key(name, ValueType::boolean, "", meaning);
  key.default_value.emplace_back(default_value);
  add(std::move(key));
}

void Schema::integer(std::string_view name, std::int64_t default_value, Range<std::int64_t> range,
                     std::string_view unit, std::string_view meaning) {
  Key key = make_number(name, ValueType::integer, range, unit, meaning);
  key.default_value.emplace_back(default_value);
  add(std::move(key));
}

void Schema::real(std::string_view name, double default_value, Range<double> range, std::string_view unit,
                  std::string_view meaning) {
  Key key = make_number(name, ValueType::real, range, unit, meaning);
  key.default_value.emplace_back(default_value);
  add(std::move(key));
}

void Schema::text(std::string_view name, std::string_view default_value, std::string_view meaning) {
  Key key = make_key(name, ValueType::text, "", meaning);
  key.default_value.emplace_back(std::string(default_value));
  add(std::move(key));
}

void Schema::text_or_composite(std::string_view name, std::string_view default_value,
                               std::string_view meaning) {
  Key key = make_key(name, ValueType::text, "", meaning);
  key.default_value.emplace_back(std::string(default_value));
  key.may_be_composite = true;
  add(std::move(key));
}

void Schema::choice(std::string_view name, std::string_view default_value, std::vector<std::string> choices,
                    std::string_view meaning, std::span<const RenamedChoice> renamed) {
  Key key = make_key(name, ValueType::choice, "", meaning);
  key.default_value.emplace_back(std::string(default_value));
  key.choices = std::move(choices);
  key.renamed = renamed;
  add(std::move(key));
}

void Schema::size(std::string_view name, std::string_view default_value, Range<std::string_view> range,
                  std::string_view meaning) {
  add(make_quantity(name, ValueType::size, default_value, range, meaning));
}

void Schema::frequency(std::string_view name, std::string_view default_value, Range<std::string_view> range,
                       std::string_view meaning) {
  add(make_quantity(name, ValueType::frequency, default_value, range, meaning));
}

void Schema::duration(std::string_view name, std::string_view default_value, Range<std::string_view> range,
                      std::string_view meaning) {
  add(make_quantity(name, ValueType::duration, default_value, range, meaning));
}

void Schema::percentage(std::string_view name, std::string_view default_value, Range<std::string_view> range,
                        std::string_view meaning) {
  add(make_quantity(name, ValueType::percentage, default_value, range, meaning));
}

void Schema::integers(std::string_view name, std::vector<std::int64_t> default_value,
                      Range<std::int64_t> range, std::string_view unit, std::string_view meaning) {
  Key key = make_number(name, ValueType::integer, range, unit, meaning);
  key.is_list = true;
  key.default_value.assign(default_value.begin(), default_value.end());
  add(std::move(key));
}

void Schema::reals(std::string_view name, std::vector<double> default_value, Range<double> range,
                   std::string_view unit, std::string_view meaning) {
  Key key = make_number(name, ValueType::real, range, unit, meaning);
  key.is_list = true;
  key.default_value.assign(default_value.begin(), default_value.end());
  add(std::move(key));
}

void Schema::texts(std::string_view name, std::vector<std::string> default_value, std::string_view meaning) {
  Key key = make_key(name, ValueType::text, "", meaning);
  key.is_list = true;
  key.default_value.assign(default_value.begin(), default_value.end());
  add(std::move(key));
}

void Schema::add(Key key) {
  const auto check = [&](bool holds, std::string_view what) {
    if (!holds) {
      throw InternalError("key " + key.name + ": " + std::string(what));
    }
  };
  check(valid_name(key.name), "a name is made of lower-case letters, digits, '_' and '.'");
  check(!index_.contains(key.name), "declared twice");
  check(!is_section(key.name), "a section has this name");
  for (std::size_t dot = key.name.find('.'); dot != std::string::npos; dot = key.name.find('.', dot + 1)) {
    check(!index_.contains(key.name.substr(0, dot)), "a key has the name of its section");
  }
  check(key.is_list || key.default_value.size() == 1, "needs one default");
  check((key.type == ValueType::choice) != key.choices.empty(), "a choice, and only a choice, has choices");
  for (const Value& value : key.default_value) {
    check(value.index() == alternative_of(key.type), "the default has another type");
    check(in_range(key, value), "the default is out of range");
  }
  for (std::size_t dot = key.name.find('.'); dot != std::string::npos; dot = key.name.find('.', dot + 1)) {
    prefixes_.insert(key.name.substr(0, dot));
  }
  index_.emplace(key.name, keys_.size());
  names_.push_back(key.name);
  keys_.push_back(std::move(key));
}

std::optional<std::size_t> Schema::find(std::string_view name) const {
  const auto found = index_.find(name);
  if (found == index_.end()) {
    return std::nullopt;
  }
  return found->second;
}

bool Schema::is_free_section(std::string_view name) const {
  return std::find(free_sections_.begin(), free_sections_.end(), name) != free_sections_.end();
}

void Schema::elsewhere(std::string_view section, std::string_view command) {
  elsewhere_.emplace_back(section, command);
}

std::string_view Schema::elsewhere_of(std::string_view name) const {
  const std::string_view section = name.substr(0, name.find('.'));
  if (is_section(section)) {
    return {};
  }
  const auto found = std::find_if(elsewhere_.begin(), elsewhere_.end(),
                                  [&](const auto& one) { return one.first == section; });
  return found == elsewhere_.end() ? std::string_view() : std::string_view(found->second);
}

bool Schema::is_section(std::string_view name) const {
  return prefixes_.contains(name) || is_free_section(name);
}

}  // namespace marti::sim
