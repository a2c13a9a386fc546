// What a store holds, for reports. A store can be read while a sweep writes it: all that a reader sees is of
// the instant at which it was opened.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "studies/sweep/plan/question.h"
#include "studies/sweep/plan/sweep_row.h"
#include "studies/sweep/store/store_rows.h"
#include "studies/tables/sqlite_connection.h"
#include "studies/tables/table.h"

namespace marti::studies::sweep {

/// A point of the sweep's present plan. Machines are named by their ids in the store.
struct StoredPoint {
  std::int64_t ordinal = 0;  ///< from 0
  std::int64_t machine = 0;
  std::int64_t base = 0;
  double cost = 0.0;
  bool done = false;                 ///< its machine's result is there
  std::vector<tables::Cell> values;  ///< one for each of SweepReader::axes()
};

/// What would help a machine most, measured by replays of changed machines.
struct Advice {
  std::string sentence;  ///< for people, without a full stop
  /// The settings that make the step, each as for --set, between them "; ". Empty where nothing helps.
  std::string settings;
  std::optional<double> saves;  ///< share of the frame time that the step saves
  /// Share of the frame time by which frames of the machine differ with packets in other orders;
  /// std::nullopt: not measured.
  std::optional<double> noise{};
};

/// By what share of a frame time it changes for nothing that a machine is: what differs by less may be
/// chance.
struct Noise {
  double band = 0.0;      ///< 0 where none was measured
  bool of_seeds = false;  ///< by another seed of the image; else by another order of packets
  /// "another order of packets".
  [[nodiscard]] std::string_view cause() const {
    return of_seeds ? "another seed of the image" : "another order of packets";
  }
  [[nodiscard]] friend Noise larger(const Noise& a, const Noise& b) { return a.band < b.band ? b : a; }
};

/// False when the file is missing or empty, as a sweep that was killed at once leaves it.
[[nodiscard]] bool is_begun(const std::filesystem::path& store);

class SweepReader {
 public:
  /// Throws UserError when the file is missing, is not a store, or is of a format that this program does not
  /// read. A store of another version of the program can be read: counters that it lacks have no value.
  explicit SweepReader(const std::filesystem::path& file);

  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  /// The version of the program that wrote the store.
  [[nodiscard]] const std::string& version() const { return version_; }
  [[nodiscard]] const std::vector<std::string>& axes() const { return axes_; }
  [[nodiscard]] std::vector<StoredPoint> points() const;
  [[nodiscard]] std::size_t point_count() const;
  /// The machine that all are compared with.
  [[nodiscard]] std::optional<std::int64_t> compare() const;

  /// std::nullopt when the machine has not been timed yet.
  [[nodiscard]] std::optional<SweepRow> read_result(std::int64_t machine) const;
  /// The row of the frame that a machine is timed on; std::nullopt when it has not been traced yet.
  [[nodiscard]] std::optional<FrameRow> read_frame(std::int64_t machine) const;
  /// Keys and values of a machine and of its frame, sorted by key.
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> settings(std::int64_t machine) const;

  /// What the sweep asks; its places are those of the configuration that gave it.
  [[nodiscard]] Question question() const;

  /// By the ids of machines: of the fastest and others that no other beats, once the sweep has ended.
  [[nodiscard]] std::map<std::int64_t, Advice> advice() const;
  /// Where image.seed is an axis: the most by which points differ that differ in nothing else, as a share of
  /// the shortest of their frame times. Else none.
  [[nodiscard]] Noise noise_of_seeds() const;
  /// The largest noise: of seeds, and of the machines that have advice.
  [[nodiscard]] Noise noise() const;

  /// The names of all figures of a point: axes, cost, what is derived (view summary), and all counters.
  [[nodiscard]] const std::vector<std::string>& figures() const { return figures_; }
  /// Calls `visit` for each point of the plan in order, with the figures of these names; a figure has no
  /// value where the machine has no such part, has not been timed yet, or the denominator is 0. Throws
  /// UserError for an unknown name, with the nearest known one.
  void for_each_point(
      std::span<const std::string> names,
      const std::function<void(const StoredPoint&, std::span<const tables::Cell>)>& visit) const;

 private:
  // Reading moves SQLite's cursors.
  mutable tables::SqliteConnection connection_;
  mutable std::optional<RowReader> rows_;  // made once the tables are known to exist
  mutable std::optional<tables::SqliteStatement> settings_;
  std::filesystem::path file_;
  std::string version_;
  std::vector<std::string> axes_;
  std::vector<std::string> figures_;
  std::size_t summary_figures_ = 0;  // so many of `figures_`, from the first
};

}  // namespace marti::studies::sweep
