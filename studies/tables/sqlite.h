// Tables as an SQLite database that is written once.
#pragma once

#include <filesystem>
#include <span>

#include "studies/tables/table.h"

namespace marti::studies::tables {

/// Writes all tables into a new database file in one transaction. Tables come in the order given, so that
/// equal tables give equal files; NaN becomes NULL, as SQLite has none. The file must be new or empty. It is
/// not journalled, so give it a temporary name until it is complete (sim::PendingFile). Every failure is a
/// UserError with SQLite's reason.
void write_database(const std::filesystem::path& file, std::span<const Table> tables);

}  // namespace marti::studies::tables
