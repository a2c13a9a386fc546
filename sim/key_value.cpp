#include "sim/key_value.h"

#include <algorithm>
#include <cmath>

#include "sim/nearest.h"
#include "sim/shown.h"
#include "sim/units.h"

namespace marti::sim {

namespace {

[[noreturn]] void fail_at(const Place& place, const std::string& message) { throw UserError(place, message); }

template <class T>
bool is(const DocumentValue& node) {
  return std::holds_alternative<T>(node.content);
}

template <class T>
const T& as(const DocumentValue& node) {
  return std::get<T>(node.content);
}

std::string expectation(const Key& key) {
  switch (key.type) {
    case ValueType::boolean:
      return "true or false";
    case ValueType::integer:
      return "an integer";
    case ValueType::real:
      return "a number";
    case ValueType::text:
      return key.may_be_composite ? "a text in quotation marks, a list or a table"
                                  : "a text in quotation marks";
    case ValueType::choice:
      return print_range(key) + " in quotation marks";
    case ValueType::size:
      return "a size such as \"16 KiB\"";
    case ValueType::frequency:
      return "a frequency such as \"33 MHz\"";
    case ValueType::duration:
      return "a duration such as \"10 ns\"";
    case ValueType::percentage:
      return "a percentage such as \"42 %\"";
  }
  throw InternalError("unknown type of value");
}

template <class Wrong>
Value real(const DocumentValue& node, const Wrong& wrong) {
  double value = 0;
  if (is<std::int64_t>(node)) {
    value = static_cast<double>(as<std::int64_t>(node));
    if (std::abs(value) > 0x1p53) {  // beyond this not every integer is a double
      wrong();
    }
  } else if (is<double>(node)) {
    value = as<double>(node);
  } else {
    wrong();
  }
  if (!std::isfinite(value)) {
    wrong();
  }
  return value;
}

/// The node converted to the key's type; the range is not checked yet.
Value typed(const Key& key, const DocumentValue& node, const Place& place) {
  const auto wrong = [&]() { fail_at(place, "must be " + expectation(key) + ", not " + describe(node)); };
  const auto parsed = [&](auto parse) -> Value {
    try {
      return parse(as<std::string>(node));
    } catch (const UserError& error) {
      fail_at(place, error.what());
    }
  };
  switch (key.type) {
    case ValueType::boolean:
      if (is<bool>(node)) {
        return as<bool>(node);
      }
      break;
    case ValueType::integer:
      if (is<std::int64_t>(node)) {
        return as<std::int64_t>(node);
      }
      break;
    case ValueType::real:
      return real(node, wrong);
    case ValueType::text:
    case ValueType::choice:
      if (is<std::string>(node)) {
        return as<std::string>(node);
      }
      if (key.may_be_composite && (node.list() != nullptr || node.table() != nullptr)) {
        return print_in_line(node);
      }
      break;
    case ValueType::size:
      if (is<std::int64_t>(node) && as<std::int64_t>(node) >= 0) {
        return as<std::int64_t>(node);
      }
      if (is<std::string>(node)) {
        return parsed([](const std::string& text) { return parse_size(text); });
      }
      break;
    case ValueType::frequency:
      if (is<std::string>(node)) {
        return parsed([](const std::string& text) { return parse_frequency(text); });
      }
      break;
    case ValueType::duration:
      if (is<std::string>(node)) {
        return parsed([](const std::string& text) { return std::int64_t{parse_duration(text)}; });
      }
      break;
    case ValueType::percentage:
      if (is<std::string>(node)) {
        return parsed([](const std::string& text) { return parse_percentage(text); });
      }
      break;
  }
  wrong();
  throw InternalError("a value of the wrong type was accepted");
}

Value convert(const Key& key, const DocumentValue& node, const Place& place) {
  Value value = typed(key, node, place);
  if (!in_range(key, value)) {
    std::string message = "must be " + print_range(key);
    if (!key.unit.empty()) {
      message += " (" + key.unit + ")";
    }
    message += ", not " + shown(print_value(key.type, value));
    if (key.type == ValueType::choice) {
      const auto& given = std::get<std::string>(value);
      const auto renamed = std::ranges::find(key.renamed, given, &RenamedChoice::before);
      message += renamed == key.renamed.end() ? did_you_mean(given, key.choices)
                                              : ", which is \"" + std::string(renamed->now) + "\" here";
    }
    fail_at(place, message);
  }
  return value;
}

}  // namespace

std::string unit_of(const Key& key) {
  switch (key.type) {
    case ValueType::size:
      return "byte";
    case ValueType::frequency:
      return "Hz";
    case ValueType::duration:
      return "ps";
    case ValueType::percentage:
      return "1";
    default:
      return key.unit;
  }
}

std::string expected_of(const Key& key) {
  return key.is_list ? "a list in brackets, each " + expectation(key) : expectation(key);
}

std::vector<Value> read_values(const Key& key, const DocumentValue& value, const Place& place) {
  std::vector<Value> values;
  if (!key.is_list) {
    values.push_back(convert(key, value, place));
    return values;
  }
  const DocumentValue::List* list = value.list();
  if (list == nullptr) {
    fail_at(place, "must be " + expected_of(key) + ", not " + describe(value));
  }
  values.reserve(list->size());
  for (const DocumentValue& element : *list) {
    values.push_back(convert(key, element, place));
  }
  return values;
}

}  // namespace marti::sim
