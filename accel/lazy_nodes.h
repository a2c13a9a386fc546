// The storage of a lazy octree's nodes and lists, in chunks that never move, so that rays read them while
// other threads add more.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "accel/octree_build.h"
#include "accel/octree_nodes.h"
#include "accel/octree_sort.h"

namespace marti::accel {

/// A node still to be subdivided: its place and the triangles that it lists.
struct PendingNode {
  OctreeCell cell;
  std::vector<std::uint32_t> list;
};

/// `info` gives the state of the node. Other members may be read only after `info` was read with acquire
/// order and gave a leaf or a branch, or by the thread that changed it from pending to building.
struct LazyNode {
  static constexpr std::uint32_t pending = 0x40000000U;   ///< to be subdivided when a ray needs it
  static constexpr std::uint32_t building = 0x60000000U;  ///< a thread is subdividing it

  std::atomic<std::uint32_t> info{OctreeNode::leaf_bit};  ///< as OctreeNode's, or one of the above
  std::uint32_t first = 0;                                ///< branch: its first child's number
  const std::uint32_t* list = nullptr;                    ///< leaf: the triangles it lists
  PendingNode* waiting = nullptr;                         ///< pending: its place and list, owned

  [[nodiscard]] static bool is_pending(std::uint32_t info) {
    return (info & OctreeNode::leaf_bit) == 0 && (info & pending) != 0;
  }
};

/// Nodes are only added. Numbers begin at 0, the root; the eight children of a branch are consecutive.
class LazyNodes {
 public:
  LazyNodes();
  LazyNodes(const LazyNodes&) = delete;
  LazyNodes& operator=(const LazyNodes&) = delete;
  ~LazyNodes();

  /// The node must exist, and the caller must have its number from an acquire of its parent's info.
  [[nodiscard]] LazyNode& operator[](std::uint32_t n) const {
    const std::size_t at = n + node_offset;
    return (*chunks_)[at / chunk_nodes].load(std::memory_order_relaxed)[at % chunk_nodes];
  }

  /// Adds eight nodes, which are empty leaves at first; returns the number of the first. Any thread may call
  /// it. Throws UserError when there would be more than most_octree_nodes.
  [[nodiscard]] std::uint32_t add_children();
  /// Room for a list, which exists as long as this object. Any thread may call it.
  [[nodiscard]] std::uint32_t* add_list(std::size_t entries);

  [[nodiscard]] std::uint32_t size() const { return size_.load(std::memory_order_acquire); }

 private:
  static constexpr std::size_t chunk_nodes = std::size_t{1} << 13;
  static constexpr std::size_t chunk_entries = std::size_t{1} << 16;
  static constexpr std::size_t most_chunks = (most_octree_nodes + node_offset) / chunk_nodes + 1;

  void add_chunk();

  std::unique_ptr<std::array<std::atomic<LazyNode*>, most_chunks>> chunks_;
  std::atomic<std::uint32_t> size_{1};
  std::mutex mutex_;  ///< guards the members below, and writes to those above
  std::vector<std::unique_ptr<LazyNode[]>> owned_;
  std::vector<std::unique_ptr<std::uint32_t[]>> lists_;
  std::uint32_t* free_list_ = nullptr;
  std::size_t free_entries_ = 0;
};

}  // namespace marti::accel
