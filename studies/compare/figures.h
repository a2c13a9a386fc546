// The figures of two results beside each other, and where their cycles went.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "studies/sweep/store/sweep_reader.h"
#include "studies/tables/table.h"

namespace marti::studies::compare {

/// By the names of the catalogue (`marti figures`), those of the frame behind "frame."; without those that
/// say how the program worked. A figure is an integer, a real or a text (a hash, the scene's name).
using Figures = std::map<std::string, tables::Cell>;

struct ComparedResult {
  std::string name;                             ///< as on the command line
  std::string version;                          ///< of the program that made it
  std::map<std::string, std::string> settings;  ///< values as in a TOML file
  Figures figures;
  std::string scene_hash;       ///< empty where it is not recorded: a run does not
  std::optional<double> noise;  ///< share of its frame time that another order of packets changes, if known
  std::string helps;  ///< what would make its frame shorter, in a sentence; empty where it is not recorded
};

/// A `result.json`. Throws UserError for a file that cannot be read, is not a result, or is one of another
/// schema.
[[nodiscard]] ComparedResult read_run(const std::filesystem::path& file, const std::string& name);

/// A point of a sweep. Throws UserError when it has not been run yet, or there is no such point.
[[nodiscard]] ComparedResult read_point(const sweep::SweepReader& sweep, std::int64_t ordinal,
                                        const std::string& name);

/// The counted figures of a row.
void add_counters(const sweep::SweepRow& row, Figures& figures);

/// The frame: its figures as those of a result are named, and the scene's hash.
void add_frame(const sweep::FrameRow& row, ComparedResult& result);

/// Removes what cannot be compared with a sweep: figures that are measured against another machine, which a
/// run and a sweep do not choose alike, and settings that a sweep does not keep, because no result depends on
/// them.
void keep_what_sweeps_have(ComparedResult& result);

/// The value of an integer figure; std::nullopt when the result has no such figure.
[[nodiscard]] std::optional<std::int64_t> integer_figure(const ComparedResult& result,
                                                         const std::string& name);

/// The frame time in ps; std::nullopt when the result has none above 0.
[[nodiscard]] std::optional<std::int64_t> frame_time_if_any(const ComparedResult& result);
/// The frame time in ps. Throws UserError when the result has none above 0.
[[nodiscard]] std::int64_t frame_time(const ComparedResult& result);

/// The unit of a compared figure by the catalogue; empty for a text and for a figure that it does not have.
[[nodiscard]] std::string unit_of_figure(std::string_view name);
/// What the catalogue says of it.
[[nodiscard]] std::string meaning_of_figure(std::string_view name);

/// The time of a machine's nodes in one activity. A mean of a node is the nodes' time by their number.
struct ActivityTime {
  std::string activity;
  tables::Cell a;           ///< of all nodes of A, ps
  tables::Cell b;           ///< of all nodes of B, ps
  std::int64_t mean_a = 0;  ///< of a node, rounded to ps
  std::int64_t mean_b = 0;
  double change = 0.0;  ///< of the mean, ps, before rounding
};

/// The largest change first, then by the order of the activities. Activities in which neither spends time
/// are left out. Empty when a result lacks the times or the number of its nodes, or their sum is not the
/// frame time (somebody has changed the file).
[[nodiscard]] std::vector<ActivityTime> activity_times(const ComparedResult& a, const ComparedResult& b);

}  // namespace marti::studies::compare
