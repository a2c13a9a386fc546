#include "studies/keys/setting_value.h"

#include <nlohmann/json.hpp>

#include "sim/error.h"
#include "sim/units.h"

namespace marti::studies {

namespace {

using Json = nlohmann::ordered_json;

// The texts, numbers, booleans and lists of a setting look alike in TOML and in JSON.
Json parsed(const std::string& toml) {
  Json json = Json::parse(toml, nullptr, false);
  return json.is_discarded() || json.is_object() || json.is_null() ? Json(toml) : json;
}

Json value_of(sim::ValueType type, const Json& json) {
  if (!json.is_string()) {
    return json;
  }
  const auto& text = json.get_ref<const std::string&>();
  try {
    switch (type) {
      case sim::ValueType::size:
        return sim::parse_size(text);
      case sim::ValueType::frequency:
        return sim::parse_frequency(text);
      case sim::ValueType::duration:
        return sim::parse_duration(text);
      case sim::ValueType::percentage:
        return sim::parse_percentage(text);
      default:
        return json;
    }
  } catch (const sim::UserError&) {
    return json;
  }
}

}  // namespace

nlohmann::ordered_json setting_value(const sim::Schema& schema, std::string_view key,
                                     const std::string& toml) {
  Json json = parsed(toml);
  const std::optional<std::size_t> index = schema.find(key);
  if (!index) {
    return json;
  }
  const sim::ValueType type = schema.keys()[*index].type;
  if (!json.is_array()) {
    return value_of(type, json);
  }
  Json list = Json::array();
  for (const Json& element : json) {
    list.push_back(value_of(type, element));
  }
  return list;
}

std::string plain_setting(const std::string& toml) {
  const Json json = parsed(toml);
  if (!json.is_string()) {
    return toml;
  }
  const auto& text = json.get_ref<const std::string&>();
  return text.empty() ? "\"\"" : text;
}

}  // namespace marti::studies
