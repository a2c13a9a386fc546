#include "studies/sweep/plan/axis_text.h"

#include <fmt/format.h>

#include <optional>

#include "sim/key_value.h"
#include "studies/sweep/plan/sweep_keys.h"
#include "studies/tables/cell_number.h"

namespace marti::studies::sweep {

namespace {

// Null for "point", and for an axis that another version of the program has made.
const sim::Key* key_of(const std::string& axis) {
  const sim::Schema& schema = sweep_schema();
  const std::optional<std::size_t> index = schema.find(axis);
  return index ? &schema.keys()[*index] : nullptr;
}

bool is_real(const sim::Key& key) {
  return key.type == sim::ValueType::real || key.type == sim::ValueType::frequency ||
         key.type == sim::ValueType::percentage;
}

// No value of these types is below 0; somebody may have changed the store.
bool is_printable(const sim::Key& key, double number) {
  return key.type == sim::ValueType::integer || key.type == sim::ValueType::real || number >= 0.0;
}

}  // namespace

bool is_axis(const std::string& name) { return key_of(name) != nullptr; }

std::string axis_unit(const std::string& axis) {
  const sim::Key* const key = key_of(axis);
  return key == nullptr ? std::string() : sim::unit_of(*key);
}

bool is_boolean_axis(const std::string& axis) {
  const sim::Key* const key = key_of(axis);
  return key != nullptr && key->type == sim::ValueType::boolean && !key->is_list;
}

std::string axis_text(const std::string& axis, const tables::Cell& value) {
  if (const auto* text = std::get_if<std::string>(&value)) {
    return *text;
  }
  const std::optional<double> number = tables::number_of(value);
  if (!number) {
    return "none";
  }
  const sim::Key* const key = key_of(axis);
  const auto* integer = std::get_if<std::int64_t>(&value);
  if (integer != nullptr && is_boolean_axis(axis)) {
    return *integer != 0 ? "true" : "false";
  }
  // The key of an older store may have been a number and be a text now.
  const bool text_key =
      key != nullptr && (key->type == sim::ValueType::text || key->type == sim::ValueType::choice ||
                         key->type == sim::ValueType::boolean);
  if (key == nullptr || text_key || (integer == nullptr && !is_real(*key)) || !is_printable(*key, *number)) {
    return integer != nullptr ? std::to_string(*integer) : fmt::format("{}", *number);
  }
  std::string text = sim::print_value(key->type, is_real(*key) ? sim::Value(*number) : sim::Value(*integer));
  std::erase(text, '"');
  return text;
}

}  // namespace marti::studies::sweep
