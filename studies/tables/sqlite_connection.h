// SQLite with errors as exceptions: a connection and its statements. The only user of the library.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "studies/tables/table.h"

struct sqlite3;
struct sqlite3_stmt;

namespace marti::studies {

/// A connection to a database file. Every failure (no permission, disk full, damaged, ...) is a UserError
/// that names the file and gives SQLite's reason; running out of memory is std::bad_alloc.
class SqliteConnection {
 public:
  enum class Access : std::uint8_t {
    write,        ///< the file is made if it is missing
    write_alone,  ///< written without any lock: nobody else knows the file's name
    /// The file must exist; others may write it. A journal or log that a killed writer has left beside it is
    /// applied first, if the file and its directory may be written. If they may not, a journal or log that
    /// cannot be read is a UserError that says what to do, and a file without one is read without any lock.
    read
  };
  SqliteConnection(const std::filesystem::path& file, Access access);
  ~SqliteConnection();
  SqliteConnection(const SqliteConnection&) = delete;
  SqliteConnection& operator=(const SqliteConnection&) = delete;

  /// Runs statements without parameters; their results are dropped.
  void execute(const std::string& sql);
  /// The first column of a statement's first row; a cell without value if there is no row.
  [[nodiscard]] Cell value(const std::string& sql);
  [[nodiscard]] std::int64_t integer(const std::string& sql);

  /// Is a transaction open?
  [[nodiscard]] bool in_transaction() const;
  /// Ends the connection; a failure to do so is a UserError. The destructor ends it without reporting
  /// failures.
  void close();

 private:
  friend class SqliteStatement;
  void check(int status) const;

  std::string name_;
  bool writes_;
  bool cannot_recover_ = false;  // a journal or log lies beside the file and cannot be applied
  sqlite3* connection_ = nullptr;
};

/// A prepared statement of a connection, which must outlive it.
class SqliteStatement {
 public:
  SqliteStatement(SqliteConnection& connection, std::string_view sql);
  ~SqliteStatement();
  SqliteStatement(const SqliteStatement&) = delete;
  SqliteStatement& operator=(const SqliteStatement&) = delete;

  // Parameters, counted from 1. A text must live until the statement has run.
  SqliteStatement& bind(int index, std::int64_t value);
  SqliteStatement& bind(int index, double value);
  SqliteStatement& bind(int index, std::string_view text);
  SqliteStatement& bind(int index, const std::optional<std::int64_t>& value);
  SqliteStatement& bind(int index, const Cell& cell);

  /// The next row, if there is one.
  [[nodiscard]] bool next();
  /// Runs a statement that returns no rows, and makes it ready for the next parameters.
  void run();
  /// Makes the statement ready to run again. Parameters stay bound.
  void reset();

  // The present row, columns counted from 0. NULL reads as 0 or as an empty text; a value of another type is
  // a UserError, because the file is not what the program has written.
  [[nodiscard]] int columns() const;
  [[nodiscard]] std::string column_name(int column) const;
  [[nodiscard]] Cell cell(int column) const;
  [[nodiscard]] std::int64_t integer(int column) const;
  [[nodiscard]] std::optional<std::int64_t> optional_integer(int column) const;
  [[nodiscard]] std::string text(int column) const;

 private:
  // Whether there is a value; throws unless it is of this type.
  [[nodiscard]] bool has(int column, ColumnType type) const;

  SqliteConnection& connection_;
  sqlite3_stmt* statement_ = nullptr;
};

/// A transaction; rolled back unless it is committed.
class SqliteTransaction {
 public:
  explicit SqliteTransaction(SqliteConnection& connection);
  ~SqliteTransaction();
  SqliteTransaction(const SqliteTransaction&) = delete;
  SqliteTransaction& operator=(const SqliteTransaction&) = delete;
  void commit();

 private:
  SqliteConnection& connection_;
};

/// Whether a log or a journal that is not empty lies beside the file: it may hold what the file lacks.
[[nodiscard]] bool has_log_or_journal(const std::filesystem::path& database);

/// A name as SQL writes it, whatever it is made of.
[[nodiscard]] std::string sql_name(std::string_view name);

/// "INTEGER", "REAL" or "TEXT".
[[nodiscard]] std::string_view sql_type(ColumnType type);

}  // namespace marti::studies
