// Rays in flight, all in one pool, and the queues of rays at the nodes.
#pragma once

#include <cstdint>
#include <vector>

#include "processors/program/work_log.h"
#include "sim/large_pages.h"
#include "sim/time.h"

namespace marti::processors::flow {

/// A ray on its way to a node, in a queue, or in service at a node.
struct FlowRay {
  const std::uint32_t* word = nullptr;  ///< its next step
  const std::uint32_t* end = nullptr;
  sim::Ticks arrival = 0;    ///< at the node in whose queue it is
  std::uint32_t next = 0;    ///< next ray in the queue, or in the list of free entries
  std::uint32_t tree = 0;    ///< the tree of its sample
  std::uint32_t number = 0;  ///< in the tree
  std::uint32_t from = 0;    ///< the node that sends it when a slot is free
  program::RayKind kind = program::RayKind::camera;
  bool record_read = false;  ///< the record of the leaf at `word` was read
  bool lit = false;          ///< a light's contribution was added
};

class RayPool {
 public:
  static constexpr std::uint32_t none = 0xffffffffU;

  /// Makes a new ray; invalidates references to rays.
  std::uint32_t take() {
    if (free_ == none) {
      rays_.emplace_back();
      return static_cast<std::uint32_t>(rays_.size() - 1);
    }
    const std::uint32_t ray = free_;
    free_ = rays_[ray].next;
    return ray;
  }
  void give_back(std::uint32_t ray) {
    rays_[ray].next = free_;
    free_ = ray;
  }
  /// Host bytes of all entries.
  [[nodiscard]] std::size_t bytes() const { return rays_.size() * sizeof(FlowRay); }
  [[nodiscard]] FlowRay& operator[](std::uint32_t ray) { return rays_[ray]; }
  [[nodiscard]] const FlowRay& operator[](std::uint32_t ray) const { return rays_[ray]; }

 private:
  sim::LargeVector<FlowRay> rays_;
  std::uint32_t free_ = none;
};

/// The rays that wait at a node or are on their way to it, in the order of arrival; rays that arrive at the
/// same time, in the order in which they were sent.
struct RayQueue {
  std::uint32_t head = RayPool::none;
  std::uint32_t tail = RayPool::none;
  std::uint32_t count = 0;  ///< slots in use, including those reserved for rays not sent yet

  /// Adds a ray whose slot has been counted before.
  void insert(RayPool& rays, std::uint32_t ray) {
    rays[ray].next = RayPool::none;
    if (head == RayPool::none) {
      head = tail = ray;
      return;
    }
    const sim::Ticks arrival = rays[ray].arrival;
    if (rays[tail].arrival <= arrival) [[likely]] {
      rays[tail].next = ray;
      tail = ray;
      return;
    }
    std::uint32_t* link = &head;
    while (rays[*link].arrival <= arrival) {
      link = &rays[*link].next;
    }
    rays[ray].next = *link;
    *link = ray;
  }

  /// Removes the first ray and frees its slot. The queue must not be empty.
  std::uint32_t pop(RayPool& rays) {
    const std::uint32_t ray = head;
    head = rays[ray].next;
    if (head == RayPool::none) {
      tail = RayPool::none;
    }
    --count;
    return ray;
  }
};

}  // namespace marti::processors::flow
