#include "studies/tables/sqlite.h"

#include <string>

#include "studies/tables/sqlite_connection.h"

namespace marti::studies {

namespace {

void add_table(SqliteConnection& database, const Table& table) {
  std::string columns;
  std::string places;
  for (const Column& column : table.columns()) {
    columns +=
        (columns.empty() ? "" : ", ") + sql_name(column.name) + " " + std::string(sql_type(column.type));
    places += places.empty() ? "?" : ", ?";
  }
  database.execute("CREATE TABLE " + sql_name(table.name()) + " (" + columns + ")");
  SqliteStatement insert(database, "INSERT INTO " + sql_name(table.name()) + " VALUES (" + places + ")");
  for (const std::vector<Cell>& row : table.rows()) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      insert.bind(static_cast<int>(i) + 1, row[i]);
    }
    insert.run();
  }
}

}  // namespace

void write_database(const std::filesystem::path& file, std::span<const Table> tables) {
  SqliteConnection database(file, SqliteConnection::Access::write_alone);
  // No journal: the file has a temporary name until it is complete, and is thrown away otherwise.
  database.execute("PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF; BEGIN");
  for (const Table& table : tables) {
    add_table(database, table);
  }
  database.execute("COMMIT");
  database.close();
}

}  // namespace marti::studies
