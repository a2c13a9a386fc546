// SQLite through SQLiteCpp, with errors for the user: a connection and its statements.
#pragma once

#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Statement.h>
#include <SQLiteCpp/Transaction.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "studies/tables/table.h"

namespace marti::studies::tables {

/// A connection to a database file. Every failure (no permission, disk full, damaged, ...) is a UserError
/// that names the file and gives SQLite's reason; running out of memory is std::bad_alloc.
class SqliteConnection {
 public:
  enum class Access : std::uint8_t {
    write,        ///< the file is made if it is missing
    write_alone,  ///< written without any lock: nobody else knows the file's name
    memory,       ///< no file but a new database in memory; messages name `file`, where its content is from
    /// The file must exist; others may write it. A journal or log that a killed writer has left beside it is
    /// applied first, if the file and its directory may be written. If they may not, a journal or log that
    /// cannot be read is a UserError that says what to do, and a file without one is read without any lock.
    read
  };
  SqliteConnection(const std::filesystem::path& file, Access access);
  SqliteConnection(const SqliteConnection&) = delete;
  SqliteConnection& operator=(const SqliteConnection&) = delete;

  /// Runs statements without parameters; their results are dropped.
  void execute(const std::string& sql);
  /// The first column of a statement's first row, if there is a row and the column has a value of this type.
  template <class Value>
  [[nodiscard]] std::optional<Value> value(const std::string& sql);
  /// Calls `change` in a transaction, which is rolled back when it throws.
  template <class Change>
  void transact(const Change& change);

 private:
  friend class SqliteStatement;
  /// Calls it and turns SQLite's errors into those of the user.
  template <class Call>
  auto checked(const Call& call) const {
    try {
      return call();
    } catch (const SQLite::Exception& error) {
      fail(error);
    }
  }
  [[noreturn]] void fail(const SQLite::Exception& error) const;

  std::string name_;
  bool writes_;
  bool in_memory_;
  bool cannot_recover_ = false;             // a journal or log lies beside the file and cannot be applied
  std::optional<SQLite::Database> opened_;  // empty only while it is being opened
};

/// A prepared statement of a connection, which must outlive it.
class SqliteStatement {
 public:
  SqliteStatement(SqliteConnection& connection, const std::string& sql);

  /// Begins anew with these parameters.
  SqliteStatement& with(const std::vector<Cell>& parameters);
  /// The next row, if there is one; else the statement is ready to begin anew.
  [[nodiscard]] bool next();
  /// Runs a statement that returns no rows with these parameters.
  void run(const std::vector<Cell>& parameters);
  /// Ends a statement before its last row, so that it holds no lock.
  void reset();

  // The present row, columns counted from 0. NULL is no value, or reads as 0 or as an empty text; a value of
  // another type is a UserError, because the file is not what the program has written.
  [[nodiscard]] int columns() const { return statement_.getColumnCount(); }
  [[nodiscard]] std::string column_name(int column) const;
  [[nodiscard]] std::vector<std::string> column_names() const;
  [[nodiscard]] Cell cell(int column) const;
  template <class Value>
  [[nodiscard]] std::optional<Value> get(int column) const;
  [[nodiscard]] std::int64_t integer(int column) const { return get<std::int64_t>(column).value_or(0); }
  [[nodiscard]] std::string text(int column) const { return get<std::string>(column).value_or(""); }

 private:
  [[noreturn]] void refuse(int column, ColumnType wanted) const;

  SqliteConnection& connection_;
  SQLite::Statement statement_;
};

template <class Value>
std::optional<Value> SqliteStatement::get(int column) const {
  const Cell found = cell(column);
  const auto* value = std::get_if<Value>(&found);
  if (value == nullptr && !std::holds_alternative<std::monostate>(found)) {
    refuse(column, std::is_same_v<Value, std::string> ? ColumnType::text
                   : std::is_same_v<Value, double>    ? ColumnType::real
                                                      : ColumnType::integer);
  }
  return value == nullptr ? std::nullopt : std::optional(*value);
}

template <class Value>
std::optional<Value> SqliteConnection::value(const std::string& sql) {
  SqliteStatement statement(*this, sql);
  const Cell cell = statement.next() ? statement.cell(0) : Cell();
  const auto* found = std::get_if<Value>(&cell);
  return found == nullptr ? std::nullopt : std::optional(*found);
}

template <class Change>
void SqliteConnection::transact(const Change& change) {
  checked([&] {
    SQLite::Transaction transaction(*opened_, SQLite::TransactionBehavior::IMMEDIATE);
    change();
    transaction.commit();
  });
}

/// Gives the statement's parameters these values, from the first on.
void bind_cells(SQLite::Statement& statement, std::span<const Cell> cells);

/// Whether a log or a journal that is not empty lies beside the file: it may hold what the file lacks.
[[nodiscard]] bool has_log_or_journal(const std::filesystem::path& database);

/// A name as SQL writes it, whatever it is made of.
[[nodiscard]] std::string sql_name(std::string_view name);

/// "INSERT INTO table VALUES (?, ...)", with so many parameters.
[[nodiscard]] std::string insert_sql(const std::string& table, std::size_t columns);

/// "INTEGER", "REAL" or "TEXT".
[[nodiscard]] std::string_view sql_type(ColumnType type);

}  // namespace marti::studies::tables
