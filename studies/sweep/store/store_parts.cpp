#include "studies/sweep/store/store_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <regex>
#include <system_error>

#include "sim/error.h"
#include "sim/joined.h"
#include "studies/sweep/store/store_lock.h"
#include "studies/sweep/store/store_schema.h"
#include "studies/sweep/store/store_sums.h"
#include "studies/sweep/store/sweep_reader.h"
#include "studies/sweep/store/sweep_store.h"
#include "studies/tables/result_directory.h"

namespace marti::studies::sweep {

namespace {

namespace fs = std::filesystem;

void add_keys(tables::SqliteConnection& connection, const std::string& sql, std::set<std::string>& keys) {
  tables::SqliteStatement rows(connection, sql);
  while (rows.next()) {
    keys.insert(rows.text(0));
  }
}

// Copies rows of an attached part for what table `taken` lists. Only the ids of frames, machines and sessions
// differ between stores of one program.
void copy_rows(tables::SqliteConnection& connection, const std::string& table, const std::string& id,
               std::int64_t sessions) {
  std::vector<std::string> columns =
      tables::SqliteStatement(connection, "SELECT * FROM part." + table).column_names();
  for (std::string& column : columns) {
    column = column == id          ? "ours"
             : column == "session" ? fmt::format("session + {}", sessions)
                                   : tables::sql_name(column);
  }
  connection.execute(
      fmt::format("INSERT INTO main.{0} SELECT {1} FROM part.{0} JOIN temp.taken ON theirs = {2}", table,
                  sim::joined(columns), id));
}

// Copies what the store knows of and has no result for.
void copy_results(tables::SqliteConnection& connection, const ResultTable& results, const std::string& known,
                  const std::vector<std::string>& tables, std::int64_t sessions) {
  connection.execute(
      fmt::format("CREATE TEMP TABLE taken AS SELECT theirs.id AS theirs, ours.id AS ours FROM part.{0} r "
                  "JOIN part.{2} theirs ON theirs.id = r.{1} JOIN main.{2} ours ON ours.key = theirs.key "
                  "WHERE ours.id NOT IN (SELECT {1} FROM main.{0}) ORDER BY ours.id",
                  results.name, results.id, known));
  for (const std::string& table : tables) {
    copy_rows(connection, table, std::string(results.id), sessions);
  }
  RowSums sums(connection, results);
  std::vector<std::int64_t> ids;
  {
    tables::SqliteStatement taken(connection, "SELECT ours FROM temp.taken");
    while (taken.next()) {
      ids.push_back(taken.integer(0));
    }
  }
  for (const std::int64_t id : ids) {
    sums.seal(id);
  }
  connection.execute("DROP TABLE temp.taken");
}

}  // namespace

fs::path part_file(const fs::path& directory, std::uint32_t number, std::uint32_t of) {
  return directory / fmt::format("results.{}-of-{}.sqlite", number, of);
}

std::vector<fs::path> parts_in(const fs::path& directory) {
  static const std::regex name(R"(results\.[0-9]+-of-[0-9]+\.sqlite)");
  std::vector<fs::path> parts;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory, error)) {
    if (std::regex_match(entry.path().filename().string(), name)) {
      parts.push_back(entry.path());
    }
  }
  std::ranges::sort(parts);
  return parts;
}

void DoneKeys::add(const fs::path& store) {
  if (!is_begun(store)) {
    return;
  }
  tables::SqliteConnection connection(store, tables::SqliteConnection::Access::read);
  connection.execute("BEGIN");  // from here on all reads are of one instant
  check_store_format(connection, store);
  check_store_version(connection, store);
  check_whole(connection, store);
  add_keys(connection, "SELECT key FROM machines WHERE id IN (SELECT machine FROM results)", machines);
  add_keys(connection, "SELECT key FROM frames WHERE id IN (SELECT frame FROM frame_results)", frames);
}

DoneKeys done_in(const fs::path& directory) {
  DoneKeys done;
  if (!directory.empty()) {
    done.add(directory / tables::database_name);
    for (const fs::path& part : parts_in(directory)) {
      if (!tables::has_log_or_journal(part)) {  // which it has while it is being written
        done.add(part);
      }
    }
  }
  return done;
}

void SweepStore::merge(const fs::path& part) {
  const StoreLock lock(part);
  DoneKeys().add(part);  // refuses what may not be merged
  bool all_taken = true;
  if (is_begun(part)) {
    tables::SqliteStatement(*connection_, "ATTACH ? AS part").run({fs::absolute(part).string()});
    connection_->transact([&] {
      const std::int64_t sessions =
          connection_->value<std::int64_t>("SELECT MAX(id) FROM main.host_sessions").value_or(0);
      copy_results(*connection_, frame_results, "frames", {"frame_results", "frame_notes", "host_frames"},
                   sessions);
      copy_results(*connection_, machine_results, "machines", {"results", "intervals", "host_machines"},
                   sessions);
      connection_->execute(fmt::format(
          "INSERT INTO main.host_sessions SELECT id + {}, began, ended, host, process, processor, system, "
          "threads FROM part.host_sessions",
          sessions));
    });
    all_taken = connection_->value<std::int64_t>(
                    "SELECT COUNT(*) FROM part.results r JOIN part.machines m ON m.id = r.machine "
                    "WHERE m.key NOT IN (SELECT key FROM main.machines)") == 0;
    connection_->execute("DETACH part");
  }
  if (all_taken) {
    for (const char* const ending : {"", "-wal", "-shm"}) {
      std::error_code ignored;
      fs::remove(part.string() + ending, ignored);
    }
  }
}

}  // namespace marti::studies::sweep
