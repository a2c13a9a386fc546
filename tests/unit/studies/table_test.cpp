#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/error.h"
#include "studies/tables/csv.h"
#include "studies/tables/json_table.h"
#include "studies/tables/table.h"
#include "studies/tables/text_table.h"
#include "studies/tables/wide_table.h"

namespace marti::tests {
namespace {

using studies::tables::Cell;
using studies::tables::ColumnType;
using studies::tables::Table;

TEST(Table, RefusesWhatDoesNotFit) {
  EXPECT_THROW(Table("t", "", {}), sim::InternalError);
  EXPECT_THROW(Table("T", "", {{"a", ColumnType::text, "", ""}}), sim::InternalError);
  EXPECT_THROW(Table("t", "", {{"a\"b", ColumnType::text, "", ""}}), sim::InternalError);
  EXPECT_THROW(Table("t", "", {{"a", ColumnType::text, "", ""}, {"a", ColumnType::real, "", ""}}),
               sim::InternalError);
  Table table("t", "", {{"a", ColumnType::integer, "1", ""}, {"b", ColumnType::text, "", ""}});
  EXPECT_THROW(table.add_row({std::int64_t{1}}), sim::InternalError);
  EXPECT_THROW(table.add_row({1.0, "x"}), sim::InternalError);
  EXPECT_THROW(table.add_row({"x", std::int64_t{1}}), sim::InternalError);
  table.add_row({Cell(), Cell()});
  EXPECT_EQ(table.rows().size(), 1U);
  EXPECT_THROW(static_cast<void>(table.column("c")), sim::InternalError);
  EXPECT_THROW(static_cast<void>(table.at(1, "a")), sim::InternalError);
  EXPECT_THROW(static_cast<void>(Cell(std::numeric_limits<std::uint64_t>::max())), sim::InternalError);
}

TEST(Table, ColumnsAreDescribed) {
  const std::vector<Table> tables = {
      Table("one", "", {{"a", ColumnType::integer, "ps", "a time"}, {"b", ColumnType::text, "", "a name"}}),
      Table("two", "", {{"a", ColumnType::real, "byte", "a size"}})};
  const Table described = studies::tables::describe_columns(tables);
  ASSERT_EQ(described.rows().size(), 3U);
  EXPECT_EQ(std::get<std::string>(described.at(2, "table_name")), "two");
  EXPECT_EQ(std::get<std::string>(described.at(0, "unit")), "ps");
  EXPECT_EQ(std::get<std::string>(described.at(1, "description")), "a name");
}

TEST(Table, ColumnsAreAddedBehindTheOthers) {
  Table table("t", "", {{"a", ColumnType::integer, "1", ""}});
  table.add_row({std::int64_t{1}});
  table.add_row({std::int64_t{2}});
  const auto twice = [](std::span<const Cell> row) {
    return std::vector<Cell>{2 * std::get<std::int64_t>(row[0]), "x"};
  };
  const std::array<studies::tables::Column, 2> more = {
      {{"b", ColumnType::integer, "1", ""}, {"c", ColumnType::text, "", ""}}};
  table.add_columns(more, twice);
  ASSERT_EQ(table.rows().size(), 2U);
  EXPECT_EQ(std::get<std::int64_t>(table.at(1, "a")), 2);
  EXPECT_EQ(std::get<std::int64_t>(table.at(1, "b")), 4);
  EXPECT_EQ(std::get<std::string>(table.at(0, "c")), "x");
  EXPECT_THROW(table.add_columns(more, twice), sim::InternalError) << "names are there already";
}

TEST(Table, TextIsAlignedAndInUnitsForPeople) {
  Table table("t", "A title",
              {{"name", ColumnType::text, "", ""},
               {"count", ColumnType::integer, "1", ""},
               {"time", ColumnType::integer, "ps", ""},
               {"size", ColumnType::integer, "byte", ""},
               {"share", ColumnType::real, "fraction", ""}});
  table.add_row({"a", std::int64_t{-1234567}, std::int64_t{1'500'000'000'000}, std::int64_t{1536}, 0.125});
  table.add_row({"two\nlines", std::int64_t{999}, Cell(), std::int64_t{0}, 1.0});
  EXPECT_EQ(studies::tables::text_of(table),
            "A title\n"
            "  name               count   time  size   share\n"
            "                                s   KiB       %\n"
            "  a             -1,234,567  1.500   1.5   12.50\n"
            "  two\\x0alines         999      -   0.0  100.00\n");
}

// A column of a key has the key's name; a boolean is one in JSON, and a word in texts.
TEST(Table, KeysAndBooleansStayWhatTheyAre) {
  Table table("t", "title",
              {{"machine.nodes", ColumnType::integer, "1", ""}, {"l2.on", ColumnType::boolean, "", ""}});
  EXPECT_THROW(Table("t.u", "", {{"a", ColumnType::text, "", ""}}), sim::InternalError);
  EXPECT_THROW(table.add_row({std::int64_t{1}, std::int64_t{2}}), sim::InternalError);
  EXPECT_THROW(table.add_row({std::int64_t{1}, "true"}), sim::InternalError);
  table.add_row({std::int64_t{1}, std::int64_t{1}});
  table.add_row({std::int64_t{0}, std::int64_t{0}});
  table.add_row({std::int64_t{2}, {}});
  EXPECT_EQ(
      studies::tables::rows_json(table).dump(),
      R"([{"machine.nodes":1,"l2.on":true},{"machine.nodes":0,"l2.on":false},{"machine.nodes":2,"l2.on":null}])");
  EXPECT_EQ(studies::tables::csv_of(table), "machine.nodes,l2.on\r\n1,true\r\n0,false\r\n2,\r\n");
  EXPECT_NE(studies::tables::text_of(table).find("1   true\n"), std::string::npos)
      << studies::tables::text_of(table);
}

TEST(Table, WideningKeepsEveryCell) {
  Table table("t", "",
              {{"run", ColumnType::text, "", ""},
               {"level", ColumnType::integer, "1", ""},
               {"value", ColumnType::real, "", ""}});
  table.add_row({"a", std::int64_t{1}, 0.1});
  table.add_row({"a", std::int64_t{2}, 0.2});
  table.add_row({"b", std::int64_t{2}, 0.3});
  const Table wide =
      studies::tables::widen(table, std::array{std::string_view("run")}, "level", "l", "value");
  ASSERT_EQ(wide.rows().size(), 2U);
  ASSERT_EQ(wide.columns().size(), 3U);
  EXPECT_EQ(std::get<double>(wide.at(0, "l1")), 0.1);
  EXPECT_EQ(std::get<double>(wide.at(0, "l2")), 0.2);
  EXPECT_TRUE(std::holds_alternative<std::monostate>(wide.at(1, "l1")));
  EXPECT_EQ(std::get<double>(wide.at(1, "l2")), 0.3);
}

}  // namespace
}  // namespace marti::tests
