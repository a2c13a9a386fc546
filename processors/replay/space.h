// The space scheme: each node holds a part of space in its own memory, and rays go to the node whose part
// they enter. After Dippé, Swensen, An adaptive subdivision algorithm and parallel architecture for realistic
// image synthesis (SIGGRAPH 1984), and Cleary, Wyvill, Birtwistle, Vatti, Multiprocessor ray tracing (CGF
// 5(1), 1986).
//
// A ray is a message. A node takes the ray's steps until the next one reads a tree node that another node
// holds; the ray is then sent there. Branches above the regions are read wherever the ray is. A node first
// takes the rays made at its hit points, those of the last point first, then those of its queue in the order
// of arrival. What rays add to a pixel is sent to the host, so no node waits for a reply.
//
// Deadlock is impossible: a ray for which the next node has no room is set aside in the memory of the node
// where it is, so no node waits while it holds a ray (docs/internals/space.md).
#pragma once

#include "processors/replay/replay.h"

namespace marti::processors::replay {

/// Times `config`, whose scheme is space, on `log`. A node reads its part through its cache, if it has one,
/// from memory of its own (MachineConfig::local); MachineConfig::placement (which must not be distributed),
/// interconnect and banks have no effect. Deterministic; throws as replay() does.
[[nodiscard]] MachineResult replay_space(const program::WorkLog& log, const machine::MachineConfig& config,
                                         const ReplayOptions& options = {});

/// The host sends a camera ray into a cluster only while fewer than this many rays are in flight there.
[[nodiscard]] std::uint32_t admission_limit(const machine::MachineConfig& config);

}  // namespace marti::processors::replay
