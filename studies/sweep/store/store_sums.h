// Checksums of what a store holds, to detect damage.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

#include "studies/tables/sqlite_connection.h"

namespace marti::studies::sweep {

/// A table of results, and what belongs to each of its rows: the intervals of a machine, the notes of a
/// frame.
struct ResultTable {
  std::string_view name;
  std::string_view id;    ///< its first column
  std::string_view part;  ///< the SQL that selects, for an id, what belongs to its row; empty: nothing does
};
inline constexpr ResultTable machine_results = {"results", "machine",
                                                "SELECT * FROM intervals WHERE machine = ? ORDER BY ordinal"};
inline constexpr ResultTable frame_results = {
    "frame_results", "frame", "SELECT ordinal, note FROM frame_notes WHERE frame = ? ORDER BY ordinal"};
inline constexpr ResultTable advice_rows = {"advice", "machine", ""};

/// The checksums of one table of results. Each covers the values of a row as they stand in the store, with
/// their types, and what belongs to the row. So a program that has other counters can check a store, too.
class RowSums {
 public:
  RowSums(tables::SqliteConnection& connection, const ResultTable& table);

  /// Writes the checksum of the row with this id, which the open transaction has written.
  void seal(std::int64_t id);
  /// Throws UserError for a row whose values are not those that were written.
  void check(const std::filesystem::path& file);

 private:
  [[nodiscard]] tables::Cell sum_of(const tables::SqliteStatement& row);

  tables::SqliteConnection& connection_;
  ResultTable table_;
  tables::SqliteStatement row_;
  std::optional<tables::SqliteStatement> part_;
  tables::SqliteStatement seal_;
  int checksum_ = -1;  // the column that holds it
};

/// Writes the checksum of the plan: of all tables that hold no results and are not of the host, and of the
/// SQL that made tables and views. Within a transaction, after the plan has been entered.
void seal_plan(tables::SqliteConnection& connection);

/// Throws UserError when the store is damaged: when its pages do not fit together (PRAGMA integrity_check),
/// or a checksum is not that of the values.
void check_whole(tables::SqliteConnection& connection, const std::filesystem::path& file);

}  // namespace marti::studies::sweep
