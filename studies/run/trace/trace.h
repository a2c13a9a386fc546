// `marti trace`: what nodes refer to, or ask of the memory, as files for other simulators.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "sim/config.h"

namespace marti::studies::run {

struct TraceOptions {
  std::string format = "din";  ///< one of trace_formats()
  bool references = false;     ///< what nodes refer to, and not what they ask of the memory
  std::string nodes;           ///< "0-3", "5", "0,2,8-9"; empty: all
  std::uint64_t most_bytes = std::uint64_t{4} << 30U;  ///< of all files together
};

/// The names of request_formats().
[[nodiscard]] std::vector<std::string> trace_formats();

/// Runs the configuration's machine once and writes the files of a format (request_format.h) to `directory`,
/// which must exist: what nodes ask of the memory, in the order of time, or, where that is asked for, a file
/// of each node with what it refers to, before its caches, and writes, in the order of its time. "din" (M. D.
/// Hill, Dinero III; J. Edler, M. D. Hill, Dinero IV) always has the latter, as node-00000.din and so on.
/// trace.json beside them says which machine they are of, and names them (studies/tables/file_set.h). Traces
/// of the same machine that it names already stay, those of another are removed. Returns what to tell the
/// user. Throws UserError, and changes nothing, for nodes that are not there, for a directory with another
/// result or with traces that trace.json does not name or that were changed, and when the files would be
/// longer than allowed or cannot be written.
[[nodiscard]] std::string write_traces(sim::Config& config, const TraceOptions& options,
                                       const std::filesystem::path& directory);

}  // namespace marti::studies::run
