// The tables of a sweep's store, as docs/sweep-store.md describes them.
#pragma once

#include <filesystem>

#include "studies/sweep/plan/sweep_plan.h"
#include "studies/tables/sqlite_connection.h"

namespace marti::studies {

/// The number of each table's first column that is a counter.
inline constexpr int first_result_counter = 2;
inline constexpr int first_frame_counter = 6;

/// Throws UserError when the file exists but is not a whole SQLite database, before SQLite has touched it.
void check_store_file(const std::filesystem::path& file);

/// Whether the database is new: nothing was ever written into it.
[[nodiscard]] bool is_empty_database(SqliteConnection& connection);

/// The store's format. Throws UserError unless the database is a store of a format that this program reads.
std::int64_t check_store_format(SqliteConnection& connection, const std::filesystem::path& file);

/// Throws UserError unless this program may add results to the store: it must be of this version and of the
/// newest format.
void check_store_version(SqliteConnection& connection, const std::filesystem::path& file);

/// Makes the tables that outlive a plan. Within a transaction.
void create_store(SqliteConnection& connection);

/// Makes table points, the view summary and table columns anew for the axes of a plan; points is left empty.
/// Within a transaction.
void create_points(SqliteConnection& connection, const SweepPlan& plan);

}  // namespace marti::studies
