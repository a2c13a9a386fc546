// The pieces of work that a critical path consists of.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "processors/walk/cause_observer.h"
#include "sim/time.h"

namespace marti::processors::path {

/// What is done in a piece. Those up to messaging are the activities of these names.
enum class PathKind : std::uint8_t {
  traversal,
  intersection,
  shading,
  building,
  cache_access,
  switching,
  messaging,
  own_memory,    ///< a node's reads and writes of a memory that no other node uses
  transfer,      ///< over the bus, crossbar, ideal interconnect or network, and the beats of a home's memory
  network,       ///< a ray, or what it adds to its pixel, on its way between nodes or to or from the host
  shared_cache,  ///< hits in the cache before the banks
  bank_access,   ///< a bank or a home's memory at work for an access, until it can begin the next one
  dispatch,      ///< the host at work for a node's request, or until it can send the next camera ray
};
inline constexpr std::size_t path_kinds = 13;
inline constexpr std::array<std::string_view, path_kinds> path_kind_names = {
    "traversal",  "intersection", "shading", "building",     "cache_access", "switching", "messaging",
    "own_memory", "transfer",     "network", "shared_cache", "bank_access",  "dispatch"};
/// Whether a node does this by itself.
[[nodiscard]] constexpr bool is_own_work(PathKind kind) { return kind <= PathKind::own_memory; }

/// For whom a piece is done.
struct PathOwner {
  std::uint32_t node = 0;
  walk::LogPlace place;  ///< what the node had come to when it began, or asked for, the piece
};

/// A piece as it is read back.
struct PathPiece {
  sim::Ticks from = 0;
  sim::Ticks to = 0;
  PathOwner owner;
  PathKind kind = PathKind::traversal;

  /// Whether this piece goes on with what `before`, the piece before it, does: for the same node, both the
  /// node's own work or both of one kind.
  [[nodiscard]] bool goes_on_from(const PathPiece& before) const {
    return owner.node == before.owner.node &&
           (kind == before.kind || (is_own_work(kind) && is_own_work(before.kind)));
  }
};

}  // namespace marti::processors::path
