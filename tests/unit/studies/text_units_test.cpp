// Numbers as people read them.
#include "studies/tables/text_units.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

#include "sim/schema.h"
#include "studies/keys/setting_value.h"
#include "studies/show/key_list.h"
#include "studies/sweep/plan/sweep_keys.h"

#include <nlohmann/json.hpp>

namespace marti::studies {
namespace {

TEST(TextUnits, TimesHaveThreeDecimalsInTheLargestUnit) {
  EXPECT_EQ(seconds(0), "0 s");
  EXPECT_EQ(seconds(1), "1 ps");
  EXPECT_EQ(seconds(999), "999 ps");
  EXPECT_EQ(seconds(1000), "0.001 us");
  EXPECT_EQ(seconds(999'999'999), "1000.000 us");
  EXPECT_EQ(seconds(1'000'000'000), "1.000 ms");
  EXPECT_EQ(seconds(40'858'349'694), "40.858 ms");
  EXPECT_EQ(seconds(1'500'000'000'000), "1.500 s");
  EXPECT_EQ(signed_seconds(0), "0 s");
  EXPECT_EQ(signed_seconds(-331), "-331 ps");
  EXPECT_EQ(signed_seconds(28'202'000'000), "+28.202 ms");
}

TEST(TextUnits, SharesAndChangesArePercentages) {
  EXPECT_EQ(percent(0.249), "24.90 %");
  EXPECT_EQ(rough_percent(0.0993), "9.9 %");
  EXPECT_EQ(change_percent(0.6902), "+69.02 %");
  EXPECT_EQ(change_percent(-1.0), "-100.00 %");
  EXPECT_EQ(change_percent(0.0), "+0.00 %");
  EXPECT_EQ(change_percent(1e-6), "+1.0e-04 %");
  EXPECT_EQ(change_percent(8.99), "+899.00 %");
  EXPECT_EQ(change_percent(9.99999), "11.00 times");
  EXPECT_EQ(change_percent(39366.79), "39,368 times");
  EXPECT_EQ(times(1.0 / 3.0), "0.33");
}

TEST(TextUnits, FiguresHaveTheirUnit) {
  EXPECT_EQ(figure_text(std::int64_t{40'858'349'694}, "ps", "-"), "40.858 ms");
  EXPECT_EQ(figure_text(331.99, "ps", "-"), "332 ps");
  EXPECT_EQ(figure_text(-2e9, "ps", "-"), "-2.000 ms");
  EXPECT_EQ(figure_text(std::int64_t{16384}, "byte", "-"), "16.0 KiB");
  EXPECT_EQ(figure_text(std::int64_t{1234567}, "1", "-"), "1,234,567");
  EXPECT_EQ(figure_text(0.936275, "1", "-"), "0.9363");
  EXPECT_EQ(figure_text(std::int64_t{2'000'000}, "fJ", "-"), "2.000 nJ");
  EXPECT_EQ(figure_text(1.5, "mJ", "-"), "1.500 mJ");
  EXPECT_EQ(figure_text(2.5, "W", "-"), "2.5 W");
  EXPECT_EQ(figure_text(Cell(), "ps", "-"), "-");
  EXPECT_EQ(figure_text(std::string("text"), "ps", "-"), "text");
  EXPECT_EQ(figure_text(std::numeric_limits<double>::infinity(), "ps", "none"), "none");
  EXPECT_EQ(figure_text(std::numeric_limits<std::int64_t>::min(), "ps", "-"),
            "-9,223,372,036,854,775,808 ps");
}

// The defaults of all keys, printed as in a file and read back, are those of `marti config --json`.
TEST(SettingValue, IsWhatConfigJsonHas) {
  const sim::Schema schema = sweep_schema();
  const auto keys = nlohmann::ordered_json::parse(keys_as_json(schema, ""));
  std::size_t texts = 0;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const sim::Key& key = schema.keys()[i];
    ASSERT_EQ(keys[i]["name"], key.name);
    const std::string printed = sim::print_values(key, key.default_value);
    EXPECT_EQ(setting_value(schema, key.name, printed), keys[i]["default"]) << key.name << " = " << printed;
    texts += keys[i]["default"].is_string() ? 1 : 0;
  }
  EXPECT_GT(keys.size(), 2 * texts) << "most are numbers and booleans";
}

TEST(SettingValue, OtherTextsStayTexts) {
  const sim::Schema schema = sweep_schema();
  EXPECT_EQ(setting_value(schema, "cache.size", "\"16 kB\""), "16 kB");
  EXPECT_EQ(setting_value(schema, "no.key", "\"16 KiB\""), "16 KiB");
  EXPECT_EQ(setting_value(schema, "cache.size", "nothing"), "nothing");
  EXPECT_EQ(setting_value(schema, "cache.size", "{\"a\": 1}"), "{\"a\": 1}");
  EXPECT_EQ(plain_setting("\"16 KiB\""), "16 KiB");
  EXPECT_EQ(plain_setting("\"\""), "\"\"");
  EXPECT_EQ(plain_setting("true"), "true");
}

}  // namespace
}  // namespace marti::studies
