// What it takes at least to have a bounding volume hierarchy before a frame begins: to build it as
// accel/bvh_build.h does, or to fit its boxes anew. The program is one that all nodes of a cluster run
// together, and nothing is lost by sharing it: no node waits for another one or for its memory. One lane
// works on a reference or a record, and on those of the next level after it.
//
// A roofline: Williams, Waterman, Patterson, "Roofline: an insightful visual performance model for multicore
// architectures", CACM 52(4), 2009. The time is at least that of the operations, divided among all nodes and
// lanes, and at least that of the bytes which have to go to and from memory, at the most that the
// interconnect and the memory can carry.
//
// Bytes that have to: what is read of primitives and of kept records, once; what is written of records and
// lists, once; and of the references (box and number of a primitive) that a split sorts, what all caches of
// the cluster together cannot hold, to read them, and to write those that are moved.
#pragma once

#include <cstdint>

#include "accel/bvh_work.h"
#include "processors/cost/operation_mix.h"
#include "processors/machine/machine_config.h"
#include "sim/time.h"

namespace marti::processors::cost {

/// Bytes of a reference: six bounds and a number, of four bytes each, as coordinates in records are.
inline constexpr std::uint32_t bvh_reference_bytes = 28;

/// Means in thousandths of an operation. bounded: the box of a triangle, rounded outwards. placed: that of an
/// instance, from its mesh's. sorted: a reference into the bins of three axes, of which the extent is found
/// before. plane: its cost. merged: one box with another.
struct BvhMixes {
  OperationMix bounded;
  OperationMix placed;
  OperationMix sorted;
  OperationMix plane;
  OperationMix merged;
};

/// Measured on teapot:12 (at most 3 in a leaf, 32 bins); `placed` is counted by hand, in accel/instance.cpp:
/// 18 products of the transform with the box, compared in pairs, and 18 sums. A quadric's box costs as much
/// as a triangle's, though it takes more.
[[nodiscard]] const BvhMixes& bvh_mixes();

/// The work of one copy of the tree.
struct TreeWork {
  accel::BvhWork build;         ///< nothing where boxes are fitted anew
  std::uint64_t triangles = 0;  ///< whose boxes are worked out
  std::uint64_t quadrics = 0;   ///< whose boxes are, too
  std::uint64_t instances = 0;  ///< whose boxes are, and whose transforms are written
  std::uint64_t branches = 0;   ///< whose records are written
  std::uint64_t merged = 0;     ///< boxes merged with another one to fit those of nodes
  bool refits = false;          ///< records and lists are there, and are read
  std::uint32_t levels = 0;     ///< with `refits`, most of these branches one above the other
};

struct LeastTime {
  std::uint64_t read = 0;     ///< bytes
  std::uint64_t written = 0;  ///< bytes
  sim::Ticks compute = 0;  ///< for the operations: shared by all, and one after the other from level to level
  sim::Ticks memory = 0;   ///< for the bytes: least_transfer

  [[nodiscard]] sim::Ticks all() const { return compute > memory ? compute : memory; }
};

/// To move so many bytes between the nodes of a cluster and its memory; 0 where they can be carried in any
/// time.
[[nodiscard]] sim::Ticks least_transfer(std::uint64_t read, std::uint64_t written,
                                        const machine::MachineConfig& config);

/// With a replicated database each node makes the tree in its own memory by itself. UserError beyond 64 bits.
[[nodiscard]] LeastTime least_time(const TreeWork& work, const machine::MachineConfig& config);

}  // namespace marti::processors::cost
