// The results of a sweep: one SQLite file that many runs of the program add to.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "studies/sweep/plan/sweep_plan.h"
#include "studies/sweep/plan/sweep_row.h"
#include "studies/sweep/store/store_lock.h"
#include "studies/sweep/store/store_plan.h"
#include "studies/sweep/store/store_rows.h"
#include "studies/sweep/store/sweep_reader.h"
#include "studies/tables/sqlite_connection.h"

namespace marti::studies::sweep {

/// Write-ahead logged; each result is one transaction, so that a program that is killed loses the machines in
/// flight and nothing else. One process writes it at a time; another is refused. All failures are UserErrors
/// that name the file.
class SweepStore {
 public:
  /// Opens the file, or makes it, and enters what the plan asks for in one transaction: older results stay.
  /// Refuses a file that is not a store, one of another version of the store or of the program (whose results
  /// could differ), and one that another process has open.
  /// `held`: the lock of the file, where the caller has it.
  SweepStore(const std::filesystem::path& file, const SweepPlan& plan, const StoreLock* held = nullptr);

  /// For each machine of the plan: is its result there?
  [[nodiscard]] std::vector<bool> done();
  /// For each frame of the plan: is its row there?
  [[nodiscard]] std::vector<bool> frames_done();

  // Each is committed when it returns. A row that is there already must be equal, else InternalError: the
  // same machine has given two results. `cpu_nanoseconds` is what the host took; it differs from run to run,
  // so it goes to tables of its own.
  // add_frame() returns false for a row that was there.
  bool add_frame(std::size_t frame, const FrameRow& row, std::int64_t cpu_nanoseconds);
  void add_result(std::size_t machine, const SweepRow& row, std::int64_t cpu_nanoseconds);

  /// What would help a machine of the plan, which has none yet. It is committed when this returns. A plan
  /// that differs from the one before begins without advice.
  void add_advice(std::size_t machine, const Advice& advice);
  /// For each machine of the plan: has it advice?
  [[nodiscard]] std::vector<bool> advised();

  /// For each machine of the plan, all of which are done, the value of an integer expression of counters.
  [[nodiscard]] std::vector<std::int64_t> sums(const std::string& sql);
  /// The row of a frame of the plan, if it is there.
  [[nodiscard]] std::optional<FrameRow> find_frame(std::size_t frame);

  /// Takes what a part of this store (store_parts.h) has of the plan's machines and the store has not, in one
  /// transaction, and removes the part, unless it has results that no plan of the store has asked for. Throws
  /// UserError when a process is writing the part, and when its results may not be merged with those of this
  /// program.
  void merge(const std::filesystem::path& part);

  /// Ends the write-ahead log, so that the store is one file again.
  void close();

 private:
  void begin_log();
  void begin_session();
  [[nodiscard]] std::vector<bool> done(const std::string& query, const std::vector<std::int64_t>& ids);
  void add_cost(const std::string& table, std::int64_t id, std::int64_t cpu_nanoseconds);

  std::optional<StoreLock> lock_;  // empty where the caller holds it; ends after the connection
  std::optional<tables::SqliteConnection> connection_;
  std::optional<RowWriter> writer_;  // these are made when the tables are there
  std::optional<RowReader> reader_;
  StoreIds ids_;
  std::int64_t session_ = 0;
};

}  // namespace marti::studies::sweep
