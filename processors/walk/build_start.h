// Which parts of a tree exist when the frame begins: each branch is kept from before, split before the frame,
// or left to the node that needs it first.
#pragma once

#include <cstdint>
#include <vector>

#include "accel/topology.h"
#include "processors/machine/build_config.h"

namespace marti::processors::walk {

/// kept: its children exist and cost nothing. eager: it is split before the frame, and the time counts. lazy:
/// it is a P node, a list of primitives, until some node needs its children.
enum class BranchStart : std::uint8_t { kept, eager, lazy };

/// One entry for each node of the tree, without meaning for leaves. With a given tree all branches are kept.
/// Throws UserError, naming build.sharing, for a structure that is not built by splitting nodes.
[[nodiscard]] std::vector<BranchStart> branch_starts(const accel::Topology& topology,
                                                     const machine::BuildConfig& config);

/// The deepest level whose nodes the initial tree holds; branches on that level are P nodes. When the whole
/// tree is initial: one more than the number of levels.
[[nodiscard]] std::uint32_t initial_level(const accel::Topology& topology,
                                          const machine::BuildConfig& config);

/// Throws UserError unless `starts` fits the tree: one entry a node, and only lazy branches below a lazy one.
/// Also throws when something is to be built and the topology lacks the work that splitting takes.
void check_starts(const accel::Topology& topology, const std::vector<BranchStart>& starts);

}  // namespace marti::processors::walk
