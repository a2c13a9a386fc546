// Tables as an SQLite database that is written once.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "studies/tables/sqlite_connection.h"
#include "studies/tables/table.h"

namespace marti::studies {

/// A new database file. Every failure (no permission, disk full, ...) is a UserError with SQLite's reason;
/// running out of memory is std::bad_alloc.
class Database {
 public:
  /// Makes the file, which must be new or empty. It is not journalled, so give it a temporary name until it
  /// is complete (sim::PendingFile).
  explicit Database(const std::filesystem::path& file);

  /// Runs statements without parameters and without results.
  void execute(const std::string& sql) { connection_.execute(sql); }

  /// Makes a table of this name with the columns and rows of `table`. NaN becomes NULL, as SQLite has none.
  void add(const Table& table);

  /// Ends the connection; a failure to do so is a UserError. The destructor ends it without reporting
  /// failures.
  void close() { connection_.close(); }

 private:
  SqliteConnection connection_;
};

/// Writes all tables into a new database file in one transaction. Tables come in the order given, so that
/// equal tables give equal files.
void write_database(const std::filesystem::path& file, std::span<const Table> tables);

}  // namespace marti::studies
