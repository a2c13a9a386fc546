// The database, read back through the library itself.
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "sim/error.h"
#include "studies/tables/sqlite.h"
#include "tests/support/files.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/user_error.h"

namespace marti::tests {
namespace {

using studies::tables::Cell;
using studies::tables::ColumnType;
using studies::tables::Table;
using test::TemporaryDirectory;

Cell cell_of(sqlite3_stmt* statement, int column) {
  switch (sqlite3_column_type(statement, column)) {
    case SQLITE_INTEGER:
      return std::int64_t{sqlite3_column_int64(statement, column)};
    case SQLITE_FLOAT:
      return sqlite3_column_double(statement, column);
    case SQLITE_TEXT:
      return std::string(reinterpret_cast<const char*>(sqlite3_column_text(statement, column)),
                         static_cast<std::size_t>(sqlite3_column_bytes(statement, column)));
    default:
      return {};
  }
}

std::vector<std::vector<Cell>> read(const std::filesystem::path& file, const std::string& query) {
  sqlite3* connection = nullptr;
  sqlite3_stmt* statement = nullptr;
  EXPECT_EQ(sqlite3_open_v2(file.c_str(), &connection, SQLITE_OPEN_READONLY, nullptr), SQLITE_OK);
  EXPECT_EQ(sqlite3_prepare_v2(connection, query.c_str(), -1, &statement, nullptr), SQLITE_OK)
      << sqlite3_errmsg(connection);
  std::vector<std::vector<Cell>> rows;
  while (sqlite3_step(statement) == SQLITE_ROW) {
    std::vector<Cell>& row = rows.emplace_back();
    for (int i = 0; i < sqlite3_column_count(statement); ++i) {
      row.push_back(cell_of(statement, i));
    }
  }
  sqlite3_finalize(statement);
  sqlite3_close(connection);
  return rows;
}

std::vector<Table> hostile_tables() {
  std::vector<Table> tables;
  // Names that are words of SQL.
  Table& table =
      tables.emplace_back("table", "",
                          std::vector<studies::tables::Column>{{"select", ColumnType::integer, "1", ""},
                                                               {"order", ColumnType::real, "", ""},
                                                               {"where", ColumnType::text, "", ""}});
  table.add_row({std::numeric_limits<std::int64_t>::min(), -0.1, "'; DROP TABLE x; --"});
  table.add_row({std::numeric_limits<std::int64_t>::max(), std::numeric_limits<double>::infinity(),
                 std::string("a\0\"b\n", 5)});
  table.add_row({Cell(), Cell(), Cell()});
  table.add_row({std::int64_t{0}, 1.0, ""});
  tables.emplace_back("empty", "", std::vector<studies::tables::Column>{{"a", ColumnType::text, "", ""}});
  return tables;
}

TEST(Sqlite, HostileCellsComeBack) {
  const TemporaryDirectory directory;
  const std::filesystem::path file = directory.path() / "results.sqlite";
  const std::vector<Table> tables = hostile_tables();
  studies::tables::write_database(file, tables);
  const auto rows = read(file, "SELECT * FROM \"table\" ORDER BY rowid");
  ASSERT_EQ(rows.size(), tables[0].rows().size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i], tables[0].rows()[i]) << i;
  }
  EXPECT_TRUE(read(file, "SELECT * FROM empty").empty());
  EXPECT_EQ(read(file, "PRAGMA integrity_check").at(0).at(0), Cell("ok"));
}

TEST(Sqlite, NotANumberBecomesNull) {
  const TemporaryDirectory directory;
  Table table("t", "", {{"r", ColumnType::real, "", ""}});
  table.add_row({std::numeric_limits<double>::quiet_NaN()});
  studies::tables::write_database(directory.path() / "a", std::vector{table});
  EXPECT_EQ(read(directory.path() / "a", "SELECT r IS NULL FROM t").at(0).at(0), Cell(std::int64_t{1}));
}

TEST(Sqlite, EqualTablesGiveEqualFiles) {
  const TemporaryDirectory directory;
  studies::tables::write_database(directory.path() / "a", hostile_tables());
  studies::tables::write_database(directory.path() / "b", hostile_tables());
  EXPECT_FALSE(test::read(directory.path() / "a").empty());
  EXPECT_EQ(test::read(directory.path() / "a"), test::read(directory.path() / "b"));
}

TEST(Sqlite, AFileThatCannotBeWrittenIsTheUsersMatter) {
  const TemporaryDirectory directory;
  EXPECT_THROW(studies::tables::write_database(directory.path() / "missing" / "a", hostile_tables()),
               sim::UserError);
  EXPECT_THROW(studies::tables::write_database(directory.path(), hostile_tables()), sim::UserError);
  const std::string full =
      test::user_error_of([] { studies::tables::write_database("/dev/full", hostile_tables()); });
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "/dev/full", full);
}

TEST(Sqlite, ATableTwiceIsRefused) {
  const TemporaryDirectory directory;
  std::vector<Table> tables = hostile_tables();
  tables.push_back(tables[0]);
  EXPECT_THROW(studies::tables::write_database(directory.path() / "a", tables), sim::UserError);
}

}  // namespace
}  // namespace marti::tests
