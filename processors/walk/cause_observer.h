// What a recorder of causes is told beside what every observer is told: why a wait of a node ended.
#pragma once

#include <cstdint>

#include "processors/cost/accounting.h"
#include "sim/time.h"

namespace marti::processors::walk {

/// How far a node has come in the log: the pixel, and how many of its words the node has taken. The last of
/// these belongs to the step that the node is at.
struct LogPlace {
  static constexpr std::uint32_t nowhere = 0xffffffffU;
  std::uint32_t pixel = nowhere;  ///< y * width + x; `nowhere`: the work is for no pixel
  std::uint32_t word = 0;
};

/// A ray, or what it adds to its pixel, on its way through a cluster's network.
struct RayMessage {
  static constexpr std::uint32_t none = 0xffffffffU;
  std::uint32_t ray = none;  ///< its number among those in flight; `none`: the message goes to the host
  std::uint32_t sender = 0;  ///< a node, or the host's link into a cluster: number of all nodes + cluster
  std::uint32_t to = 0;      ///< the node that gets a ray
  std::uint32_t bytes = 0;
  bool was_set_aside = false;  ///< until it is sent
  sim::Ticks sent = 0;
  sim::Ticks arrival = 0;
};

/// Called by the nodes, which then take every step record by record, so that what they have counted is what
/// they have spent. Calls come in the order of what happens at each node.
class CauseObserver {
 public:
  virtual ~CauseObserver() = default;

  /// The node has worked until it needs something shared, perhaps for no time. Called before
  /// Observer::spent for that work. `statistics`: all that it has counted so far.
  virtual void worked(std::uint32_t node, const cost::NodeStatistics& statistics, LogPlace place) = 0;

  // By the image scheme.

  /// A context of the node asked the host for a packet at `asked` and may begin it at `start`. Called in the
  /// order in which the host serves the requests, before Observer::spent for the wait.
  virtual void granted(std::uint32_t node, std::uint32_t context, sim::Ticks asked, sim::Ticks start) = 0;
  /// The node prefetches a line from its own second level, which takes until `to`; `slot` is the port that is
  /// in use until then.
  virtual void prefetched(std::uint32_t node, std::uint32_t slot, sim::Ticks from, sim::Ticks to) = 0;
  /// The node's wait ends now because this context can go on; called before Observer::spent for the wait.
  /// `slot`: the port whose read the context has waited for; the context's number if it was a grant. Nodes
  /// with one port do not call it: there both are 0.
  virtual void wait_ended(std::uint32_t node, std::uint32_t context, std::uint32_t slot) = 0;
  /// All nodes begin the frame at `start_up`, when the tree has been built.
  virtual void began_frame(sim::Ticks start_up) = 0;
  /// Worker `waiter` (node * contexts + context) can go on when the last write that `builder` has posted is
  /// done.
  virtual void published(std::uint32_t builder, std::uint32_t waiter) = 0;

  // By the schemes in which rays move. A sender is what RayMessage says.

  /// The host sends the cluster's next camera ray at `now`, to node `to`; called before `sent` or
  /// `set_aside`.
  virtual void sent_camera_ray(std::uint32_t cluster, std::uint32_t to, sim::Ticks now) = 0;
  /// From `now` on the ray waits in its sender's memory for a slot of the node that it is to be sent to.
  virtual void set_aside(std::uint32_t ray, std::uint32_t sender, sim::Ticks now) = 0;
  /// Called in the order of sending. A ray that was set aside is sent when node `to` takes a ray.
  virtual void sent(const RayMessage& message) = 0;
  /// The node takes the ray from its queue; if it has waited until now, for that ray.
  virtual void took(std::uint32_t node, std::uint32_t ray, sim::Ticks now) = 0;
  /// The sender `waiter` need not wait any longer, because node `by` has freed a slot or ended a ray.
  virtual void let_go(std::uint32_t waiter, std::uint32_t by, sim::Ticks now) = 0;
};

}  // namespace marti::processors::walk
