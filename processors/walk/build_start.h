// What of a tree is there when the frame begins: for each branch whether it is kept from before, split
// beforehand, or left to whoever needs it first.
#pragma once

#include <cstdint>
#include <vector>

#include "accel/topology.h"
#include "processors/machine/build_config.h"

namespace marti::processors {

/// kept: its children are there and cost nothing. eager: it is split before the frame, and paid. lazy: it is
/// a P node, a list of primitives, until somebody needs its children.
enum class BranchStart : std::uint8_t { kept, eager, lazy };

/// One entry for each node of the tree; those of leaves say nothing. All branches are kept when the tree is
/// given. Throws UserError, naming build.sharing, for a structure that is not built by splitting nodes.
[[nodiscard]] std::vector<BranchStart> branch_starts(const accel::Topology& topology,
                                                     const BuildConfig& config);

/// The deepest level whose nodes the initial tree holds: its branches of that level are P nodes. One level
/// more than the tree has when the whole tree is initial.
[[nodiscard]] std::uint32_t initial_level(const accel::Topology& topology, const BuildConfig& config);

/// Throws UserError unless `starts` fits the tree: one entry a node, and below a lazy branch only lazy ones.
/// Throws it too when something is to be built and the topology does not say what splitting takes.
void check_starts(const accel::Topology& topology, const std::vector<BranchStart>& starts);

}  // namespace marti::processors
