// How a machine comes by its tree.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace marti::processors::machine {

/// given: the whole tree is there when the frame begins and costs nothing. none: the whole tree is built
/// before the frame, and its time counts. shared: the initial tree is built before the frame; each node below
/// it is built once, by the processor that needs it first, in the memory of the cluster. private_trees: as
/// shared, but each processor node builds what it needs in its own memory.
enum class Sharing : std::uint8_t { given, none, shared, private_trees };
inline constexpr std::array<std::string_view, 4> sharing_names = {"given", "none", "shared", "private"};

/// Where the initial tree ends. level: nodes of `BuildConfig::level` are not split. full: all are. rule: the
/// initial tree ends at the first level n with L_n > k (B_n + P_n), L_n being the leaves of the level and B_n
/// + P_n its other nodes; the whole tree is built when there is no such level.
enum class InitialTree : std::uint8_t { level, full, rule };

struct BuildConfig {
  Sharing sharing = Sharing::given;
  InitialTree initial = InitialTree::rule;
  std::uint32_t level = 1;  ///< the root is level 1; at level 1 nothing is built beforehand
  double rule_k = 10.0;     ///< 3 is the worst case of the paper's theory, 10 what it recommends
};

}  // namespace marti::processors::machine
