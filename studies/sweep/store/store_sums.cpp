#include "studies/sweep/store/store_sums.h"

#include <bit>
#include <string>
#include <string_view>

#include "sim/error.h"
#include "studies/sweep/plan/digest.h"

namespace marti::studies {

namespace {

struct KindSql {
  std::string_view table;
  std::string_view id;
  std::string_view parts;
};

constexpr KindSql machine_sql = {
    "results", "machine",
    "SELECT wait, lowest, highest, count FROM wait_buckets WHERE machine = ? ORDER BY wait, lowest"};
constexpr KindSql frame_sql = {"frame_results", "frame",
                               "SELECT ordinal, note FROM frame_notes WHERE frame = ? ORDER BY ordinal"};

const KindSql& sql_of(RowSums::Kind kind) {
  return kind == RowSums::Kind::machines ? machine_sql : frame_sql;
}

// In the order in which they were made. Table `store` is left to the end, as it holds the checksum.
constexpr std::string_view plan_tables[] = {"provenance", "columns",        "settings", "sections",
                                            "frames",     "frame_sections", "machines", "machine_sections",
                                            "waits",      "buckets",        "points",   "compare"};

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what) {
  throw sim::UserError(file.string() + ": is damaged: " + what +
                       "; take a copy that is whole, or remove the file and run the sweep again");
}

void add_number(Digest& digest, std::uint64_t value) {
  char bytes[8];
  for (unsigned i = 0; i < 8; ++i) {
    bytes[i] = static_cast<char>(value >> (8 * i) & 0xffU);
  }
  digest.add({bytes, sizeof bytes});
}

// A letter for its type; a number as 64 bits, the lowest byte first; a text after its length.
void add_cell(Digest& digest, const Cell& cell) {
  if (const auto* integer = std::get_if<std::int64_t>(&cell)) {
    digest.add("i");
    add_number(digest, static_cast<std::uint64_t>(*integer));
  } else if (const auto* real = std::get_if<double>(&cell)) {
    digest.add("r");
    add_number(digest, std::bit_cast<std::uint64_t>(*real));
  } else if (const auto* text = std::get_if<std::string>(&cell)) {
    digest.add("t");
    add_number(digest, text->size());
    digest.add(*text);
  } else {
    digest.add("n");
  }
}

void add_rows(Digest& digest, SqliteStatement& rows) {
  while (rows.next()) {
    digest.add("row");
    for (int i = 0; i < rows.columns(); ++i) {
      add_cell(digest, rows.cell(i));
    }
  }
}

std::string sum_of_plan(SqliteConnection& connection) {
  Digest digest;
  const auto add = [&](const std::string& sql) {
    digest.add(sql);
    SqliteStatement rows(connection, sql);
    add_rows(digest, rows);
  };
  // Rows are read in the order of their table: an index could have another order.
  for (const std::string_view table : plan_tables) {
    add("SELECT * FROM " + std::string(table) + " NOT INDEXED");
  }
  add("SELECT * FROM store NOT INDEXED WHERE what <> 'checksum'");
  // What a user has added, an index or a view, does not matter.
  add("SELECT name, sql FROM sqlite_schema WHERE type IN ('table', 'view') AND (name = 'columns' OR "
      "name IN (SELECT \"table\" FROM columns)) ORDER BY name");
  return digest.hex();
}

}  // namespace

RowSums::RowSums(SqliteConnection& connection, Kind kind)
    : connection_(connection),
      kind_(kind),
      row_(connection, "SELECT * FROM " + std::string(sql_of(kind).table) + " WHERE " +
                           std::string(sql_of(kind).id) + " = ?"),
      parts_(connection, sql_of(kind).parts),
      seal_(connection, "UPDATE " + std::string(sql_of(kind).table) + " SET checksum = ? WHERE " +
                            std::string(sql_of(kind).id) + " = ?") {
  for (int i = 0; i < row_.columns(); ++i) {
    checksum_ = row_.column_name(i) == "checksum" ? i : checksum_;
  }
}

std::int64_t RowSums::sum_of(SqliteStatement& row) {
  Digest digest;
  for (int i = 0; i < row.columns(); ++i) {
    if (i != checksum_) {
      add_cell(digest, row.cell(i));
    }
  }
  parts_.bind(1, row.integer(0));
  add_rows(digest, parts_);
  parts_.reset();
  return static_cast<std::int64_t>(digest.folded());
}

void RowSums::seal(std::int64_t id) {
  sim::ensure(row_.bind(1, id).next(), "a row that has no checksum is not there");
  const std::int64_t sum = sum_of(row_);
  row_.reset();
  seal_.bind(1, sum).bind(2, id).run();
}

void RowSums::check(const std::filesystem::path& file) {
  const std::string table(sql_of(kind_).table);
  SqliteStatement rows(connection_, "SELECT * FROM " + table);
  while (rows.next()) {
    if (rows.cell(checksum_) != Cell(sum_of(rows))) {
      fail(file, "row " + std::to_string(rows.integer(0)) + " of its table " + table +
                     " is not what its checksum says");
    }
  }
}

void seal_plan(SqliteConnection& connection) {
  const std::string sum = sum_of_plan(connection);
  SqliteStatement(connection, "INSERT OR REPLACE INTO store VALUES ('checksum', ?)")
      .bind(1, std::string_view(sum))
      .run();
}

void check_whole(SqliteConnection& connection, const std::filesystem::path& file, std::int64_t format) {
  if (const Cell found = connection.value("PRAGMA integrity_check(1)"); found != Cell("ok")) {
    const auto* text = std::get_if<std::string>(&found);
    fail(file, text == nullptr ? "it cannot be checked" : *text);
  }
  if (format == 1) {
    return;
  }
  if (connection.value("SELECT value FROM store WHERE what = 'checksum'") != Cell(sum_of_plan(connection))) {
    fail(file, "its plan is not what its checksum says");
  }
  RowSums(connection, RowSums::Kind::machines).check(file);
  RowSums(connection, RowSums::Kind::frames).check(file);
}

}  // namespace marti::studies
