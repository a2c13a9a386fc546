// Free sections, and variants of a configuration.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "sim/config.h"
#include "tests/support/user_error.h"

namespace marti::sim {
namespace {

using test::user_error_of;

Schema free_schema() {
  Schema schema;
  schema.section("cache", "a cache");
  schema.size("cache.size", "16 KiB", {"1 B", "1 GiB"}, "its size");
  schema.integer("cache.ways", 4, {1, 64}, "lines", "of a set");
  schema.choice("cache.replacement", "lru", {"lru", "fifo"}, "which");
  schema.free_section("sweep", "anything");
  schema.text("sweep.filter", "", "declared all the same");
  return schema;
}

Config read_free(std::string_view text) { return Config::from_text(free_schema(), text, "a.toml"); }

std::string free_error_of(std::string_view text) {
  return user_error_of([&] { (void)read_free(text); });
}

TEST(FreeSection, KeepsWhatIsWrittenInItsOrderWithItsLines) {
  const Config config = read_free(
      "[sweep.axes]\n"
      "zebra = [1, 2.5, \"x\",\n true]\n"
      "\"cache.ways\" = 3\n"
      "cache.size = { to = 4, from = [] }\n"
      "[[sweep.zip]]\n"
      "a = 1\n"
      "[[sweep.zip]]\n"
      "b = 2\n"
      "[sweep]\n"
      "filter = \"yes\"\n");
  const DocumentValue::Table& sweep = config.free_section("sweep");
  ASSERT_EQ(sweep.size(), 2U);  // the declared key is not among them
  EXPECT_EQ(config.text("sweep.filter"), "yes");
  EXPECT_EQ(sweep[0].name, "axes");
  const DocumentValue::Table& axes = *sweep[0].value.table();
  ASSERT_EQ(axes.size(), 3U);
  EXPECT_EQ(axes[0].name, "zebra");
  EXPECT_EQ(axes[0].line, 2);
  const DocumentValue::List& list = *axes[0].value.list();
  ASSERT_EQ(list.size(), 4U);
  EXPECT_EQ(std::get<std::int64_t>(list[0].content), 1);
  EXPECT_EQ(std::get<double>(list[1].content), 2.5);
  EXPECT_EQ(*list[2].text(), "x");
  EXPECT_EQ(std::get<bool>(list[3].content), true);
  EXPECT_EQ(list[2].line, 2);
  EXPECT_EQ(list[3].line, 3);
  EXPECT_EQ(axes[1].name, "cache.ways");
  EXPECT_EQ(axes[2].name, "cache");
  const DocumentValue::Table& range = *axes[2].value.table()->front().value.table();
  EXPECT_EQ(range[0].name, "to");
  EXPECT_EQ(range[1].name, "from");
  EXPECT_EQ(find(range, "from"), &range[1]);
  EXPECT_EQ(find(range, "steps"), nullptr);
  ASSERT_EQ(sweep[1].value.list()->size(), 2U);
  EXPECT_EQ((*sweep[1].value.list())[1].line, 8);
}

TEST(FreeSection, IsEmptyWhereItIsNotGiven) {
  EXPECT_TRUE(read_free("").free_section("sweep").empty());
  EXPECT_EQ(read_free("").free_section_line("sweep"), 0);
  EXPECT_TRUE(read_free("[sweep]\n").free_section("sweep").empty());
  EXPECT_EQ(read_free("\n[sweep]\n").free_section_line("sweep"), 2);
}

TEST(FreeSection, RefusesWhatItCannotHold) {
  EXPECT_EQ(free_error_of("[sweep.axes]\na = nan\n"), "a.toml:2: sweep.axes.a: must not be the real nan");
  EXPECT_EQ(free_error_of("[sweep]\na = [1,\n 1979-05-27]\n"),
            "a.toml:3: sweep.a: must not be a date or time");
  EXPECT_EQ(free_error_of("[[sweep.zip]]\na = inf\n"), "a.toml:2: sweep.zip.a: must not be the real inf");
  EXPECT_EQ(free_error_of("sweep = 3\n"),
            "a.toml:1: sweep: is a section and has no value of its own; its keys are sweep.filter");
  EXPECT_EQ(free_error_of("[sweep]\nfilter = 3\n"),
            "a.toml:2: sweep.filter: must be a text in quotation marks, not the integer 3");
  EXPECT_NE(free_error_of("[swep]\na = 1\n").find("unknown"), std::string::npos);
  EXPECT_NE(free_error_of("[sweep]\na = " + std::string(2000, '[') + std::string(2000, ']')), "no UserError");
}

TEST(Variant, HasTheValuesOfItsSettingsAndNamesTheirLines) {
  const Config config = read_free("\ncache.size = \"8 KiB\"\n[sweep]\nways = 5\nsize = \"2 GiB\"\n");
  const std::size_t ways = *config.schema().find("cache.ways");
  const std::size_t size = *config.schema().find("cache.size");
  (void)config.size("cache.size");
  const DocumentValue& five = config.free_section("sweep")[0].value;
  const Setting setting{ways, config.parse(ways, five), five.line, {}};
  const Config variant = config.with({&setting, 1});
  EXPECT_EQ(variant.integer("cache.ways"), 5);
  EXPECT_EQ(variant.where("cache.ways"), "a.toml:4");
  EXPECT_EQ(user_error_of([&] { variant.fail("cache.ways", "is odd"); }), "a.toml:4: cache.ways: is odd");
  EXPECT_FALSE(variant.used_at(size));  // the copy starts anew
  EXPECT_TRUE(config.used_at(size));
  EXPECT_EQ(variant.size("cache.size"), 8192);
  EXPECT_EQ(config.integer("cache.ways"), 4);  // the original is as it was
  EXPECT_EQ(user_error_of([&] { (void)config.parse(size, config.free_section("sweep")[1].value); }),
            "a.toml:5: cache.size: must be 1 B to 1 GiB, not \"2 GiB\"");
  EXPECT_EQ(user_error_of([&] {
              (void)config.parse(size, {true, 7}, "label");
            }),
            "a.toml:7: label: must be a size such as \"16 KiB\", not a boolean");
  Config changed = variant;
  changed.reset(size);
  EXPECT_EQ(changed.size("cache.size"), 16384);
  EXPECT_FALSE(changed.given("cache.size"));
  changed.set({ways, {std::int64_t{2}}, 0, "elsewhere"});
  EXPECT_EQ(user_error_of([&] { changed.fail("cache.ways", "is even"); }),
            "a.toml: cache.ways: is even (in elsewhere)");
}

// A variant equals the configuration of a file with these values.
RC_GTEST_PROP(Variant, IsTheConfigurationOfTheSameValues, ()) {
  const auto size = *rc::gen::inRange<std::int64_t>(1, 1 << 30);
  const auto ways = *rc::gen::inRange<std::int64_t>(1, 65);
  const auto replacement = *rc::gen::element<std::string>("lru", "fifo");
  const Config base = read_free("cache.ways = 7\n");
  const std::vector<Setting> settings = {{*base.schema().find("cache.size"), {size}, 1, {}},
                                         {*base.schema().find("cache.ways"), {ways}, 1, {}},
                                         {*base.schema().find("cache.replacement"), {replacement}, 1, {}}};
  const Config variant = base.with(settings);
  const Config written =
      read_free("cache = { size = " + std::to_string(size) + ", ways = " + std::to_string(ways) +
                ", replacement = \"" + replacement + "\" }\n");
  for (const Config* config : {&variant, &written}) {
    for (const std::string& key : config->schema().names()) {
      (void)config->values(key);
    }
  }
  const std::vector<EffectiveValue> a = variant.effective_values();
  const std::vector<EffectiveValue> b = written.effective_values();
  RC_ASSERT(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    RC_ASSERT(a[i].key == b[i].key);
    RC_ASSERT(a[i].value == b[i].value);
    RC_ASSERT(a[i].given == b[i].given);
    RC_ASSERT(a[i].source == b[i].source);
  }
}

}  // namespace
}  // namespace marti::sim
