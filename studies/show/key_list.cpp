#include "studies/show/key_list.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "sim/error.h"
#include "sim/key_value.h"
#include "sim/nearest.h"
#include "sim/shown.h"

namespace marti::studies::show {

namespace {

using Json = nlohmann::ordered_json;

void require_any(const sim::Schema& schema, std::string_view only) {
  const auto keys = schema.keys();
  if (std::ranges::none_of(keys, [&](const sim::Key& key) { return sim::is_or_is_below(key, only); })) {
    throw sim::UserError("config: there is no key and no section \"" + sim::shown(only) + "\"" +
                         sim::did_you_mean(only, schema.names()) + "; `marti config` lists all keys");
  }
}

Json json_of_value(const sim::Value& value) {
  return std::visit([](const auto& content) { return Json(content); }, value);
}

Json json_of_key(const sim::Key& key) {
  Json value;
  if (key.is_list) {
    value = Json::array();
    for (const sim::Value& element : key.default_value) {
      value.push_back(json_of_value(element));
    }
  } else {
    value = json_of_value(key.default_value.front());
  }
  return {{"name", key.name},
          {"type", name_of(key.type)},
          {"list", key.is_list},
          {"default", value},
          {"minimum", json_of_bound(key.minimum)},
          {"maximum", json_of_bound(key.maximum)},
          {"choices", key.choices},
          {"unit", sim::unit_of(key)},
          {"meaning", key.meaning}};
}

}  // namespace

nlohmann::ordered_json json_of_bound(const std::optional<sim::Value>& bound) {
  return bound ? json_of_value(*bound) : Json();
}

std::string keys_as_text(const sim::Schema& schema, std::string_view only) {
  require_any(schema, only);
  return sim::list_keys_as_text(schema, 100, only);
}

std::string keys_as_json(const sim::Schema& schema, std::string_view only) {
  require_any(schema, only);
  Json keys = Json::array();
  for (const sim::Key& key : schema.keys()) {
    if (sim::is_or_is_below(key, only)) {
      keys.push_back(json_of_key(key));
    }
  }
  return keys.dump(2) + "\n";
}

}  // namespace marti::studies::show
