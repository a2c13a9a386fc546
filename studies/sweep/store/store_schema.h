// The tables of a sweep's store, as docs/sweep.md and docs/internals/store.md describe them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "studies/sweep/plan/sweep_plan.h"
#include "studies/sweep/plan/sweep_row.h"
#include "studies/tables/sqlite_connection.h"

namespace marti::studies::sweep {

/// Where the counters of the tables begin, after the columns that are no counters.
inline constexpr std::size_t first_result_counter = 2 + histogram_names.size();
inline constexpr std::size_t first_frame_counter = 6;

/// The file itself. Throws UserError when it is there but is not a whole SQLite database, before SQLite has
/// touched it.
const std::filesystem::path& check_store_file(const std::filesystem::path& file);

/// Whether nothing was ever written into the database: it is new.
[[nodiscard]] bool is_empty_database(tables::SqliteConnection& connection);

/// What table `store` says: of "format", "version", "build" or "checksum".
[[nodiscard]] std::optional<std::string> value_of(tables::SqliteConnection& connection,
                                                  const std::string& what);

/// Throws UserError unless the database is a store of the format that this program reads.
void check_store_format(tables::SqliteConnection& connection, const std::filesystem::path& file);

/// Throws UserError unless this program may add results to the store: it must be of this version.
void check_store_version(tables::SqliteConnection& connection, const std::filesystem::path& file);

/// Throws UserError unless the store is of this study (SweepPlan::study), beside which its tables stand.
void check_study(tables::SqliteConnection& connection, const std::filesystem::path& file,
                 const std::string& study);

/// Makes the tables that stay. Within a transaction.
void create_store(tables::SqliteConnection& connection);

/// Makes table points, the view summary and table columns anew for the axes of a plan; points is left empty.
/// Within a transaction.
void create_points(tables::SqliteConnection& connection, const SweepPlan& plan);

}  // namespace marti::studies::sweep
