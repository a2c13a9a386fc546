// A table in memory for SQL queries that come from a file of somebody else: they can read it and compute, and
// nothing more.
#pragma once

#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Statement.h>

#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "studies/tables/table.h"

namespace marti::studies::tables {

class QuerySandbox {
 public:
  /// Of an empty table of this name with these columns, which differ.
  QuerySandbox(std::string table, const std::vector<std::string>& columns);

  /// Adds a row, a cell for each column.
  void add_row(std::span<const Cell> cells);

  struct Rows {
    std::vector<std::string> names;  ///< of the columns, as the query gives them
    std::vector<std::vector<Cell>> rows;
  };
  /// The rows of one SELECT over the table, with texts as sim::shown() makes them printable. Beside SQLite's
  /// own functions that depend on nothing but their arguments it may call shown(VALUE, UNIT): the value as
  /// texts for people have it ("ps", "byte", "fraction", ...; text_units.h). Throws the UserError "PLACE:
  /// reason" for anything else than one such SELECT, and for one that takes more than 2 * 10^8 steps of
  /// SQLite or 256 MB, gives more than 10,000 rows or 10 MB, or makes a value of more than 100 kB. One step
  /// may take long, as to look for a long text in another. `reads`: is given the columns of the table that it
  /// reads, if not null. No other thread may use SQLite meanwhile.
  [[nodiscard]] Rows run(const std::string& sql, const sim::Place& place,
                         std::set<std::string>* reads = nullptr);

 private:
  SQLite::Database database_;
  std::string table_;
  std::optional<SQLite::Statement> insert_;  // a row into the table
};

}  // namespace marti::studies::tables
