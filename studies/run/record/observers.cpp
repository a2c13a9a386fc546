#include "studies/run/record/observers.h"

#include <algorithm>

#include "sim/error.h"

namespace marti::studies::run {

using processors::walk::NodeState;
using processors::walk::PixelPlace;

void Observers::begin(const processors::walk::ReplayInput& input) {
  told_.assign(input.config.all_nodes(), 0);
  for (processors::walk::Observer* observer : observers_) {
    observer->begin(input);
  }
}

void Observers::spent(std::uint32_t node, NodeState state, sim::Ticks from, sim::Ticks to, PixelPlace pixel) {
  sim::ensure(from == told_[node] && to >= from, "a node's time line has a gap");
  told_[node] = to;
  for (processors::walk::Observer* observer : observers_) {
    observer->spent(node, state, from, to, pixel);
  }
}

void Observers::missed(std::uint32_t node, std::int64_t misses, PixelPlace pixel) {
  for (processors::walk::Observer* observer : observers_) {
    observer->missed(node, misses, pixel);
  }
}

bool Observers::hears_lanes() const {
  return std::any_of(observers_.begin(), observers_.end(),
                     [](const auto* observer) { return observer->hears_lanes(); });
}

void Observers::lane_spent(bool working, sim::Ticks time, PixelPlace pixel) {
  for (processors::walk::Observer* const observer : observers_) {
    observer->lane_spent(working, time, pixel);
  }
}

void Observers::began_packet(std::uint32_t node, std::uint64_t packet, sim::Ticks start) {
  for (processors::walk::Observer* observer : observers_) {
    observer->began_packet(node, packet, start);
  }
}

void Observers::resumed_packet(std::uint32_t node, std::uint64_t packet) {
  for (processors::walk::Observer* const observer : observers_) {
    observer->resumed_packet(node, packet);
  }
}

void Observers::end(sim::Ticks time) {
  for (const sim::Ticks told : told_) {
    sim::ensure(told == time, "a node's time line does not reach the end of the frame");
  }
  for (processors::walk::Observer* observer : observers_) {
    observer->end(time);
  }
}

}  // namespace marti::studies::run
