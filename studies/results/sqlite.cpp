#include "studies/results/sqlite.h"

#include <sqlite3.h>

#include <memory>
#include <new>

#include "sim/error.h"

namespace marti::studies {

namespace {

std::string quoted(const std::string& name) { return "\"" + name + "\""; }

std::string_view sql_type(ColumnType type) {
  switch (type) {
    case ColumnType::integer:
      return "INTEGER";
    case ColumnType::real:
      return "REAL";
    case ColumnType::text:
      return "TEXT";
  }
  throw sim::InternalError("a column of an unknown type");
}

struct Finalize {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Statement = std::unique_ptr<sqlite3_stmt, Finalize>;

/// The text must live until the statement has run.
int bind(sqlite3_stmt* statement, int index, const Cell& cell) {
  if (const auto* integer = std::get_if<std::int64_t>(&cell)) {
    return sqlite3_bind_int64(statement, index, *integer);
  }
  if (const auto* real = std::get_if<double>(&cell)) {
    return sqlite3_bind_double(statement, index, *real);
  }
  if (const auto* text = std::get_if<std::string>(&cell)) {
    return sqlite3_bind_text64(statement, index, text->data(), text->size(), nullptr, SQLITE_UTF8);
  }
  return sqlite3_bind_null(statement, index);
}

}  // namespace

Database::Database(const std::filesystem::path& file) : name_(file.string()) {
  const int status = sqlite3_open_v2(
      file.c_str(), &connection_, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX, nullptr);
  try {
    check(status);
    // No journal: the file has a temporary name until it is complete, and is thrown away otherwise.
    execute("PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF;");
  } catch (...) {
    sqlite3_close_v2(connection_);
    throw;
  }
}

Database::~Database() { sqlite3_close_v2(connection_); }

void Database::check(int status) const {
  if (status == SQLITE_OK || status == SQLITE_DONE) {
    return;
  }
  if (status == SQLITE_NOMEM || connection_ == nullptr) {
    throw std::bad_alloc();
  }
  throw sim::UserError(name_ + ": the database cannot be written: " + sqlite3_errmsg(connection_));
}

void Database::execute(const std::string& sql) {
  check(sqlite3_exec(connection_, sql.c_str(), nullptr, nullptr, nullptr));
}

void Database::add(const Table& table) {
  std::string columns;
  std::string places;
  for (const Column& column : table.columns()) {
    columns += (columns.empty() ? "" : ", ") + quoted(column.name) + " " + std::string(sql_type(column.type));
    places += places.empty() ? "?" : ", ?";
  }
  execute("CREATE TABLE " + quoted(table.name()) + " (" + columns + ")");
  sqlite3_stmt* prepared = nullptr;
  const std::string insert = "INSERT INTO " + quoted(table.name()) + " VALUES (" + places + ")";
  check(sqlite3_prepare_v2(connection_, insert.c_str(), -1, &prepared, nullptr));
  const Statement statement(prepared);
  for (const std::vector<Cell>& row : table.rows()) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      check(bind(prepared, static_cast<int>(i) + 1, row[i]));
    }
    check(sqlite3_step(prepared));
    check(sqlite3_reset(prepared));
  }
}

void Database::close() {
  check(sqlite3_close(connection_));
  connection_ = nullptr;
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
