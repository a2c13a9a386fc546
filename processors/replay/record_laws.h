// The laws that tie the records which rays read to lines and to bytes.
#pragma once

#include "processors/replay/replay.h"

namespace marti::processors::replay {

/// Throws InternalError unless the lines looked up of each kind (without a cache: parts of records read) are
/// as many as its records have at least, and, in a tree that is given, at most; and unless, in such a tree,
/// an interconnect moved the bytes of these lines or records, and those of the pixels.
void check_records(const program::WorkLog& log, const machine::MachineConfig& config,
                   const MachineResult& result);

}  // namespace marti::processors::replay
