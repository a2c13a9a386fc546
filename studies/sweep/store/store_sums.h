// Checksums of what a store holds, to detect damage.
#pragma once

#include <cstdint>
#include <filesystem>

#include "studies/tables/sqlite_connection.h"

namespace marti::studies {

/// The checksums of one table of results. Each covers the values of a row as they stand in the store, with
/// their types, and what belongs to the row: the histograms of a machine, the notes of a frame. So a program
/// that has other counters can check a store, too.
class RowSums {
 public:
  enum class Kind : std::uint8_t { machines, frames };
  RowSums(SqliteConnection& connection, Kind kind);

  /// Writes the checksum of the row with this id, which the open transaction has written.
  void seal(std::int64_t id);
  /// Throws UserError for a row whose values are not those that were written.
  void check(const std::filesystem::path& file);

 private:
  [[nodiscard]] std::int64_t sum_of(SqliteStatement& row);

  SqliteConnection& connection_;
  Kind kind_;
  SqliteStatement row_;
  SqliteStatement parts_;
  SqliteStatement seal_;
  int checksum_ = -1;  // the column that holds it
};

/// Writes the checksum of the plan: of all tables that hold no results and are not of the host, and of the
/// SQL that made tables and views. Within a transaction, after the plan has been entered.
void seal_plan(SqliteConnection& connection);

/// Throws UserError when the store is damaged: when its pages do not fit together (PRAGMA integrity_check),
/// or a checksum is not that of the values. A store of format 1 has no checksums.
void check_whole(SqliteConnection& connection, const std::filesystem::path& file, std::int64_t format);

}  // namespace marti::studies
