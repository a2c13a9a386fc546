#include "studies/sweep/store/store_schema.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "processors/cost/accounting.h"
#include "sim/error.h"
#include "studies/host/program_build.h"
#include "studies/sweep/plan/sweep_row.h"
#include "studies/sweep/store/store_columns.h"
#include "studies/version.h"

namespace marti::studies::sweep {

namespace {

constexpr std::int64_t application = 0x6d617274;  // "mart"
constexpr std::int64_t format = 7;                // up to 6: histograms in tables of their own

constexpr std::string_view what_to_do =
    "; give another directory, or remove the file and run the sweep again";

constexpr const char* fixed_tables = R"(
CREATE TABLE store (what TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE provenance (what TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE columns ("table" TEXT NOT NULL, name TEXT NOT NULL, unit TEXT NOT NULL,
                      description TEXT NOT NULL, merge TEXT NOT NULL, better TEXT NOT NULL,
                      formula TEXT NOT NULL);
CREATE TABLE settings (id INTEGER PRIMARY KEY, key TEXT NOT NULL, value TEXT NOT NULL, UNIQUE (key, value));
CREATE TABLE sections (section INTEGER NOT NULL, setting INTEGER NOT NULL,
                       PRIMARY KEY (section, setting)) WITHOUT ROWID;
CREATE TABLE frames (id INTEGER PRIMARY KEY, key TEXT NOT NULL UNIQUE);
CREATE TABLE frame_sections (frame INTEGER NOT NULL, section INTEGER NOT NULL,
                             PRIMARY KEY (frame, section)) WITHOUT ROWID;
CREATE TABLE frame_notes (frame INTEGER NOT NULL, ordinal INTEGER NOT NULL, note TEXT NOT NULL,
                          PRIMARY KEY (frame, ordinal)) WITHOUT ROWID;
CREATE TABLE machines (id INTEGER PRIMARY KEY, key TEXT NOT NULL UNIQUE, frame INTEGER NOT NULL);
CREATE TABLE machine_sections (machine INTEGER NOT NULL, section INTEGER NOT NULL,
                               PRIMARY KEY (machine, section)) WITHOUT ROWID;
CREATE TABLE compare (machine INTEGER NOT NULL);
CREATE TABLE question (position INTEGER PRIMARY KEY, kind TEXT NOT NULL, name TEXT NOT NULL,
                       text TEXT NOT NULL, sql TEXT NOT NULL, place TEXT NOT NULL, agrees TEXT NOT NULL,
                       agrees_place TEXT NOT NULL);
CREATE TABLE advice (machine INTEGER PRIMARY KEY, sentence TEXT NOT NULL, settings TEXT NOT NULL, saves REAL,
                     noise REAL, checksum INTEGER);
CREATE TABLE host_sessions (id INTEGER PRIMARY KEY, began TEXT NOT NULL, ended TEXT, host TEXT NOT NULL,
                            process INTEGER NOT NULL, processor TEXT NOT NULL, system TEXT NOT NULL,
                            threads TEXT NOT NULL);
CREATE TABLE host_machines (machine INTEGER PRIMARY KEY, session INTEGER NOT NULL,
                            cpu_nanoseconds INTEGER NOT NULL);
CREATE TABLE host_frames (frame INTEGER PRIMARY KEY, session INTEGER NOT NULL,
                          cpu_nanoseconds INTEGER NOT NULL);
CREATE VIEW machine_settings AS
  SELECT m.machine AS machine, s.key AS key, s.value AS value
  FROM machine_sections m JOIN sections c ON c.section = m.section JOIN settings s ON s.id = c.setting;
CREATE VIEW frame_settings AS
  SELECT f.frame AS frame, s.key AS key, s.value AS value
  FROM frame_sections f JOIN sections c ON c.section = f.section JOIN settings s ON s.id = c.setting;
)";

bool has_columns(tables::SqliteConnection& connection, const std::string& table, std::size_t first,
                 std::span<const figures::FigureEntry> columns) {
  std::vector<std::string> names;  // none when there is no such table
  tables::SqliteStatement rows(connection, "SELECT name FROM pragma_table_info(?) ORDER BY cid");
  rows.with({table});
  while (rows.next()) {
    names.push_back(rows.text(0));
  }
  return names.size() == first + columns.size() &&
         std::equal(
             columns.begin(), columns.end(), names.begin() + static_cast<std::ptrdiff_t>(first),
             [](const figures::FigureEntry& column, const std::string& name) { return name == column.name; });
}

std::string counters_sql(std::span<const figures::FigureEntry> columns) {
  std::string sql;
  for (const figures::FigureEntry& column : columns) {
    sql += ", " + tables::sql_name(column.name) + " INTEGER";
  }
  return sql;
}

// An axis has the type of its values, if they all have the same.
std::string axis_type(const SweepPlan& plan, std::size_t axis) {
  constexpr std::array<std::string_view, 4> types = {"BOOLEAN", "INTEGER", "REAL", "TEXT"};
  std::string_view type;
  for (const SweepPoint& point : plan.points) {
    const std::string_view here = types.at(point.values.at(axis).index());
    if (!type.empty() && type != here) {
      return "";
    }
    type = here;
  }
  return std::string(type);
}

}  // namespace

const std::filesystem::path& check_store_file(const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (status.type() == std::filesystem::file_type::not_found) {
    return file;
  }
  if (!std::filesystem::is_regular_file(status)) {
    throw sim::UserError(file.string() + ": is not a regular file" + std::string(what_to_do));
  }
  const std::uintmax_t bytes = std::filesystem::file_size(file, error);
  if (!error && bytes == 0) {
    return file;  // made, but never written
  }
  if (std::ifstream(file, std::ios::binary).peek() == std::ifstream::traits_type::eof()) {
    throw sim::UserError(file.string() + ": cannot be read");
  }
  SQLite::Header header{};
  try {
    header = SQLite::Database::getHeaderInfo(file.string());
  } catch (const SQLite::Exception&) {
    throw sim::UserError(file.string() + ": is no SQLite database" + std::string(what_to_do));
  }
  // A log or journal beside the file may hold what it lacks. Pages of 65536 bytes are written as 1.
  const std::uint64_t page = header.pageSizeBytes == 1 ? 65536 : header.pageSizeBytes;
  const std::uint64_t expected = page * (header.databaseSizePages & 0xffffffffU);
  if (bytes < expected && !tables::has_log_or_journal(file)) {
    throw sim::UserError(file.string() + ": is damaged: it has " + std::to_string(bytes) + " bytes of " +
                         std::to_string(expected) + std::string(what_to_do));
  }
  return file;
}

bool is_empty_database(tables::SqliteConnection& connection) {
  return connection.value<std::int64_t>("PRAGMA application_id") == 0 &&
         connection.value<std::int64_t>("SELECT COUNT(*) FROM sqlite_schema") == 0;
}

std::optional<std::string> value_of(tables::SqliteConnection& connection, const std::string& what) {
  return connection.value<std::string>("SELECT value FROM store WHERE what = '" + what + "'");
}

void check_store_format(tables::SqliteConnection& connection, const std::filesystem::path& file) {
  if (connection.value<std::int64_t>("PRAGMA application_id") != application) {
    throw sim::UserError(file.string() + ": is a database, but not the store of a sweep" +
                         std::string(what_to_do));
  }
  const std::int64_t found = connection.value<std::int64_t>("PRAGMA user_version").value_or(0);
  if (found != format || value_of(connection, "format") != std::to_string(found)) {
    throw sim::UserError(file.string() + ": is a store of format " + std::to_string(found) +
                         ", but this program reads format " + std::to_string(format) +
                         "; use the program that wrote it, give another directory, or remove the file and "
                         "run the sweep again");
  }
}

void check_store_version(tables::SqliteConnection& connection, const std::filesystem::path& file) {
  const std::string found = value_of(connection, "version").value_or("");
  if (found != version) {
    throw sim::UserError(file.string() + ": was written by version " + found + ", but this is version " +
                         std::string(version) + ", whose results could differ; use version " + found +
                         ", give another directory, or remove the file and run the sweep again");
  }
  // The build holds a hash of the sources, because a program that was changed may give other results.
  if (value_of(connection, "build") != host::build_of_program() ||
      !has_columns(connection, "results", first_result_counter, figures::counted_figures()) ||
      !has_columns(connection, "frame_results", first_frame_counter, run::frame_figures())) {
    throw sim::UserError(file.string() + ": was written by another build of version " + found +
                         ", whose results could differ" + std::string(what_to_do));
  }
}

void check_study(tables::SqliteConnection& connection, const std::filesystem::path& file,
                 const std::string& study) {
  const std::string found =
      connection.value<std::string>("SELECT value FROM provenance WHERE what = 'study'").value_or("");
  if (found != study) {
    const auto command = [](const std::string& name) {
      return name.empty() ? std::string("`marti sweep`") : "`marti study " + name + "`";
    };
    throw sim::UserError(file.string() + ": is there already, of " + command(found) +
                         ", and a directory holds the results of one command, not also those of " +
                         command(study) + "; give another directory");
  }
}

void create_store(tables::SqliteConnection& connection) {
  connection.execute("PRAGMA application_id = " + std::to_string(application) +
                     "; PRAGMA user_version = " + std::to_string(format));
  connection.execute(fixed_tables);
  std::string histograms;
  std::string view;
  for (const std::string_view name : histogram_names) {
    histograms += fmt::format(", {}_histogram TEXT", name);
    view += fmt::format(
        "{} SELECT machine, '{}' AS what, b.value ->> 0 AS lowest, b.value ->> 1 AS highest, "
        "b.value ->> 2 AS count FROM results, json_each({}_histogram) AS b",
        view.empty() ? "" : " UNION ALL", name, name);
  }
  connection.execute("CREATE TABLE results (machine INTEGER PRIMARY KEY, checksum INTEGER" + histograms +
                     counters_sql(figures::counted_figures()) + "); CREATE VIEW histograms AS" + view);
  connection.execute(
      "CREATE TABLE frame_results (frame INTEGER PRIMARY KEY, scene TEXT NOT NULL, scene_hash TEXT NOT NULL, "
      "image_hash TEXT NOT NULL, hit_hash TEXT NOT NULL, checksum INTEGER" +
      counters_sql(run::frame_figures()) + ")");
  connection.execute(intervals_sql());
  tables::SqliteStatement store(connection, tables::insert_sql("store", 2));
  store.run({"format", std::to_string(format)});
  store.run({"version", version});
  store.run({"build", host::build_of_program()});
}

void create_points(tables::SqliteConnection& connection, const SweepPlan& plan) {
  connection.execute("DROP VIEW IF EXISTS summary; DROP TABLE IF EXISTS points; DELETE FROM columns;");
  std::string table =
      "CREATE TABLE points (ordinal INTEGER PRIMARY KEY, machine INTEGER NOT NULL, base INTEGER NOT NULL, "
      "cost REAL NOT NULL";
  for (std::size_t axis = 0; axis < plan.axes.size(); ++axis) {
    table += ", " + tables::sql_name(plan.axes[axis]) + " " + axis_type(plan, axis);
  }
  connection.execute(table + ")");
  connection.execute(summary_view(plan.axes));
  tables::SqliteStatement insert(connection, tables::insert_sql("columns", 7));
  for (const StoreColumn& column : store_columns(plan.axes)) {
    insert.run({column.table, column.name, column.unit, column.description, column.merge, column.better,
                column.formula});
  }
}

}  // namespace marti::studies::sweep
