// What memories by themselves have done, as tables: those that are printed, and those of which the charts of
// studies/tables/charts/memory_*.vl.json are made.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "studies/driven/served.h"
#include "studies/tables/table.h"

namespace marti::studies::driven {

/// One memory, with what its axes give it.
struct Memory {
  std::vector<std::pair<std::string, std::string>> settings;  ///< key and value; empty without axes
  Served served;

  /// "cache.size = 16 KiB, ..."; of a memory without axes "the memory".
  [[nodiscard]] std::string name() const;
};

/// "memories": a row for each, with its settings. Neither this nor the next has a column that no memory
/// needs.
[[nodiscard]] tables::Table memories_table(std::span<const Memory> memories);

/// "memory_answer" with these sentences, memories_table(), and in long form what charts show: figures over
/// the first axis, and of the few memories whose reads are fastest the latencies of reads, what links and
/// data buses do, in which state rows are found, who waits in which queue, and the parts of the energy.
/// Tables without rows are left out.
[[nodiscard]] std::vector<tables::Table> page_tables(std::span<const Memory> memories,
                                                     std::span<const std::string> answer);

}  // namespace marti::studies::driven
