// Several observers as one, and a check that the nodes report all of their time.
#pragma once

#include <vector>

#include "processors/walk/observer.h"

namespace marti::studies::run {

/// Passes every call on to each of its observers, which must outlive it.
class Observers final : public processors::walk::Observer {
 public:
  void add(processors::walk::Observer& observer) { observers_.push_back(&observer); }
  [[nodiscard]] bool empty() const { return observers_.empty(); }

  void begin(const processors::walk::ReplayInput& input) override;
  void spent(std::uint32_t node, processors::walk::NodeState state, sim::Ticks from, sim::Ticks to,
             processors::walk::PixelPlace pixel) override;
  void missed(std::uint32_t node, std::int64_t misses, processors::walk::PixelPlace pixel) override;
  [[nodiscard]] bool hears_lanes() const override;
  void lane_spent(bool working, sim::Ticks time, processors::walk::PixelPlace pixel) override;
  void began_packet(std::uint32_t node, std::uint64_t packet, sim::Ticks start) override;
  void resumed_packet(std::uint32_t node, std::uint64_t packet) override;
  /// Throws InternalError unless the pieces of each node reached from 0 to `time` without a gap.
  void end(sim::Ticks time) override;

 private:
  std::vector<processors::walk::Observer*> observers_;
  std::vector<sim::Ticks> told_;  // end of the last piece, of each node
};

}  // namespace marti::studies::run
