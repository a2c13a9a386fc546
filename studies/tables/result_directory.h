// The directories in which results are kept: that of a run has a result.json, that of a sweep or a study a
// results.sqlite, that of traces a trace.json.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace marti::studies::tables {

/// The file of a run in its directory.
inline constexpr const char* run_name = "result.json";
/// The file of a sweep or study in its directory.
inline constexpr const char* database_name = "results.sqlite";
/// The file of the finished parts of a study that is not (sim/finished_parts.h), in its directory.
inline constexpr const char* unfinished_name = "unfinished.parts";
/// The file that names the traces of `marti trace` beside it, and the machine that they are of.
inline constexpr const char* trace_name = "trace.json";
/// The page of `marti report`, if no other name is asked for.
inline constexpr const char* report_page_name = "report.html";

/// Whether a file or a link of this name exists, even a link to nothing. UserError when that cannot be told.
[[nodiscard]] bool is_there(const std::filesystem::path& file);

/// UserError when the directory holds another of the three than `own`: nobody could tell later which of them
/// is meant. An empty name holds nothing.
void refuse_other_results(const std::filesystem::path& directory, std::string_view own);

/// The result.json or results.sqlite of the directory. UserError when it holds both, or neither: `expected`
/// says what it should be then.
[[nodiscard]] std::filesystem::path results_in(const std::filesystem::path& directory,
                                               std::string_view expected);

/// A point of a sweep as it is named on the command line.
struct PointName {
  std::string name;  ///< as typed
  std::filesystem::path store;
  std::int64_t ordinal = 0;
};
/// "DIR:N" or "DIR/results.sqlite:N", where DIR is there; std::nullopt for another name.
[[nodiscard]] std::optional<PointName> point_named(const std::string& name);

}  // namespace marti::studies::tables
