#include "studies/tables/sqlite_connection.h"

#include <sqlite3.h>
#include <unistd.h>

#include <cstring>
#include <new>

#include "sim/error.h"

namespace marti::studies {

namespace {

// How long to wait for a lock: another process may just be writing or cleaning up.
constexpr int patience_ms = 5000;

// A file's name as the path of a URI.
std::string uri_of(const std::filesystem::path& file) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string uri = "file:";
  for (const char c : std::filesystem::absolute(file).string()) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '/';
    if (plain) {
      uri += c;
    } else {
      uri += {'%', digits[byte >> 4U], digits[byte & 15U]};
    }
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

SqliteConnection::SqliteConnection(const std::filesystem::path& file, Access access)
    : name_(file.string()), writes_(access != Access::read) {
  int flags = SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_READWRITE;
  std::string place = file.string();
  if (writes_) {
    flags |= SQLITE_OPEN_CREATE;
  } else if (!may_be_changed(place_of(file))) {
    flags = SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_READONLY;
    cannot_recover_ = has_log_or_journal(file);
    if (!cannot_recover_) {
      place = uri_of(place_of(file));
      flags |= SQLITE_OPEN_URI;
    }
  }
  const int status = sqlite3_open_v2(place.c_str(), &connection_, flags,
                                     access == Access::write_alone ? "unix-none" : nullptr);
  try {
    check(status);
    check(sqlite3_extended_result_codes(connection_, 1));
    check(sqlite3_busy_timeout(connection_, patience_ms));
  } catch (...) {
    sqlite3_close_v2(connection_);
    throw;
  }
}

SqliteConnection::~SqliteConnection() { sqlite3_close_v2(connection_); }

void SqliteConnection::check(int status) const {
  if (status == SQLITE_OK || status == SQLITE_DONE || status == SQLITE_ROW) {
    return;
  }
  const int kind = status & 0xff;  // without the bits of the extended code
  if (kind == SQLITE_NOMEM || connection_ == nullptr) {
    throw std::bad_alloc();
  }
  std::string message = name_ + ": the database cannot be " + (writes_ ? "written: " : "read: ");
  message += sqlite3_errmsg(connection_);
  if (kind == SQLITE_IOERR || kind == SQLITE_CANTOPEN) {
    const int reason = sqlite3_system_errno(connection_);
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
  check(sqlite3_exec(connection_, sql.c_str(), nullptr, nullptr, nullptr));
}

Cell SqliteConnection::value(const std::string& sql) {
  SqliteStatement statement(*this, sql);
  return statement.next() ? statement.cell(0) : Cell();
}

std::int64_t SqliteConnection::integer(const std::string& sql) {
  const Cell cell = value(sql);
  const auto* number = std::get_if<std::int64_t>(&cell);
  return number == nullptr ? 0 : *number;
}

bool SqliteConnection::in_transaction() const {
  return connection_ != nullptr && sqlite3_get_autocommit(connection_) == 0;
}

void SqliteConnection::close() {
  check(sqlite3_close(connection_));
  connection_ = nullptr;
}

SqliteStatement::SqliteStatement(SqliteConnection& connection, std::string_view sql)
    : connection_(connection) {
  connection.check(sqlite3_prepare_v2(connection.connection_, sql.data(), static_cast<int>(sql.size()),
                                      &statement_, nullptr));
}

SqliteStatement::~SqliteStatement() { sqlite3_finalize(statement_); }

SqliteStatement& SqliteStatement::bind(int index, std::int64_t value) {
  connection_.check(sqlite3_bind_int64(statement_, index, value));
  return *this;
}

SqliteStatement& SqliteStatement::bind(int index, double value) {
  connection_.check(sqlite3_bind_double(statement_, index, value));
  return *this;
}

SqliteStatement& SqliteStatement::bind(int index, std::string_view text) {
  // A null pointer would be NULL and no text.
  const char* data = text.data() == nullptr ? "" : text.data();
  connection_.check(sqlite3_bind_text64(statement_, index, data, text.size(), nullptr, SQLITE_UTF8));
  return *this;
}

SqliteStatement& SqliteStatement::bind(int index, const std::optional<std::int64_t>& value) {
  connection_.check(value ? sqlite3_bind_int64(statement_, index, *value)
                          : sqlite3_bind_null(statement_, index));
  return *this;
}

SqliteStatement& SqliteStatement::bind(int index, const Cell& cell) {
  if (const auto* integer = std::get_if<std::int64_t>(&cell)) {
    return bind(index, *integer);
  }
  if (const auto* real = std::get_if<double>(&cell)) {
    return bind(index, *real);
  }
  if (const auto* text = std::get_if<std::string>(&cell)) {
    return bind(index, std::string_view(*text));
  }
  connection_.check(sqlite3_bind_null(statement_, index));
  return *this;
}

bool SqliteStatement::next() {
  const int status = sqlite3_step(statement_);
  connection_.check(status);
  return status == SQLITE_ROW;
}

void SqliteStatement::run() {
  const int status = sqlite3_step(statement_);
  const int again = sqlite3_reset(statement_);  // returns the error of the last step once more
  connection_.check(status);
  connection_.check(again);
}

void SqliteStatement::reset() { connection_.check(sqlite3_reset(statement_)); }

int SqliteStatement::columns() const { return sqlite3_column_count(statement_); }

std::string SqliteStatement::column_name(int column) const {
  const char* name = sqlite3_column_name(statement_, column);
  if (name == nullptr) {
    throw std::bad_alloc();
  }
  return name;
}

Cell SqliteStatement::cell(int column) const {
  switch (sqlite3_column_type(statement_, column)) {
    case SQLITE_INTEGER:
      return std::int64_t{sqlite3_column_int64(statement_, column)};
    case SQLITE_FLOAT:
      return sqlite3_column_double(statement_, column);
    case SQLITE_NULL:
      return {};
    default:
      return text(column);
  }
}

bool SqliteStatement::has(int column, ColumnType type) const {
  const int found = sqlite3_column_type(statement_, column);
  const int wanted = type == ColumnType::integer ? SQLITE_INTEGER
                     : type == ColumnType::real  ? SQLITE_FLOAT
                                                 : SQLITE_TEXT;
  if (found != wanted && found != SQLITE_NULL) {
    throw sim::UserError(connection_.name_ + ": its column " + column_name(column) +
                         " holds a value that is no " + std::string(sql_type(type)) +
                         "; the file was damaged or changed: take a copy that is whole, or remove it");
  }
  return found == wanted;
}

std::int64_t SqliteStatement::integer(int column) const {
  return has(column, ColumnType::integer) ? sqlite3_column_int64(statement_, column) : 0;
}

std::optional<std::int64_t> SqliteStatement::optional_integer(int column) const {
  return has(column, ColumnType::integer) ? std::optional(integer(column)) : std::nullopt;
}

std::string SqliteStatement::text(int column) const {
  if (!has(column, ColumnType::text)) {
    return {};
  }
  const auto* bytes = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
  const int size = sqlite3_column_bytes(statement_, column);
  return bytes == nullptr ? std::string() : std::string(bytes, static_cast<std::size_t>(size));
}

SqliteTransaction::SqliteTransaction(SqliteConnection& connection) : connection_(connection) {
  connection_.execute("BEGIN IMMEDIATE");
}

SqliteTransaction::~SqliteTransaction() {
  if (connection_.in_transaction()) {
    try {
      connection_.execute("ROLLBACK");
    } catch (const std::exception&) {
      // Whatever ended the transaction has been thrown already.
      return;
    }
  }
}

void SqliteTransaction::commit() { connection_.execute("COMMIT"); }

std::string sql_name(std::string_view name) {
  std::string quoted = "\"";
  for (const char c : name) {
    quoted += c;
    if (c == '"') {
      quoted += c;
    }
  }
  return quoted + "\"";
}

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

}  // namespace marti::studies
