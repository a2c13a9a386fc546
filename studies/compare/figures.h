// What of a result is compared: settings and figures by name.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "studies/sweep/store/sweep_reader.h"
#include "studies/tables/table.h"

namespace marti::studies {

/// By name. A figure is an integer, a real or a text (a hash, a kind).
using Figures = std::map<std::string, Cell>;

struct ComparedResult {
  std::string name;                             ///< as on the command line
  std::string version;                          ///< of the program that made it
  std::map<std::string, std::string> settings;  ///< values as in a TOML file
  Figures figures;
};

/// A `result.json`. Its figures have the names of its fields, joined by dots; over the objects of a list
/// counters are summed, of peaks the largest is taken, and the list's name has "[]" behind it. Histograms are
/// left out. Throws UserError for a file that cannot be read, is not a result, or is one of another schema.
[[nodiscard]] ComparedResult read_run(const std::filesystem::path& file, const std::string& name);

/// A point of a sweep: the counters of its machine, and those of its frame behind "frame.". Throws UserError
/// when it has not been run yet, or there is no such point.
[[nodiscard]] ComparedResult read_point(const SweepReader& sweep, std::int64_t ordinal,
                                        const std::string& name);

/// The counters of a row, with the names that read_point gives them.
void add_counters(const SweepRow& row, Figures& figures);

/// The figures of a run that a point of a sweep has too, under the names they have there.
[[nodiscard]] Figures named_as_in_sweep(const Figures& run);

}  // namespace marti::studies
