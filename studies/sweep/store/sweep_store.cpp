#include "studies/sweep/store/sweep_store.h"

#include <fmt/chrono.h>
#include <unistd.h>

#include <ctime>
#include <unordered_map>
#include <unordered_set>

#include "sim/error.h"
#include "sim/mapped.h"
#include "studies/sweep/store/store_schema.h"
#include "studies/sweep/store/store_sums.h"
#include "studies/tables/provenance.h"

namespace marti::studies::sweep {

namespace {

std::string now() { return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr))); }

}  // namespace

SweepStore::SweepStore(const std::filesystem::path& file, const SweepPlan& plan, const StoreLock* held) {
  if (held == nullptr) {
    lock_.emplace(file);
  }
  connection_.emplace(check_store_file(file), tables::SqliteConnection::Access::write);
  const bool is_new = is_empty_database(*connection_);
  if (!is_new) {
    check_store_format(*connection_, file);
    check_store_version(*connection_, file);
    check_whole(*connection_, file);
    check_study(*connection_, file, plan.study);
  }
  begin_log();
  connection_->transact([&] {
    if (is_new) {
      create_store(*connection_);
    }
    const std::optional<std::string> plan_before = value_of(*connection_, "checksum");
    ids_ = enter_plan(*connection_, plan);
    seal_plan(*connection_);
    if (value_of(*connection_, "checksum") != plan_before) {
      connection_->execute("DELETE FROM advice");  // other machines may matter now, or cost something else
    }
    begin_session();
  });
  writer_.emplace(*connection_);
  reader_.emplace(*connection_);
}

// What is committed to the log survives the end of the program; only a power cut may take the last commits.
// Going to a log and back changes two bytes of the first page, which one write of one sector does. SQLite's
// journal for it would stand in the way of readers if the program were killed in between, so there is none.
void SweepStore::begin_log() {
  if (connection_->value<std::string>("PRAGMA journal_mode") != "wal") {
    connection_->execute("PRAGMA journal_mode = OFF; PRAGMA journal_mode = WAL");
  }
  connection_->execute("PRAGMA synchronous = NORMAL");
}

void SweepStore::begin_session() {
  session_ =
      connection_->value<std::int64_t>("SELECT COALESCE(MAX(id), 0) + 1 FROM host_sessions").value_or(1);
  std::vector<tables::Cell> cells = {session_, now(), tables::Cell(), host_name(), getpid()};
  const tables::Table host = tables::host_table();
  for (const char* what : {"processor", "system", "threads"}) {
    for (const std::vector<tables::Cell>& row : host.rows()) {
      if (row[0] == tables::Cell(what)) {
        cells.push_back(row[1]);
      }
    }
  }
  tables::SqliteStatement(*connection_, tables::insert_sql("host_sessions", cells.size())).run(cells);
}

std::vector<bool> SweepStore::done() { return done("SELECT machine FROM results", ids_.machines); }

std::vector<bool> SweepStore::frames_done() { return done("SELECT frame FROM frame_results", ids_.frames); }

std::vector<bool> SweepStore::done(const std::string& query, const std::vector<std::int64_t>& ids) {
  std::unordered_set<std::int64_t> there;
  tables::SqliteStatement rows(*connection_, query);
  while (rows.next()) {
    there.insert(rows.integer(0));
  }
  return sim::mapped(ids, [&](const std::int64_t id) { return there.contains(id); });
}

bool SweepStore::add_frame(std::size_t frame, const FrameRow& row, std::int64_t cpu_nanoseconds) {
  const std::int64_t id = ids_.frames.at(frame);
  if (const std::optional<FrameRow> known = reader_->find_frame(id)) {
    sim::ensure(known == row, "the same frame has given two results");
    return false;
  }
  connection_->transact([&] {
    writer_->add(id, row);
    add_cost("host_frames", id, cpu_nanoseconds);
  });
  return true;
}

void SweepStore::add_result(std::size_t machine, const SweepRow& row, std::int64_t cpu_nanoseconds) {
  const std::int64_t id = ids_.machines.at(machine);
  if (const std::optional<SweepRow> known = reader_->find_machine(id)) {
    sim::ensure(known == row, "the same machine has given two results");
    return;
  }
  connection_->transact([&] {
    writer_->add(id, row);
    add_cost("host_machines", id, cpu_nanoseconds);
  });
}

void SweepStore::add_advice(std::size_t machine, const Advice& advice) {
  const std::int64_t id = ids_.machines.at(machine);
  connection_->transact([&] {
    tables::SqliteStatement(*connection_, tables::insert_sql("advice", 6))
        .run({id, advice.sentence, advice.settings, advice.saves, advice.noise, tables::Cell()});
    RowSums(*connection_, advice_rows).seal(id);
  });
}

std::vector<bool> SweepStore::advised() { return done("SELECT machine FROM advice", ids_.machines); }

std::vector<std::int64_t> SweepStore::sums(const std::string& sql) {
  std::unordered_map<std::int64_t, std::int64_t> by_id;
  tables::SqliteStatement rows(*connection_, "SELECT machine, " + sql + " FROM results");
  while (rows.next()) {
    by_id[rows.integer(0)] = rows.integer(1);
  }
  return sim::mapped(ids_.machines, [&](const std::int64_t id) { return by_id.at(id); });
}

std::optional<FrameRow> SweepStore::find_frame(std::size_t frame) {
  return reader_->find_frame(ids_.frames.at(frame));
}

void SweepStore::add_cost(const std::string& table, std::int64_t id, std::int64_t cpu_nanoseconds) {
  tables::SqliteStatement(*connection_, tables::insert_sql(table, 3)).run({id, session_, cpu_nanoseconds});
}

void SweepStore::close() {
  writer_.reset();
  reader_.reset();
  tables::SqliteStatement(*connection_, "UPDATE host_sessions SET ended = ? WHERE id = ?")
      .run({now(), session_});
  connection_->execute("PRAGMA wal_checkpoint(TRUNCATE)");
  try {
    // Ends the log, without a journal as at its beginning.
    connection_->execute("PRAGMA busy_timeout = 0; PRAGMA journal_mode = OFF");
  } catch (const sim::UserError&) {
    // A reader still needs the log: the process that opens the store next ends it.
  }
  connection_.reset();
  lock_.reset();
}

}  // namespace marti::studies::sweep
