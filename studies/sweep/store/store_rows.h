// Rows of results into the store and back.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "studies/sweep/plan/sweep_row.h"
#include "studies/sweep/store/store_sums.h"
#include "studies/tables/sqlite_connection.h"

namespace marti::studies::sweep {

/// Adds rows with their checksums; its statements are prepared once. Within a transaction.
class RowWriter {
 public:
  explicit RowWriter(tables::SqliteConnection& connection);

  void add(std::int64_t machine, const SweepRow& row);
  void add(std::int64_t frame, const FrameRow& row);

 private:
  tables::SqliteStatement result_;
  tables::SqliteStatement interval_;
  tables::SqliteStatement frame_;
  tables::SqliteStatement note_;
  RowSums machine_sums_;
  RowSums frame_sums_;
};

/// Reads rows; its statements are prepared once.
class RowReader {
 public:
  explicit RowReader(tables::SqliteConnection& connection);

  /// The row, if it is there. A counter that the store has no column for has no value.
  [[nodiscard]] std::optional<SweepRow> find_machine(std::int64_t machine);
  [[nodiscard]] std::optional<FrameRow> find_frame(std::int64_t frame);

 private:
  tables::SqliteStatement result_;
  tables::SqliteStatement intervals_;
  tables::SqliteStatement frame_;
  tables::SqliteStatement notes_;
  std::vector<int> result_places_;  // of each counter: its column; -1: none
  std::vector<int> interval_places_;
  std::vector<int> frame_places_;
};

}  // namespace marti::studies::sweep
