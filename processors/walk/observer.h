// Observers of a replay: time lines of the nodes, figures by pixel, which node traced which packet.
//
// How a scheme's nodes call ReplayInput::observer, which is null when there is no observer:
//   - `spent` for every piece of a node's time, whenever the node's own time moves on: after it has worked
//     until the next thing that is shared, after a read (`spent_reading`), and for every wait and the idle
//     time at the end. Pieces of one node come in the order of time and without gaps from 0 to the end of the
//     frame; pieces of no length may be left out. Nodes come in any order.
//   - `missed` for the cache misses of a pixel, at the latest when the pixel or ray is done with.
//   - `began_packet` when a node begins a packet that the host gave it, by schemes that have packets.
//   - `lane_spent` by SIMT nodes, for those who hear lanes: what such a node spends is for many pixels, so
//   that
//     `spent` names none, and only those who hear lanes are told of its misses.
//   - `requested` by the memory system (replay_parts.h), for those who hear requests.
//   - `referred` by the caches of nodes, for those who hear references.
//   - `resumed_packet` when a node with several contexts goes back to a packet it has begun before.
// Replay itself calls `begin` and `end`. Observing changes nothing that is simulated.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "memory/interconnect.h"
#include "memory/record_kind.h"
#include "processors/walk/replay_input.h"
#include "sim/time.h"

namespace marti::processors::walk {

/// What a node does in a piece of its time. `working` is everything it does by itself: the activities
/// traversal, intersection, shading, building, cache_access, switching and messaging, and the transfer and
/// bank_access of its own memory. The others are the activities of the same names
/// (processors/cost/accounting.h). `memory` is only of SIMT nodes: all four activities of reading, of several
/// lines at once.
enum class NodeState : std::uint8_t {
  working,
  interconnect_wait,
  transfer,
  bank_wait,
  bank_access,
  lock_wait,
  message_wait,
  queue_full_wait,
  dispatch_wait,
  memory,
  idle,
};
inline constexpr std::size_t node_states = 11;
inline constexpr std::array<std::string_view, node_states> node_state_names = {
    "working",      "interconnect_wait", "transfer",      "bank_wait", "bank_access", "lock_wait",
    "message_wait", "queue_full_wait",   "dispatch_wait", "memory",    "idle"};

/// The pixel that a piece of time or a miss was for; `none` for work that belongs to no pixel (building
/// before the frame, waiting for a packet or a ray, idle).
struct PixelPlace {
  static constexpr std::uint32_t nowhere = 0xffffffffU;
  std::uint32_t x = nowhere;
  std::uint32_t y = nowhere;

  [[nodiscard]] bool none() const { return x == nowhere; }
  friend bool operator==(const PixelPlace&, const PixelPlace&) = default;
};

/// What a node asks of its cluster's memory: what leaves its caches, prefetches too, and posted writes. Of a
/// distributed memory also what is in the node's own part of it.
struct Request {
  sim::Ticks time = 0;
  std::uint32_t node = 0;
  memory::Address address = 0;
  std::uint32_t bytes = 0;
  bool write = false;
};

/// Called from one thread during a replay. An exception thrown here ends the replay.
class Observer {
 public:
  virtual ~Observer() = default;

  /// Called before anything else; what `input` refers to exists until `end` has returned.
  virtual void begin(const ReplayInput& /*input*/) {}
  /// Node `node` was in `state` from `from` to `to`, at least `from`.
  virtual void spent(std::uint32_t node, NodeState state, sim::Ticks from, sim::Ticks to,
                     PixelPlace pixel) = 0;
  /// So many of the node's references missed its cache, for this pixel.
  virtual void missed(std::uint32_t /*node*/, std::int64_t /*misses*/, PixelPlace /*pixel*/) {}
  /// The node has been given packet `packet` of ReplayInput::packets, and begins it at `start`.
  virtual void began_packet(std::uint32_t /*node*/, std::uint64_t /*packet*/, sim::Ticks /*start*/) {}
  /// What the node does from now on is for this packet, which it has begun before.
  virtual void resumed_packet(std::uint32_t /*node*/, std::uint64_t /*packet*/) {}
  /// Whether `lane_spent` is to be called.
  [[nodiscard]] virtual bool hears_lanes() const { return false; }
  /// A lane has worked for a pixel for so long, or has waited. Pieces come when they end; lanes work at once.
  virtual void lane_spent(bool /*working*/, sim::Ticks /*time*/, PixelPlace /*pixel*/) {}
  /// Whether `requested` is to be called.
  [[nodiscard]] virtual bool hears_requests() const { return false; }
  /// Called in the order of time.
  virtual void requested(const Request& /*request*/) {}
  /// Whether `referred` is to be called: then nodes take every step record by record.
  [[nodiscard]] virtual bool hears_references() const { return false; }
  /// What a node reads of a record of this kind in one reference to its first-level cache, or without one;
  /// of a SIMT node a line for all lanes that share it. Of each node in the order of time.
  virtual void referred(const Request& /*reference*/, memory::RecordKind /*kind*/, bool /*hit*/) {}
  /// The frame took until `time`; called last.
  virtual void end(sim::Ticks /*time*/) {}
};

[[nodiscard]] inline bool hears_references(const ReplayInput& input) {
  return input.observer != nullptr && input.observer->hears_references();
}

/// Reports the pieces of a read that was asked for at `from`. Only the lengths of a read's four parts are
/// known: they are reported in the order waiting for the interconnect, waiting for the bank, bank, transfer.
inline void spent_reading(Observer& observer, std::uint32_t node, const memory::Service& service,
                          sim::Ticks from, PixelPlace pixel) {
  sim::Ticks at = from;
  const auto piece = [&](NodeState state, sim::Ticks length) {
    if (length > 0) {
      observer.spent(node, state, at, at + length, pixel);
      at += length;
    }
  };
  piece(NodeState::interconnect_wait, service.wait_interconnect);
  piece(NodeState::bank_wait, service.wait_bank);
  piece(NodeState::bank_access, service.bank);
  piece(NodeState::transfer, service.transfer);
}

}  // namespace marti::processors::walk
