#include "studies/sweep/store/store_rows.h"

#include <algorithm>
#include <iterator>
#include <string>

#include "sim/error.h"
#include "studies/sweep/store/store_schema.h"

namespace marti::studies::sweep {

namespace {

// Columns are found by their names: another version may have had others.
std::vector<int> places_of(const tables::SqliteStatement& row,
                           std::span<const figures::FigureEntry> columns) {
  const std::vector<std::string> names = row.column_names();
  std::vector<int> places;
  for (const figures::FigureEntry& column : columns) {
    const auto at = std::ranges::find(names, column.name);
    places.push_back(at == names.end() ? -1 : static_cast<int>(at - names.begin()));
  }
  return places;
}

// A sum over nodes that does not fit in 64 bits is a real.
std::optional<figures::Count> count_at(const tables::SqliteStatement& row, int place) {
  const tables::Cell cell = row.cell(place);
  const auto* const real = std::get_if<double>(&cell);
  if (real != nullptr && *real >= 0x1p63 && *real <= figures::largest_count) {
    return static_cast<figures::Count>(*real);
  }
  return row.get<std::int64_t>(place);
}

figures::Counts counters_at(const tables::SqliteStatement& row, const std::vector<int>& places) {
  figures::Counts counters;
  counters.reserve(places.size());
  for (const int place : places) {
    counters.push_back(place < 0 ? std::nullopt : count_at(row, place));
  }
  return counters;
}

const tables::Cell no_checksum_yet;

// In the table of intervals.
constexpr std::size_t first_interval_counter = 4 + processors::walk::node_states;

}  // namespace

RowWriter::RowWriter(tables::SqliteConnection& connection)
    : result_(connection,
              tables::insert_sql("results", figures::counted_figures().size() + first_result_counter)),
      interval_(connection,
                tables::insert_sql("intervals", first_interval_counter + run::counted_in_intervals().size())),
      frame_(connection,
             tables::insert_sql("frame_results", run::frame_figures().size() + first_frame_counter)),
      note_(connection, tables::insert_sql("frame_notes", 3)),
      machine_sums_(connection, machine_results),
      frame_sums_(connection, frame_results) {}

void RowWriter::add(std::int64_t machine, const SweepRow& row) {
  sim::ensure(row.counters.size() == figures::counted_figures().size(),
              "a row has another number of counters");
  std::vector<tables::Cell> cells = {machine, no_checksum_yet};
  for (const std::string& histogram : row.histograms) {
    cells.push_back(histogram.empty() ? tables::Cell() : tables::Cell(histogram));
  }
  cells.insert(cells.end(), row.counters.begin(), row.counters.end());
  result_.run(cells);
  for (std::size_t ordinal = 0; ordinal < row.intervals.size(); ++ordinal) {
    const run::IntervalRow& interval = row.intervals[ordinal];
    std::vector<tables::Cell> own = {machine, ordinal, interval.from, interval.to};
    own.insert(own.end(), interval.spent.begin(), interval.spent.end());
    for (const std::size_t place : run::counted_in_intervals()) {
      own.emplace_back(interval.counts[place]);
    }
    interval_.run(own);
  }
  machine_sums_.seal(machine);
}

void RowWriter::add(std::int64_t frame, const FrameRow& row) {
  sim::ensure(row.counters.size() == run::frame_figures().size(),
              "a frame's row has another number of counters");
  std::vector<tables::Cell> cells = {frame,          row.scene,    row.scene_hash,
                                     row.image_hash, row.hit_hash, no_checksum_yet};
  cells.insert(cells.end(), row.counters.begin(), row.counters.end());
  frame_.run(cells);
  std::int64_t ordinal = 0;
  for (const std::string& note : row.notes) {
    note_.run({frame, ordinal++, note});
  }
  frame_sums_.seal(frame);
}

RowReader::RowReader(tables::SqliteConnection& connection)
    : result_(connection, "SELECT * FROM results WHERE machine = ?"),
      intervals_(connection, "SELECT * FROM intervals WHERE machine = ? ORDER BY ordinal"),
      frame_(connection, "SELECT * FROM frame_results WHERE frame = ?"),
      notes_(connection, "SELECT note FROM frame_notes WHERE frame = ? ORDER BY ordinal"),
      result_places_(places_of(result_, figures::counted_figures())),
      interval_places_(places_of(intervals_, figures::counted_figures())),
      frame_places_(places_of(frame_, run::frame_figures())) {}

std::optional<SweepRow> RowReader::find_machine(std::int64_t machine) {
  if (!result_.with({machine}).next()) {
    return std::nullopt;
  }
  SweepRow row;
  row.counters = counters_at(result_, result_places_);
  for (std::size_t i = 0; i < row.histograms.size(); ++i) {
    const tables::Cell cell =
        result_.cell(static_cast<int>(first_result_counter - row.histograms.size() + i));
    const auto* const text = std::get_if<std::string>(&cell);
    row.histograms[i] = text == nullptr ? std::string() : *text;
  }
  result_.reset();
  intervals_.with({machine});
  while (intervals_.next()) {
    run::IntervalRow& interval = row.intervals.emplace_back();
    interval.from = intervals_.integer(2);
    interval.to = intervals_.integer(3);
    for (std::size_t state = 0; state < interval.spent.size(); ++state) {
      interval.spent[state] =
          count_at(intervals_, static_cast<int>(first_interval_counter - interval.spent.size() + state))
              .value_or(0);
    }
    interval.counts = counters_at(intervals_, interval_places_);
  }
  return row;
}

std::optional<FrameRow> RowReader::find_frame(std::int64_t frame) {
  if (!frame_.with({frame}).next()) {
    return std::nullopt;
  }
  FrameRow row{
      counters_at(frame_, frame_places_), frame_.text(1), frame_.text(2), frame_.text(3), frame_.text(4), {}};
  frame_.reset();
  notes_.with({frame});
  while (notes_.next()) {
    row.notes.push_back(notes_.text(0));
  }
  return row;
}

}  // namespace marti::studies::sweep
