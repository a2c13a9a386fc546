// CSV, read back.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "studies/tables/csv.h"
#include "tests/support/csv_records.h"

namespace marti::tests {
namespace {

using studies::tables::Cell;
using studies::tables::ColumnType;
using studies::tables::Table;
using test::CsvRecord;
using test::read_csv;

Table make_table() {
  return {"t",
          "title",
          {{"i", ColumnType::integer, "1", ""},
           {"r", ColumnType::real, "", ""},
           {"s", ColumnType::text, "", ""}}};
}

TEST(Csv, ACellWithoutValueDiffersFromAnEmptyText) {
  Table table = make_table();
  table.add_row({Cell(), Cell(), Cell()});
  table.add_row({Cell(), Cell(), std::string()});
  EXPECT_EQ(studies::tables::csv_of(table), "i,r,s\r\n,,\r\n,,\"\"\r\n");
}

TEST(Csv, NumbersComeBackExactly) {
  const std::vector<double> reals = {0.0,
                                     -0.0,
                                     0.1,
                                     1.0 / 3.0,
                                     1e300,
                                     std::numeric_limits<double>::denorm_min(),
                                     std::numeric_limits<double>::max(),
                                     std::numeric_limits<double>::infinity(),
                                     -std::numeric_limits<double>::infinity()};
  Table table = make_table();
  for (const double real : reals) {
    table.add_row({std::numeric_limits<std::int64_t>::min(), real, "x"});
  }
  table.add_row({std::numeric_limits<std::int64_t>::max(), std::numeric_limits<double>::quiet_NaN(), "x"});
  const auto records = read_csv(studies::tables::csv_of(table));
  ASSERT_TRUE(records.has_value());
  for (std::size_t i = 0; i < reals.size(); ++i) {
    EXPECT_EQ(std::stoll((*records)[i + 1][0]), std::numeric_limits<std::int64_t>::min());
    const double back = std::strtod((*records)[i + 1][1].c_str(), nullptr);
    EXPECT_EQ(back, reals[i]);
    EXPECT_EQ(std::signbit(back), std::signbit(reals[i]));
  }
  EXPECT_EQ(records->back()[0], "9223372036854775807");
  EXPECT_EQ(records->back()[1], "nan");
}

RC_GTEST_PROP(Csv, AnyTextComesBack, ()) {
  const auto hostile = rc::gen::element<std::string>(
      "", "plain", "with, comma", "with \"quotes\"", "\"", "line\nbreak", "line\r\nbreak", "\r", " edge ",
      "gr\xc3\xbc\xc3\x9f", std::string("a\0b", 3), "\xff\xfe");
  const auto texts = *rc::gen::container<std::vector<std::string>>(
      rc::gen::oneOf(hostile, rc::gen::arbitrary<std::string>()));
  Table table("t", "", {{"a", ColumnType::text, "", ""}, {"b", ColumnType::text, "", ""}});
  std::vector<CsvRecord> expected = {{"a", "b"}};
  for (const std::string& text : texts) {
    table.add_row({text, text + text});
    expected.push_back({text, text + text});
  }
  RC_ASSERT(read_csv(studies::tables::csv_of(table)) == expected);
}

}  // namespace
}  // namespace marti::tests
