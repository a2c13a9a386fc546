// Values of settings as text in TOML files, typed in results, and as people write them.
#include "studies/keys/setting_value.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "sim/schema.h"
#include "studies/show/lists.h"
#include "studies/sweep/plan/sweep_keys.h"
#include "tests/support/user_error.h"

namespace marti::studies {

using namespace keys;
using namespace show;
using namespace sweep;
using namespace tables;

namespace {

using Json = nlohmann::ordered_json;

Json json_of(const sim::Value& value) {
  return std::visit([](const auto& content) { return Json(content); }, value);
}

// Values of the key: its default, the ends of its range, its choices and random ones between.
std::vector<sim::Value> values_of(const sim::Key& key, std::mt19937_64& random) {
  std::vector<sim::Value> values = key.default_value;
  for (const std::optional<sim::Value>& end : {key.minimum, key.maximum}) {
    if (end) {
      values.push_back(*end);
    }
  }
  values.insert(values.end(), key.choices.begin(), key.choices.end());
  if (key.type == sim::ValueType::boolean) {
    values.insert(values.end(), {true, false});
  } else if (key.type == sim::ValueType::text) {
    values.insert(values.end(), {"", "a \"b\" \\ \x1f\x7f", "16", "true", "[1]", "\u00e9"});
  }
  for (int i = 0; i < 20 && key.minimum && key.maximum; ++i) {
    if (const auto* const low = std::get_if<std::int64_t>(&*key.minimum)) {
      values.emplace_back(
          std::uniform_int_distribution<std::int64_t>(*low, std::get<std::int64_t>(*key.maximum))(random));
    } else {
      values.emplace_back(std::uniform_real_distribution<double>(std::get<double>(*key.minimum),
                                                                 std::get<double>(*key.maximum))(random));
    }
  }
  return values;
}

// Any value of any key, printed as in a file, is the number, boolean or text itself in a result, and comes
// back as the same text.
TEST(SettingValue, IsTypedAndComesBack) {
  std::mt19937_64 random(1);
  int numbers = 0;
  for (const sim::Key& key : sweep_schema().keys()) {
    Json all = Json::array();
    const std::vector<sim::Value> values = values_of(key, random);
    for (const sim::Value& value : values) {
      const std::string text = sim::print_value(key.type, value);
      EXPECT_EQ(setting_value(key.name, text), json_of(value)) << key.name << " = " << text;
      EXPECT_EQ(setting_value(key.name, text).is_number_float(), json_of(value).is_number_float())
          << key.name << " = " << text;
      EXPECT_EQ(setting_toml(key.name, json_of(value)), text) << key.name;
      numbers += json_of(value).is_number() ? 1 : 0;
      all.push_back(json_of(value));
    }
    sim::Key list = key;
    list.is_list = true;
    const std::string text = sim::print_values(list, values);
    EXPECT_EQ(setting_value(key.name, text), all) << key.name << " = " << text;
    EXPECT_EQ(setting_toml(key.name, all), text) << key.name;
  }
  EXPECT_GT(numbers, 1000);
}

// The defaults are those of `marti config --json`.
TEST(SettingValue, IsWhatConfigJsonHas) {
  const auto keys = Json::parse(keys_as_json(sweep_schema(), ""));
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const sim::Key& key = sweep_schema().keys()[i];
    ASSERT_EQ(keys[i]["name"], key.name);
    const std::string printed = sim::print_values(key, key.default_value);
    EXPECT_EQ(setting_value(key.name, printed), keys[i]["default"]) << key.name << " = " << printed;
  }
}

TEST(SettingValue, OtherTextsStayTexts) {
  EXPECT_EQ(setting_value("cache.size", "\"16 kB\""), "16 kB");
  EXPECT_EQ(setting_value("no.key", "\"16 KiB\""), "16 KiB");
  EXPECT_EQ(setting_value("cache.size", "nothing"), "nothing");
  EXPECT_EQ(setting_value("cache.size", "{\"a\": 1}"), "{\"a\": 1}");
  EXPECT_EQ(setting_toml("cache.size", "16 kB"), "\"16 kB\"");
  EXPECT_EQ(setting_toml("cache.size", 1.5), "1.5");
  EXPECT_EQ(setting_toml("cache.size", -1), "-1");
  EXPECT_EQ(setting_toml("node.clock", std::numeric_limits<double>::infinity()), "null");
  EXPECT_EQ(setting_toml("cache.size", 18446744073709551615U), "18446744073709551615");
  EXPECT_EQ(setting_toml("no.key", "\"</b>"), "\"\\\"</b>\"");
  EXPECT_EQ(setting_toml("no.key", {{"a", 1}}), "{\"a\":1}");
  EXPECT_EQ(plain_setting("\"16 KiB\""), "16 KiB");
  EXPECT_EQ(plain_setting("\"\""), "\"\"");
  EXPECT_EQ(plain_setting("true"), "true");
}

TEST(SettingValue, SettingsOfAResultAreReadWithCare) {
  const std::vector<sim::EffectiveValue> values = {{"cache.size", "\"16 KiB\"", true, ""},
                                                   {"scene.source", "\"teapot:4\"", false, ""}};
  const Json config = config_json("marti.toml", values);
  EXPECT_EQ(config.dump(), R"({"file":"marti.toml","keys":{"cache.size":{"value":16384,"given":true},)"
                           R"("scene.source":{"value":"teapot:4","given":false}}})");
  for (const auto& [key, text] : settings_of(RunJson({{"config", config}}, "f"))) {
    EXPECT_EQ(text, key == values[0].key ? values[0].value : values[1].value);
  }
  for (const char* wrong : {R"({"a.b": 3})", R"({"a.b": {}})", R"({"a.b": {"value": null}})",
                            R"({"a.b": {"value": {"c": 1}}})"}) {
    const RunJson run({{"config", {{"keys", Json::parse(wrong)}}}}, "f");
    const std::string message = test::user_error_of([&] { (void)settings_of(run); });
    EXPECT_TRUE(message.starts_with("f: config.keys.a.b has no \"value\"")) << message;
  }
}

}  // namespace
}  // namespace marti::studies
