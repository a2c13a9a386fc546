#include "studies/sweep/store/store_rows.h"

#include <algorithm>
#include <map>
#include <string>

#include "sim/error.h"
#include "sim/statistics.h"
#include "studies/sweep/store/store_schema.h"

namespace marti::studies {

namespace {

using Counters = std::vector<std::optional<std::int64_t>>;

std::string insert_sql(const std::string& table, std::size_t columns) {
  std::string sql = "INSERT INTO " + table + " VALUES (?";
  for (std::size_t i = 1; i < columns; ++i) {
    sql += ", ?";
  }
  return sql + ")";
}

// Columns are found by their names: another version may have had others.
std::vector<int> places_of(const SqliteStatement& row, std::span<const Column> columns) {
  std::map<std::string, int> named;
  for (int i = 0; i < row.columns(); ++i) {
    named[row.column_name(i)] = i;
  }
  std::vector<int> places;
  for (const Column& column : columns) {
    const auto at = named.find(column.name);
    places.push_back(at == named.end() ? -1 : at->second);
  }
  return places;
}

Counters counters_at(const SqliteStatement& row, const std::vector<int>& places) {
  Counters counters;
  counters.reserve(places.size());
  for (const int place : places) {
    counters.push_back(place < 0 ? std::nullopt : row.optional_integer(place));
  }
  return counters;
}

// Whether the bounds of a bucket are those that a log-scaled histogram gives it.
bool is_usual(const SweepHistogram::Bucket& bucket) {
  const std::size_t number = sim::LogHistogram::bucket_of(bucket.lowest);
  return sim::LogHistogram::lowest_of(number) == bucket.lowest &&
         sim::LogHistogram::highest_of(number) == bucket.highest;
}

}  // namespace

RowWriter::RowWriter(SqliteConnection& connection)
    : has_machine_(connection, "SELECT 1 FROM results WHERE machine = ?"),
      has_frame_(connection, "SELECT 1 FROM frame_results WHERE frame = ?"),
      result_(connection, insert_sql("results", sweep_columns().size() + first_result_counter)),
      bucket_(connection, "INSERT INTO wait_buckets VALUES (?, ?, ?, ?, ?)"),
      frame_(connection, insert_sql("frame_results", frame_columns().size() + first_frame_counter)),
      note_(connection, "INSERT INTO frame_notes VALUES (?, ?, ?)"),
      machine_sums_(connection, RowSums::Kind::machines),
      frame_sums_(connection, RowSums::Kind::frames) {}

bool RowWriter::there(SqliteStatement& statement, std::int64_t id) {
  const bool found = statement.bind(1, id).next();
  statement.reset();
  return found;
}

void RowWriter::add(std::int64_t machine, const SweepRow& row) {
  sim::ensure(row.counters.size() == sweep_columns().size(), "a row has another number of counters");
  result_.bind(1, machine);
  for (std::size_t i = 0; i < row.counters.size(); ++i) {
    result_.bind(first_result_counter + 1 + static_cast<int>(i), row.counters[i]);
  }
  result_.run();
  const auto names = sweep_histogram_names();
  for (const SweepHistogram& histogram : row.histograms) {
    const auto name = std::find(names.begin(), names.end(), histogram.what);
    sim::ensure(name != names.end(), "a row has an unknown histogram");
    bucket_.bind(1, machine).bind(2, std::int64_t{name - names.begin()});
    for (const SweepHistogram::Bucket& bucket : histogram.buckets) {
      bucket_.bind(3, bucket.lowest);
      bucket_.bind(4, is_usual(bucket) ? std::nullopt : std::optional(bucket.highest));
      bucket_.bind(5, bucket.count).run();
    }
  }
  machine_sums_.seal(machine);
}

void RowWriter::add(std::int64_t frame, const FrameRow& row) {
  sim::ensure(row.counters.size() == frame_columns().size(), "a frame's row has another number of counters");
  frame_.bind(1, frame).bind(2, std::string_view(row.scene)).bind(3, std::string_view(row.scene_hash));
  frame_.bind(4, std::string_view(row.image_hash)).bind(5, std::string_view(row.hit_hash));
  for (std::size_t i = 0; i < row.counters.size(); ++i) {
    frame_.bind(first_frame_counter + 1 + static_cast<int>(i), row.counters[i]);
  }
  frame_.run();
  for (std::size_t i = 0; i < row.notes.size(); ++i) {
    note_.bind(1, frame).bind(2, static_cast<std::int64_t>(i)).bind(3, std::string_view(row.notes[i])).run();
  }
  frame_sums_.seal(frame);
}

RowReader::RowReader(SqliteConnection& connection)
    : result_(connection, "SELECT * FROM results WHERE machine = ?"),
      buckets_(connection,
               "SELECT w.name, h.lowest, COALESCE(h.highest, b.highest), h.count FROM wait_buckets h "
               "JOIN waits w ON w.id = h.wait LEFT JOIN buckets b ON b.lowest = h.lowest "
               "WHERE h.machine = ? ORDER BY h.wait, h.lowest"),
      frame_(connection, "SELECT * FROM frame_results WHERE frame = ?"),
      notes_(connection, "SELECT note FROM frame_notes WHERE frame = ? ORDER BY ordinal"),
      result_places_(places_of(result_, sweep_columns())),
      frame_places_(places_of(frame_, frame_columns())) {}

std::optional<SweepRow> RowReader::find_machine(std::int64_t machine) {
  result_.reset();
  if (!result_.bind(1, machine).next()) {
    return std::nullopt;
  }
  SweepRow row;
  row.counters = counters_at(result_, result_places_);
  result_.reset();
  buckets_.reset();
  buckets_.bind(1, machine);
  while (buckets_.next()) {
    const std::string what = buckets_.text(0);
    if (row.histograms.empty() || row.histograms.back().what != what) {
      row.histograms.push_back({what, {}});
    }
    row.histograms.back().buckets.push_back({buckets_.integer(1), buckets_.integer(2), buckets_.integer(3)});
  }
  buckets_.reset();
  return row;
}

std::optional<FrameRow> RowReader::find_frame(std::int64_t frame) {
  frame_.reset();
  if (!frame_.bind(1, frame).next()) {
    return std::nullopt;
  }
  FrameRow row;
  row.scene = frame_.text(1);
  row.scene_hash = frame_.text(2);
  row.image_hash = frame_.text(3);
  row.hit_hash = frame_.text(4);
  row.counters = counters_at(frame_, frame_places_);
  frame_.reset();
  notes_.reset();
  notes_.bind(1, frame);
  while (notes_.next()) {
    row.notes.push_back(notes_.text(0));
  }
  notes_.reset();
  return row;
}

}  // namespace marti::studies
