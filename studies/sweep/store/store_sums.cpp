#include "studies/sweep/store/store_sums.h"

#include <fmt/format.h>

#include <bit>
#include <string>
#include <string_view>

#include "sim/error.h"
#include "studies/sweep/plan/digest.h"
#include "studies/sweep/store/store_schema.h"

namespace marti::studies::sweep {

namespace {

// In the order in which they were made. Table `store` is left to the end, as it holds the checksum.
constexpr std::string_view plan_tables[] = {"provenance", "columns",        "settings", "sections",
                                            "frames",     "frame_sections", "machines", "machine_sections",
                                            "points",     "compare",        "question"};

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what) {
  throw sim::UserError(file.string() + ": is damaged: " + what +
                       "; take a copy that is whole, or remove the file and run the sweep again");
}

// A letter for its type, and its value.
void add_cell(ByteWriter& bytes, const tables::Cell& cell) {
  if (const auto* integer = std::get_if<std::int64_t>(&cell)) {
    bytes.write('i', *integer);
  } else if (const auto* real = std::get_if<double>(&cell)) {
    bytes.write('r', std::bit_cast<std::uint64_t>(*real));
  } else if (const auto* text = std::get_if<std::string>(&cell)) {
    bytes.write('t', *text);
  } else {
    bytes.write('n');
  }
}

void add_rows(Digest& digest, tables::SqliteStatement& rows) {
  ByteWriter bytes;
  while (rows.next()) {
    bytes.write('r', 'o', 'w');
    for (int i = 0; i < rows.columns(); ++i) {
      add_cell(bytes, rows.cell(i));
    }
    digest.add(bytes.take());
  }
}

std::string sum_of_plan(tables::SqliteConnection& connection) {
  Digest digest;
  const auto add = [&](const std::string& sql) {
    digest.add(sql);
    tables::SqliteStatement rows(connection, sql);
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

RowSums::RowSums(tables::SqliteConnection& connection, const ResultTable& table)
    : connection_(connection),
      table_(table),
      row_(connection, fmt::format("SELECT * FROM {} WHERE {} = ?", table.name, table.id)),
      seal_(connection, fmt::format("UPDATE {} SET checksum = ? WHERE {} = ?", table.name, table.id)) {
  for (int i = 0; i < row_.columns(); ++i) {
    checksum_ = row_.column_name(i) == "checksum" ? i : checksum_;
  }
  if (!table.part.empty()) {
    part_.emplace(connection, std::string(table.part));
  }
}

tables::Cell RowSums::sum_of(const tables::SqliteStatement& row) {
  ByteWriter bytes;
  for (int i = 0; i < row.columns(); ++i) {
    if (i != checksum_) {
      add_cell(bytes, row.cell(i));
    }
  }
  Digest digest;
  digest.add(bytes.take());
  if (part_) {
    add_rows(digest, part_->with({row.cell(0)}));
  }
  return static_cast<std::int64_t>(digest.folded());
}

void RowSums::seal(std::int64_t id) {
  sim::ensure(row_.with({id}).next(), "a row that has no checksum is not there");
  const tables::Cell sum = sum_of(row_);
  row_.reset();
  seal_.run({sum, id});
}

void RowSums::check(const std::filesystem::path& file) {
  tables::SqliteStatement rows(connection_, fmt::format("SELECT * FROM {}", table_.name));
  while (rows.next()) {
    if (checksum_ < 0 || rows.cell(checksum_) != sum_of(rows)) {
      fail(file,
           fmt::format("row {} of its table {} does not match its checksum", rows.integer(0), table_.name));
    }
  }
}

void seal_plan(tables::SqliteConnection& connection) {
  tables::SqliteStatement(connection, "INSERT OR REPLACE INTO store VALUES ('checksum', ?)")
      .run({sum_of_plan(connection)});
}

void check_whole(tables::SqliteConnection& connection, const std::filesystem::path& file) {
  if (const auto found = connection.value<std::string>("PRAGMA integrity_check(1)"); found != "ok") {
    fail(file, found.value_or("it cannot be checked"));
  }
  if (value_of(connection, "checksum") != sum_of_plan(connection)) {
    fail(file, "its plan does not match its checksum");
  }
  RowSums(connection, machine_results).check(file);
  RowSums(connection, frame_results).check(file);
  RowSums(connection, advice_rows).check(file);
}

}  // namespace marti::studies::sweep
