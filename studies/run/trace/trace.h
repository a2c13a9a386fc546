// `marti trace`: what nodes refer to, or ask of the memory, as files for other simulators.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "sim/config.h"

namespace marti::studies::run {

struct TraceOptions {
  std::string format = "din";                          ///< one of trace_formats()
  std::string nodes;                                   ///< "0-3", "5", "0,2,8-9"; empty: all
  std::uint64_t most_bytes = std::uint64_t{4} << 30U;  ///< of all files together
};

/// "din" and the names of request_formats().
[[nodiscard]] std::vector<std::string> trace_formats();

/// Runs the configuration's machine once and writes node-00000.din and so on, or the file of another format
/// (request_format.h), to `directory`, which must exist. "din" has the references of the nodes, before their
/// caches, without times; a line is
///     label address kind
/// in the traditional din format (M. D. Hill, Dinero III; J. Edler, M. D. Hill, Dinero IV): label 0 for a
/// read, 1 for a write; the address in hexadecimal digits; the kind of record, which such readers skip.
/// trace.json beside them says which machine they are of, and names them (studies/tables/file_set.h). Traces
/// of the same machine that it names already stay, those of another are removed. Returns what to tell the
/// user. Throws UserError, and changes nothing, for "din" of a machine whose nodes have no references of
/// their own (another scheme than `image`, a tree that is built), for nodes that are not there, for a
/// directory with another result or with traces that trace.json does not name or that were changed, and when
/// the files would be longer than allowed or cannot be written.
[[nodiscard]] std::string write_traces(sim::Config& config, const TraceOptions& options,
                                       const std::filesystem::path& directory);

}  // namespace marti::studies::run
