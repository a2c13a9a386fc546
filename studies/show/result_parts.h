// The parts of a run's result, each as a field of `machine` in result.json, which
// docs/internals/result-json.md describes, and as lines of the summary. A part that this run has not is null
// in JSON and has no lines.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "studies/run/run_result.h"
#include "studies/tables/table.h"

namespace marti::studies::show {

/// The building of the tree.
[[nodiscard]] nlohmann::ordered_json build_json(const run::RunResult& result);
[[nodiscard]] std::string build_lines(const run::RunResult& result);

/// The second level of caches.
[[nodiscard]] nlohmann::ordered_json second_level_json(const run::RunResult& result);
[[nodiscard]] std::string second_level_line(const run::RunResult& result);

/// SIMT nodes.
[[nodiscard]] nlohmann::ordered_json simt_json(const run::RunResult& result);
[[nodiscard]] std::string simt_lines(const run::RunResult& result);

/// Bytes a second, of how many, and what the time of links and data buses is spent on: parts that add up to
/// the whole. Empty where there are no links or no messages.
[[nodiscard]] std::string interconnect_bandwidth_line(const run::RunResult& result);
[[nodiscard]] std::string network_bandwidth_line(const run::RunResult& result);
/// The memory must be one of DRAM.
[[nodiscard]] std::string dram_bandwidth_line(const run::RunResult& result);

/// Contexts and prefetching.
[[nodiscard]] nlohmann::ordered_json context_json(const run::RunResult& result);
[[nodiscard]] std::string context_lines(const run::RunResult& result);

/// The schemes in which rays move.
[[nodiscard]] nlohmann::ordered_json flow_json(const run::RunResult& result);
[[nodiscard]] std::string flow_lines(const run::RunResult& result);

/// Classes of misses, sharing of lines and attribution, which are counted on request.
[[nodiscard]] nlohmann::ordered_json counts_json(const run::RunResult& result);
[[nodiscard]] std::string counts_lines(const run::RunResult& result);
/// The table "attribution": a row for each cell that is not empty.
[[nodiscard]] tables::Table attribution_table(const std::vector<processors::walk::AttributionRow>& rows);

/// The misses of caches of other sizes and ways, from one pass over the run's references.
[[nodiscard]] nlohmann::ordered_json working_set_json(const run::RunResult& result);
[[nodiscard]] std::string working_set_lines(const run::RunResult& result);
/// The table "working_set": of each cache the fully associative sizes at which its misses change, thinned so
/// that neighbours differ by 1/256 of their size or more, with all powers of two; then all ways counted at
/// the machine's number of sets.
[[nodiscard]] tables::Table working_set_table(const processors::passes::WorkingSet& set);

/// The critical path.
[[nodiscard]] nlohmann::ordered_json critical_path_json(const run::RunResult& result);
[[nodiscard]] std::string critical_path_lines(const run::RunResult& result);

/// What the machine counted in each interval of the frame.
[[nodiscard]] nlohmann::ordered_json intervals_json(const run::RunResult& result);

/// What would make the frame shorter: the sentence, the next best steps, and how many were not replayed.
[[nodiscard]] nlohmann::ordered_json helps_json(const run::RunResult& result);
[[nodiscard]] std::string helps_lines(const run::RunResult& result);

/// Settings that nobody gave and that may not be what was meant: clocks that are left at their default beside
/// given ones that are more than four times as fast. Empty without any.
[[nodiscard]] nlohmann::ordered_json notes_json(const run::RunResult& result);
[[nodiscard]] std::string note_lines(const run::RunResult& result);

/// Bounds of the frame time and its prediction.
[[nodiscard]] nlohmann::ordered_json bounds_json(const run::RunResult& result);
[[nodiscard]] std::string bound_lines(const run::RunResult& result);

// What only the summary has as lines; the figures are in result.json.

/// Where the lost speed-up went; none on one node, or when the frame takes no time.
[[nodiscard]] std::string loss_lines(const run::RunResult& result);
/// Energy and power of the frame, its parts, the machine's area.
[[nodiscard]] std::string energy_lines(const run::RunResult& result);
/// What was recorded.
[[nodiscard]] std::string record_lines(const run::RunResult& result);

}  // namespace marti::studies::show
