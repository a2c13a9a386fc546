#include "accel/lazy_nodes.h"

#include <string>

#include "sim/error.h"

namespace marti::accel {

LazyNodes::LazyNodes() : chunks_(std::make_unique<std::array<std::atomic<LazyNode*>, most_chunks>>()) {
  add_chunk();
}

LazyNodes::~LazyNodes() {
  for (std::uint32_t n = 0; n < size_; ++n) {
    delete (*this)[n].waiting;
  }
}

void LazyNodes::add_chunk() {
  owned_.push_back(std::make_unique<LazyNode[]>(chunk_nodes));
  (*chunks_)[owned_.size() - 1].store(owned_.back().get(), std::memory_order_relaxed);
}

std::uint32_t LazyNodes::add_children() {
  const std::lock_guard lock(mutex_);
  const std::uint32_t first = size_.load(std::memory_order_relaxed);
  if (first + 8 > most_octree_nodes) {
    throw sim::UserError("lazy octree: it would have more than " + std::to_string(most_octree_nodes) +
                         " nodes; raise max_objects or lower max_level");
  }
  if ((first + node_offset) / chunk_nodes == owned_.size()) {
    add_chunk();
  }
  size_.store(first + 8, std::memory_order_release);
  return first;
}

std::uint32_t* LazyNodes::add_list(std::size_t entries) {
  const std::lock_guard lock(mutex_);
  if (entries > chunk_entries / 4) {
    lists_.push_back(std::make_unique_for_overwrite<std::uint32_t[]>(entries));
    return lists_.back().get();
  }
  if (entries > free_entries_) {
    lists_.push_back(std::make_unique_for_overwrite<std::uint32_t[]>(chunk_entries));
    free_list_ = lists_.back().get();
    free_entries_ = chunk_entries;
  }
  std::uint32_t* list = free_list_;
  free_list_ += entries;
  free_entries_ -= entries;
  return list;
}

}  // namespace marti::accel
