// Which node traced which packets, recorded while a machine is replayed. Each node's part of the log can then
// be walked again when the replay is over.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "memory/layout.h"
#include "processors/machine/machine_config.h"
#include "processors/machine/packets.h"
#include "processors/walk/log_cursor.h"
#include "processors/walk/observer.h"

namespace marti::processors::walk {

/// Only for the image scheme with a given tree: where the tree is built, other nodes decide what a node
/// reads. With dynamic assignment a node's packets depend on the whole machine, hence the recording.
class PacketsOfNodes : public Observer {
 public:
  void begin(const ReplayInput& input) override;
  void spent(std::uint32_t node, NodeState state, sim::Ticks from, sim::Ticks to, PixelPlace pixel) override;
  void began_packet(std::uint32_t node, std::uint64_t packet, sim::Ticks start) override;

  [[nodiscard]] std::uint32_t nodes() const { return static_cast<std::uint32_t>(packets_of_.size()); }
  /// The numbers of a node's packets, in the order in which it traced them.
  [[nodiscard]] std::span<const std::uint64_t> packets_of(std::uint32_t node) const {
    return packets_of_[node];
  }

  /// The input of a walk over the log, for a machine whose references all go to its first-level caches. It
  /// refers to this object and to the log, which must still exist.
  [[nodiscard]] ReplayInput input(bool step_by_step) const;

 private:
  const program::WorkLog* log_ = nullptr;
  machine::MachineConfig config_;
  std::optional<memory::Layout> layout_;
  std::optional<machine::PacketList> packets_;
  std::vector<std::uint32_t> node_rank_;
  std::vector<std::vector<std::uint64_t>> packets_of_;
};

/// Calls use(cursor, x, y) for each pixel of the packets, in order; the cursor is at the start of its words.
template <class Use>
void for_each_pixel(const ReplayInput& input, std::span<const std::uint64_t> packets, const Use& use) {
  for (const std::uint64_t number : packets) {
    const machine::Packet packet = input.packets[number];
    for (std::uint32_t y = packet.y0; y < packet.y1; ++y) {
      for (std::uint32_t x = packet.x0; x < packet.x1; ++x) {
        const std::span<const std::uint32_t> words = input.log.pixel(x, y);
        Cursor cursor;
        cursor.word = words.data();
        cursor.word_end = words.data() + words.size();
        use(cursor, x, y);
      }
    }
  }
}

}  // namespace marti::processors::walk
