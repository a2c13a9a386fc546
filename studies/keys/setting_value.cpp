#include "studies/keys/setting_value.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "sim/error.h"
#include "sim/units.h"
#include "studies/keys/frame_keys.h"
#include "studies/keys/machine_keys.h"
#include "studies/keys/price_keys.h"
#include "studies/keys/record_keys.h"

namespace marti::studies::keys {

namespace {

using Json = nlohmann::ordered_json;

// nullptr where no result has such a key.
const sim::Key* declared(std::string_view key) {
  static const sim::Schema schema = [] {
    sim::Schema keys;
    declare_frame_keys(keys);
    declare_machine_keys(keys);
    declare_record_keys(keys);
    declare_price_keys(keys);
    return keys;
  }();
  const std::optional<std::size_t> index = schema.find(key);
  return index ? &schema.keys()[*index] : nullptr;
}

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

// std::nullopt where the key has no such value.
std::optional<sim::Value> typed(sim::ValueType type, const Json& json) {
  using sim::ValueType;
  const double number = json.is_number() ? json.get<double>() : 0.0;
  const bool may_be_negative = type == ValueType::integer || type == ValueType::real;
  if (type == ValueType::boolean && json.is_boolean()) {
    return json.get<bool>();
  }
  if ((type == ValueType::text || type == ValueType::choice) && json.is_string()) {
    return json.get<std::string>();
  }
  if (!json.is_number() || !std::isfinite(number) || std::abs(number) >= 0x1p63 ||
      (number < 0.0 && !may_be_negative)) {
    return std::nullopt;
  }
  switch (type) {
    case ValueType::integer:
    case ValueType::size:
    case ValueType::duration:
      return json.is_number_integer() ? std::optional<sim::Value>(json.get<std::int64_t>()) : std::nullopt;
    case ValueType::real:
    case ValueType::frequency:
    case ValueType::percentage:
      return number;
    default:
      return std::nullopt;
  }
}

std::string toml_of(const sim::Key* key, const Json& json) {
  if (const std::optional<sim::Value> value = key == nullptr ? std::nullopt : typed(key->type, json)) {
    return sim::print_value(key->type, *value);
  }
  return json.is_string() ? sim::print_value(sim::ValueType::text, json.get<std::string>())
                          : json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

Json setting_value(std::string_view key, const std::string& toml) {
  Json json = parsed(toml);
  const sim::Key* const known = declared(key);
  if (known == nullptr) {
    return json;
  }
  if (!json.is_array()) {
    return value_of(known->type, json);
  }
  for (Json& element : json) {
    element = value_of(known->type, element);
  }
  return json;
}

std::string setting_toml(std::string_view key, const Json& value) {
  const sim::Key* const known = declared(key);
  if (!value.is_array()) {
    return toml_of(known, value);
  }
  std::string text;
  for (const Json& element : value) {
    text += (text.empty() ? "" : ", ") + toml_of(known, element);
  }
  return "[" + text + "]";
}

std::string plain_setting(const std::string& toml) {
  const Json json = parsed(toml);
  if (!json.is_string()) {
    return toml;
  }
  const auto& text = json.get_ref<const std::string&>();
  return text.empty() ? "\"\"" : text;
}

std::string pixels_of(const std::map<std::string, std::string>& settings) {
  if (const auto rays = settings.find("image.rays"); rays != settings.end()) {
    return "rays of " + plain_setting(rays->second);
  }
  const auto width = settings.find("image.width");
  const auto height = settings.find("image.height");
  if (width == settings.end() || height == settings.end()) {
    return {};
  }
  const auto region = settings.find("image.region");
  const bool all = region == settings.end() || region->second == "[]";
  return (all ? "" : region->second + " of ") + width->second + " x " + height->second + " pixels";
}

Json config_json(const std::string& file, const std::vector<sim::EffectiveValue>& values) {
  Json keys = Json::object();
  for (const sim::EffectiveValue& value : values) {
    keys[value.key] = {{"value", setting_value(value.key, value.value)}, {"given", value.given}};
  }
  return {{"file", file}, {"keys", keys}};
}

std::map<std::string, std::string> settings_of(const tables::RunJson& run) {
  std::map<std::string, std::string> settings;
  for (const auto& [key, setting] : run.at("config.keys").items()) {
    const auto value = setting.is_object() ? setting.find("value") : setting.end();
    if (value == setting.end() || value->is_null() || value->is_object()) {
      run.refuse("config.keys." + key + " has no \"value\" that a setting can have");
    }
    settings[key] = setting_toml(key, *value);
  }
  return settings;
}

}  // namespace marti::studies::keys
