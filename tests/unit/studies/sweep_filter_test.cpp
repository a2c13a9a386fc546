// The filter of a sweep against C++.
#include "studies/sweep/plan/sweep_filter.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "studies/sweep/plan/sweep_keys.h"
#include "tests/support/user_error.h"
#include "tests/unit/studies/sweep_tables.h"

namespace marti::studies {

using namespace sweep;

namespace {

using test::user_error_of;

const sim::Schema& schema() {
  static const sim::Schema made = sweep_schema();
  return made;
}

// Evaluates a filter whose columns are looked up by name.
bool passes(std::string_view text, const std::vector<std::pair<std::string, sim::Value>>& row) {
  SweepFilter filter(schema(), text, true, sim::Place{"here"});
  std::vector<sim::Value> values;
  for (const std::size_t column : filter.columns()) {
    const std::string name = column == FilterText::point ? "point" : schema().names()[column];
    for (const auto& [key, value] : row) {
      if (key == name) {
        values.push_back(value);
      }
    }
  }
  return filter.passes(values);
}

std::string error_of(std::string_view text, bool points = true) {
  return user_error_of([&] { SweepFilter(schema(), text, points, sim::Place{"here"}); });
}

RC_GTEST_PROP(SweepFilter, DecidesAsTheSameExpressionInCpp, ()) {
  const auto nodes = *rc::gen::inRange<std::int64_t>(1, 300);
  const auto size = *rc::gen::inRange<std::int64_t>(1, 200'000);
  const auto ways = *rc::gen::inRange<std::int64_t>(0, 9);
  const auto clock = *rc::gen::element(20e6, 33e6, 50e6);
  const auto line = *rc::gen::element<std::int64_t>(16, 32, 64);
  const auto replacement = *rc::gen::element<std::string>("lru", "fifo", "random");
  const auto point = *rc::gen::element<std::string>("small", "it's");
  const auto shadows = *rc::gen::arbitrary<bool>();
  const auto from = *rc::gen::inRange<std::int64_t>(0, 20'000);
  const std::vector<std::pair<std::string, sim::Value>> row = {
      {"machine.nodes", nodes}, {"cache.size", size},       {"cache.ways", ways},
      {"node.clock", clock},    {"cache.line", line},       {"cache.replacement", replacement},
      {"point", point},         {"image.shadows", shadows}, {"record.timeline_from", from}};
  const auto check = [&](std::string_view text, bool expected) { RC_ASSERT(passes(text, row) == expected); };
  check("machine.nodes * cache.size <= 1 MiB and cache.ways <= 8", nodes * size <= 1 << 20 && ways <= 8);
  check("cache.size<64KiB", size < 65536);
  check("cache.size >= 1.5 KiB or not cache.ways", size >= 1536 || ways == 0);
  check("node.clock = 33 MHz", clock == 33e6);
  check("node.clock/1 MHz > 32.5", clock / 1e6 > 32.5);
  check("record.timeline_from <= 10 ns AND image.shadows", from <= 10'000 && shadows);
  check("cache.replacement = 'lru'", replacement == "lru");
  check("cache.replacement in ('lru', 'fifo') and point <> 'it''s'",
        replacement != "random" && point == "small");
  check("point = 'it''s'", point == "it's");
  check("cache.size between 100 and 1e4", size >= 100 && size <= 10'000);
  check("cache.size % cache.line = 0", size % line == 0);
  check("machine.nodes > (cache.ways + 1) * 16 or machine.nodes = 1", nodes > (ways + 1) * 16 || nodes == 1);
  check("case when cache.ways = 0 then cache.size > 64 B else machine.nodes < 100 end",
        ways == 0 ? size > 64 : nodes < 100);
  check("max(machine.nodes, cache.ways) = machine.nodes", std::max(nodes, ways) == nodes);
  check("iif(image.shadows, machine.nodes, cache.ways) > 5 is true", (shadows ? nodes : ways) > 5);
  check("cache.replacement like 'r%'", replacement == "random");
  check("cache.ways / 0 = 1", false);  // null is not true
  check("- machine.nodes < -100", -nodes < -100);
  check("machine.nodes & (machine.nodes - 1) = 0 and machine.nodes > 0", (nodes & (nodes - 1)) == 0);
}

TEST(SweepFilter, RefusesWhatIsNoExpressionOverKeys) {
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"", "here: names no key"},
      {"1 = 1", "here: names no key"},
      {"cache.sise > 3", "here: unknown name \"cache.sise\" (did you mean \"cache.size\"?)"},
      {"cache.replacement = lru", "here: unknown name \"lru\"; texts are written in single quotation marks"},
      {"cache > 3", "here: \"cache\" is a section, not a key"},
      {"cache.size > '64 KiB'", "here: '64 KiB' is a text, which no size, frequency or duration equals"},
      {"cache.size > '64KiB'", "here: '64KiB' is a text"},
      {"node.clock > '33 MHz'", "here: '33 MHz' is a text"},
      {"cache.size > 64 KB", "here: \"64 KB\": unknown unit"},
      {"cache.size > 0.3 B", "here: "},
      {"cache.size > \"x\"", "here: write texts in single quotation marks"},
      {"cache.size > 3; drop table x", "here: the character ';' means nothing here"},
      {"cache.size > 3) or (1", "here: a parenthesis is closed that was not opened"},
      {"(cache.size > 3", "here: a parenthesis is not closed"},
      {"cache.size > 3 -- x", "here: a filter has no comments"},
      {"cache.size > /* x */ 3", "here: a filter has no comments"},
      {"cache.size in (select 3)", "here: unknown name \"select\""},
      {"cache.size > random()", "here: unknown name \"random\""},
      {"load_extension('x') = cache.size", "here: unknown name \"load_extension\""},
      {"cache.size > abs", "here: \"abs\" is a function"},
      {"cache.size > ?1", "here: the character '?' means nothing here"},
      {"cache.size >", "here: is no whole expression (SQLite: near \")\": syntax error)"},
      {"cache.size, cache.ways", "here: is no whole expression (SQLite: row value misused)"},
      {"cache.replacement = 'lru", "here: a text in single quotation marks has no end"},
      {"cache.size cache.ways", "here: is no whole expression (SQLite: near "},
      // SQLite would compare these, and choose other points than intended.
      {"machine.nodes < '2'", "here: machine.nodes is no text and cannot be compared with '2'"},
      {"not (machine.nodes <> '4')", "here: machine.nodes is no text"},
      {"cache.size > 'x' or machine.nodes > 0", "here: cache.size is no text"},
      {"cache.replacement <> 'lruu'",
       "here: cache.replacement is never 'lruu' (did you mean \"lru\"?); it is lru, fifo, random, plru or "
       "srrip"},
      {"interconnect.kind in ('bus', 'crosbar')", "here: interconnect.kind is never 'crosbar'"},
      {"cache.replacement > 3", "here: cache.replacement is a text and cannot be compared with 3"},
      {"cache.size < 4 MHz", "here: cache.size is a size and cannot be compared with 4 MHz"},
      {"cache.size between 1 KiB and 4 ns", "here: cache.size is a size and cannot be compared with 4 ns"},
      {"substr(cache.replacement, 1, 1) = 'l' and machine.nodes * cache.size <= 4 MiB", "no UserError"},
      {"cache.replacement like 'l%' and cache.size / 3 > 2", "no UserError"},
      {"case when machine.nodes > 1 then 'a' else 'b' end = 'a'", "no UserError"},
      {"interconnect.kind = 'bus' and cache.size between 1 KiB and 4 KiB and machine.nodes < 3",
       "no UserError"},
      {"max(cache.size, abs(-9223372036854775808)) = 1", "no UserError"},
  };
  test::expect_messages(wrong, [](const std::string& text) { return error_of(text); });
  EXPECT_EQ(error_of("point = 'a'", false), "here: there are no named points, so `point` has no value");
  EXPECT_EQ(error_of("cache.size > " + std::string(20'000, '1')), "here: has more than 10000 characters");
  EXPECT_NE(error_of("cache.size > " + std::string(3000, '(') + "1" + std::string(3000, ')')),
            "no UserError");
  EXPECT_EQ(user_error_of([] {
              passes("abs(cache.size - 9223372036854775807 - 2) > 1", {{"cache.size", std::int64_t{1}}});
            }),
            "here: cannot be computed (SQLite: integer overflow)");
}

// Any text is an expression or an error.
RC_GTEST_PROP(SweepFilter, SurvivesAnyText, ()) {
  const auto parts = *rc::gen::container<std::vector<std::string>>(rc::gen::element<std::string>(
      "cache.size", "point", "'a'", "'", "(", ")", "1", "64 KiB", " ", "and", "not", "<=", "=", "-", "max(",
      ",", "is", "null", ".", "e", "1e5", "%", "''", "in", "between", "\x01", "case", "end", "like", "||"));
  std::string text;
  for (const std::string& part : parts) {
    text += part + " ";
  }
  try {
    SweepFilter filter(schema(), text, true, sim::Place{"here"});
    std::vector<sim::Value> values;
    for (const std::size_t column : filter.columns()) {
      values.push_back(column == FilterText::point ? sim::Value(std::string("a"))
                                                   : sim::Value(std::int64_t{64}));
    }
    const bool first = filter.passes(values);
    RC_ASSERT(filter.passes(values) == first);
  } catch (const sim::UserError& error) {
    RC_ASSERT(std::string(error.what()).starts_with("here: "));
  }
}

}  // namespace
}  // namespace marti::studies
