// A second implementation of SIMT nodes, written from docs/internals/rt-unit.md for plainness: every node
// takes every cycle, step by step, with lists that are searched. Only the interconnect, the packets, the
// host, the layout and the prices of steps are the real ones.
#pragma once

#include "processors/replay/replay.h"

namespace marti::test {

/// The log's mailboxes must be off. Fills in all of the result but events, host bytes, counts, energy and
/// what is left out.
[[nodiscard]] processors::replay::MachineResult naive_simt(const processors::program::WorkLog& log,
                                                           const processors::machine::MachineConfig& config);

}  // namespace marti::test
