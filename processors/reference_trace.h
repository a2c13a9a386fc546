// The references of a node in program order, before its cache, for other cache simulators.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "memory/layout.h"
#include "memory/record_kind.h"
#include "processors/machine_config.h"
#include "processors/observer.h"
#include "processors/packets.h"

namespace marti::processors {

/// One reference: a read of one line of a record (of one interleave unit without a cache), from the first
/// byte of the record in it on; or the write of a pixel, whole.
struct Reference {
  memory::RecordKind kind = memory::RecordKind::node;
  memory::Address address = 0;
  bool write = false;
};

/// Watches a replay to learn which node traces which packets; afterwards it goes through each node's part of
/// the log again. With dynamic assignment the packets of a node, and so its references, depend on the whole
/// machine. Only for the image scheme with a given tree: where the tree is built, other nodes decide what a
/// node reads.
class ReferenceTrace final : public Observer {
 public:
  void begin(const ReplayInput& input) override;
  void spent(std::uint32_t node, NodeState state, sim::Ticks from, sim::Ticks to, PixelPlace pixel) override;
  void began_packet(std::uint32_t node, std::uint64_t packet, sim::Ticks start) override;

  [[nodiscard]] std::uint32_t nodes() const { return static_cast<std::uint32_t>(packets_of_.size()); }
  /// Calls `take` for each reference of a node. The log must still be there; the replay is over.
  void for_each(std::uint32_t node, const std::function<void(const Reference&)>& take) const;

 private:
  const WorkLog* log_ = nullptr;
  MachineConfig config_;
  std::optional<memory::Layout> layout_;
  std::optional<PacketList> packets_;
  std::vector<std::uint32_t> node_rank_;
  std::vector<std::vector<std::uint64_t>> packets_of_;
};

}  // namespace marti::processors
