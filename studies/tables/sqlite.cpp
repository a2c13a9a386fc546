#include "studies/tables/sqlite.h"

namespace marti::studies {

Database::Database(const std::filesystem::path& file)
    : connection_(file, SqliteConnection::Access::write_alone) {
  // No journal: the file has a temporary name until it is complete, and is thrown away otherwise.
  connection_.execute("PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF;");
}

void Database::add(const Table& table) {
  std::string columns;
  std::string places;
  for (const Column& column : table.columns()) {
    columns +=
        (columns.empty() ? "" : ", ") + sql_name(column.name) + " " + std::string(sql_type(column.type));
    places += places.empty() ? "?" : ", ?";
  }
  execute("CREATE TABLE " + sql_name(table.name()) + " (" + columns + ")");
  SqliteStatement insert(connection_, "INSERT INTO " + sql_name(table.name()) + " VALUES (" + places + ")");
  for (const std::vector<Cell>& row : table.rows()) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      insert.bind(static_cast<int>(i) + 1, row[i]);
    }
    insert.run();
  }
}

void write_database(const std::filesystem::path& file, std::span<const Table> tables) {
  Database database(file);
  database.execute("BEGIN");
  for (const Table& table : tables) {
    database.add(table);
  }
  database.execute("COMMIT");
  database.close();
}

}  // namespace marti::studies
