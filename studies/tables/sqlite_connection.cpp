#include "studies/tables/sqlite_connection.h"

#include <sqlite3.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <new>

#include "sim/error.h"

namespace marti::studies::tables {

namespace {

// How long to wait for a lock: another process may just be writing or cleaning up.
constexpr int patience_ms = 5000;

// A file's name as a URI: https://www.sqlite.org/uri.html.
std::string uri_of(const std::filesystem::path& file) {
  std::string uri = "file:";
  for (const char c : file.string()) {
    uri += c == '%' ? "%25" : c == '?' ? "%3f" : c == '#' ? "%23" : std::string(1, c);
  }
  return uri + "?immutable=1";
}

// The file's own path, links resolved: a journal or log lies beside the file and not beside a link to it.
std::filesystem::path place_of(const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::path place = std::filesystem::canonical(file, error);
  return error ? std::filesystem::absolute(file) : place;
}

bool may_be_changed(const std::filesystem::path& place) {
  return access(place.c_str(), R_OK | W_OK) == 0 && access(place.parent_path().c_str(), W_OK | X_OK) == 0;
}

}  // namespace

SqliteConnection::SqliteConnection(const std::filesystem::path& file, Access access)
    : name_(file.string()), writes_(access != Access::read), in_memory_(access == Access::memory) {
  int flags = SQLite::OPEN_NOMUTEX | SQLite::OPEN_READWRITE;
  std::string place = access == Access::memory ? ":memory:" : name_;
  if (writes_) {
    flags |= SQLite::OPEN_CREATE;
  } else if (!may_be_changed(place_of(file))) {
    flags = SQLite::OPEN_NOMUTEX | SQLite::OPEN_READONLY;
    cannot_recover_ = has_log_or_journal(file);
    if (!cannot_recover_) {
      place = uri_of(place_of(file));
      flags |= SQLite::OPEN_URI;
    }
  }
  checked(
      [&] { opened_.emplace(place, flags, patience_ms, access == Access::write_alone ? "unix-none" : ""); });
}

void SqliteConnection::fail(const SQLite::Exception& error) const {
  const int kind = error.getErrorCode();
  if (kind == SQLITE_NOMEM) {
    throw std::bad_alloc();
  }
  std::string message = name_ +
                        (in_memory_ ? ": has a part of another form than a result's: "
                         : writes_  ? ": the database cannot be written: "
                                    : ": the database cannot be read: ") +
                        error.what();
  if (kind == SQLITE_IOERR || kind == SQLITE_CANTOPEN) {
    // A database that could not be opened has no connection to ask for the reason; then SQLite has not
    // changed errno since the system set it.
    const int reason = opened_ ? sqlite3_system_errno(opened_->getHandle()) : errno;
    message += reason == 0 ? "" : std::string(" (") + std::strerror(reason) + ")";
  }
  if (cannot_recover_ && (kind == SQLITE_READONLY || kind == SQLITE_CANTOPEN)) {
    message +=
        "; the program that wrote it was ended in the middle, and what it left beside the file can only be "
        "taken in where both may be written: run it again there, or copy the file together with its -journal "
        "or -wal into a directory that may be written";
  }
  if (kind == SQLITE_CORRUPT || kind == SQLITE_NOTADB) {
    message += "; the file is damaged or no database: take a copy that is whole, or remove it";
  }
  throw sim::UserError(message);
}

void SqliteConnection::execute(const std::string& sql) {
  checked([&] { opened_->exec(sql); });
}

SqliteStatement::SqliteStatement(SqliteConnection& connection, const std::string& sql)
    : connection_(connection),
      statement_(connection.checked([&] { return SQLite::Statement(*connection.opened_, sql); })) {}

SqliteStatement& SqliteStatement::with(const std::vector<Cell>& parameters) {
  connection_.checked([&] {
    (void)statement_.tryReset();  // gives once more the error that its last run has thrown
    bind_cells(statement_, parameters);
  });
  return *this;
}

bool SqliteStatement::next() {
  return connection_.checked([&] {
    if (statement_.executeStep()) {
      return true;
    }
    statement_.reset();
    return false;
  });
}

void SqliteStatement::run(const std::vector<Cell>& parameters) {
  with(parameters);
  sim::ensure(!next(), "a statement that changes the database has a result");
}

void SqliteStatement::reset() {
  connection_.checked([&] { statement_.reset(); });
}

std::string SqliteStatement::column_name(int column) const {
  return connection_.checked([&] { return std::string(statement_.getColumnName(column)); });
}

std::vector<std::string> SqliteStatement::column_names() const {
  std::vector<std::string> names;
  for (int column = 0; column < columns(); ++column) {
    names.push_back(column_name(column));
  }
  return names;
}

Cell SqliteStatement::cell(int column) const {
  return connection_.checked([&]() -> Cell {
    const SQLite::Column value = statement_.getColumn(column);
    switch (value.getType()) {
      case SQLITE_INTEGER:
        return std::int64_t{value.getInt64()};
      case SQLITE_FLOAT:
        return value.getDouble();
      case SQLITE_TEXT:
        return value.getString();
      case SQLITE_NULL:
        return {};
      default:
        refuse(column, ColumnType::text);
    }
  });
}

void SqliteStatement::refuse(int column, ColumnType wanted) const {
  throw sim::UserError(connection_.name_ + ": its column " + column_name(column) +
                       " holds a value that is no " + std::string(sql_type(wanted)) +
                       "; the file was damaged or changed: take a copy that is whole, or remove it");
}

void bind_cells(SQLite::Statement& statement, std::span<const Cell> cells) {
  int index = 0;
  for (const Cell& cell : cells) {
    ++index;
    if (std::holds_alternative<std::monostate>(cell)) {
      statement.bind(index);
    } else if (const auto* integer = std::get_if<std::int64_t>(&cell)) {
      statement.bind(index, *integer);
    } else if (const auto* real = std::get_if<double>(&cell)) {
      statement.bind(index, *real);
    } else {
      statement.bind(index, std::get<std::string>(cell));
    }
  }
}

bool has_log_or_journal(const std::filesystem::path& database) {
  const std::string place = place_of(database).string();
  for (const char* suffix : {"-wal", "-journal"}) {
    std::error_code error;
    const std::uintmax_t bytes = std::filesystem::file_size(place + suffix, error);
    if (!error && bytes > 0) {
      return true;
    }
  }
  return false;
}

std::string sql_name(std::string_view name) {
  std::string quoted = "\"";
  for (const char c : name) {
    quoted += c == '"' ? "\"\"" : std::string(1, c);
  }
  return quoted + "\"";
}

std::string insert_sql(const std::string& table, std::size_t columns) {
  std::string places;
  for (std::size_t i = 0; i < columns; ++i) {
    places += i == 0 ? "?" : ", ?";
  }
  return "INSERT INTO " + table + " VALUES (" + places + ")";
}

std::string_view sql_type(ColumnType type) {
  switch (type) {
    case ColumnType::integer:
      return "INTEGER";
    case ColumnType::real:
      return "REAL";
    case ColumnType::text:
      return "TEXT";
    case ColumnType::boolean:
      return "BOOLEAN";
  }
  throw sim::InternalError("a column of an unknown type");
}

}  // namespace marti::studies::tables
