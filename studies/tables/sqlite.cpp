#include "studies/tables/sqlite.h"

#include <string>

#include "studies/tables/sqlite_connection.h"

namespace marti::studies::tables {

void write_database(const std::filesystem::path& file, std::span<const Table> tables) {
  SqliteConnection connection(file, SqliteConnection::Access::write_alone);
  connection.execute("PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF");
  connection.transact([&] {
    for (const Table& table : tables) {
      std::string columns;
      for (const Column& column : table.columns()) {
        columns +=
            (columns.empty() ? "" : ", ") + sql_name(column.name) + " " + std::string(sql_type(column.type));
      }
      connection.execute("CREATE TABLE " + sql_name(table.name()) + " (" + columns + ")");
      SqliteStatement insert(connection, insert_sql(sql_name(table.name()), table.columns().size()));
      for (const std::vector<Cell>& row : table.rows()) {
        insert.run(row);
      }
    }
  });
}

}  // namespace marti::studies::tables
