#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "studies/tables/chart.h"

namespace marti::tests {
namespace {

using studies::Cell;
using studies::ChartSpecification;
using studies::ColumnType;
using studies::Table;

TEST(Chart, EverySpecificationIsAVegaLiteChartOfATable) {
  std::string before;
  for (const ChartSpecification& chart : studies::chart_specifications()) {
    EXPECT_LT(before, chart.name);
    before = chart.name;
    const nlohmann::json specification = nlohmann::json::parse(chart.json);
    EXPECT_EQ(specification["$schema"], "https://vega.github.io/schema/vega-lite/v6.json") << chart.name;
    EXPECT_TRUE(specification.contains("title")) << chart.name;
    EXPECT_FALSE(table_of(chart).empty());
  }
  EXPECT_GE(studies::chart_specifications().size(), 4U);
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
  const nlohmann::json filled = nlohmann::json::parse(fill_chart(chart, table));
  EXPECT_EQ(filled["mark"], "bar");
  EXPECT_EQ(filled["data"]["name"], "t");
  ASSERT_EQ(filled["data"]["values"].size(), 2U);
  EXPECT_EQ(filled["data"]["values"][0]["a"].get<std::int64_t>(), std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(filled["data"]["values"][0]["b"].get<double>(), 0.1);
  EXPECT_EQ(filled["data"]["values"][0]["c"], "</script>\"\n");
  EXPECT_TRUE(filled["data"]["values"][1]["a"].is_null());
  EXPECT_TRUE(filled["data"]["values"][1]["b"].is_null());
}

}  // namespace
}  // namespace marti::tests
