#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "studies/tables/chart.h"

namespace marti::tests {
namespace {

using studies::tables::Cell;
using studies::tables::ChartSpecification;
using studies::tables::ColumnType;
using studies::tables::Table;

TEST(Chart, EverySpecificationIsAVegaLiteChartOfATable) {
  std::string before;
  for (const ChartSpecification& chart : studies::tables::chart_specifications()) {
    EXPECT_LT(before, chart.name);
    before = chart.name;
    const nlohmann::json specification = nlohmann::json::parse(chart.json);
    EXPECT_EQ(specification["$schema"], "https://vega.github.io/schema/vega-lite/v6.json") << chart.name;
    EXPECT_TRUE(specification.contains("title")) << chart.name;
    EXPECT_FALSE(studies::tables::table_of(chart).empty());
  }
  EXPECT_GE(studies::tables::chart_specifications().size(), 4U);
}

TEST(Chart, RowsAreInlinedAndTheRestIsKept) {
  const ChartSpecification chart{
      "c", R"({"title": "x", "data": {"name": "t"}, "mark": "bar", "encoding": {"x": {"field": "a"}}})"};
  Table table("t", "",
              {{"a", ColumnType::integer, "1", ""},
               {"b", ColumnType::real, "", ""},
               {"c", ColumnType::text, "", ""}});
  table.add_row({std::numeric_limits<std::int64_t>::max(), 0.1, "</script>\"\n"});
  table.add_row({Cell(), std::numeric_limits<double>::infinity(), "\xff"});
  const nlohmann::json filled = nlohmann::json::parse(studies::tables::fill_chart(chart, table));
  EXPECT_EQ(filled["mark"], "bar");
  EXPECT_EQ(filled["data"]["name"], "t");
  ASSERT_EQ(filled["data"]["values"].size(), 2U);
  EXPECT_EQ(filled["data"]["values"][0]["a"].get<std::int64_t>(), std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(filled["data"]["values"][0]["b"].get<double>(), 0.1);
  EXPECT_EQ(filled["data"]["values"][0]["c"], "</script>\"\n");
  EXPECT_TRUE(filled["data"]["values"][1]["a"].is_null());
  EXPECT_TRUE(filled["data"]["values"][1]["b"].is_null());
}

Table table_with_lines(std::size_t lines) {
  Table table("t", "", {{"line", ColumnType::text, "", ""}, {"x", ColumnType::integer, "1", ""}});
  for (std::int64_t x = 0; x < 3; ++x) {
    for (std::size_t line = 0; line < lines; ++line) {
      table.add_row({"line " + std::to_string(line), x});
    }
  }
  return table;
}

TEST(Chart, MoreThanFourLinesAreSharedOutAmongPanels) {
  const ChartSpecification chart{"c", R"({"title": "x", "data": {"name": "t"}, "usermeta": {"lines": "line"},
      "width": 300, "layer": [{"mark": "line", "encoding": {"color": {"field": "line"}}}]})"};
  const nlohmann::json four = nlohmann::json::parse(studies::tables::fill_chart(chart, table_with_lines(4)));
  EXPECT_FALSE(four.contains("facet"));
  EXPECT_EQ(four["width"], 300);
  const nlohmann::json nine = nlohmann::json::parse(studies::tables::fill_chart(chart, table_with_lines(9)));
  EXPECT_EQ(nine["facet"]["field"], "panel");
  EXPECT_FALSE(nine.contains("layer"));
  EXPECT_EQ(nine["spec"]["width"], 300);
  EXPECT_EQ(nine["spec"]["layer"], four["layer"]);
  std::map<int, std::set<std::string>> lines;
  for (const nlohmann::json& row : nine["data"]["values"]) {
    lines[row["panel"].get<int>()].insert(row["line"].get<std::string>());
  }
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_EQ(lines[0], (std::set<std::string>{"line 0", "line 1", "line 2", "line 3"}));
  EXPECT_EQ(lines[2], (std::set<std::string>{"line 8"}));
}

// A line for each value of a field that a table may have any number of is shared out, too.
TEST(Chart, ChartsOfManyLinesSayWhatTheirLinesAre) {
  std::set<std::string> shared_out;
  for (const ChartSpecification& chart : studies::tables::chart_specifications()) {
    const nlohmann::json specification = nlohmann::json::parse(chart.json);
    if (specification.contains("usermeta")) {
      shared_out.insert(std::string(chart.name));
      EXPECT_NE(chart.json.find(R"("color": {"field": ")" +
                                specification["usermeta"]["lines"].get<std::string>() + '"'),
                std::string_view::npos)
          << chart.name;
    }
  }
  EXPECT_EQ(shared_out, (std::set<std::string>{"figure3", "memory_latency"}));
}

}  // namespace
}  // namespace marti::tests
