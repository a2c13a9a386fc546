// Runs a frame, and looks at what it has counted at the end of each interval.
#pragma once

#include <cstdint>
#include <functional>

#include "processors/node/node_array.h"
#include "processors/replay/replay.h"
#include "sim/engine.h"

namespace marti::processors::replay {

/// Has an event of its own at the last tick of each interval, behind all others of that tick.
class IntervalSampler final : private sim::EventHandler {
 public:
  /// The result of the frame so far, as of this time.
  using ResultSoFar = std::function<MachineResult(sim::Ticks time)>;

  /// `intervals` may be null: then nothing is looked at. All must outlive it.
  IntervalSampler(const Intervals* intervals, sim::Engine& engine, node::NodeArray& nodes,
                  ResultSoFar result_so_far);

  /// In the place of NodeArray::start() and NodeArray::run_all().
  void run(std::uint64_t start_seed);
  /// After NodeArray::finish(): looks at the intervals that end after the last event.
  void finish();
  /// The events that were the sampler's own.
  [[nodiscard]] std::uint64_t events() const { return events_; }

 private:
  void handle(const sim::Event& event) override;
  void look(sim::Ticks time);
  // Posts the event at the end of the present interval, unless no simulation reaches it.
  void post();

  const Intervals* intervals_;
  sim::Engine& engine_;
  node::NodeArray& nodes_;
  ResultSoFar result_so_far_;
  sim::Ticks end_ = 0;  // of the present interval
  std::uint64_t events_ = 0;
};

}  // namespace marti::processors::replay
