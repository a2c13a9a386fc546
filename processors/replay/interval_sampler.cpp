#include "processors/replay/interval_sampler.h"

#include <limits>
#include <utility>

namespace marti::processors::replay {

namespace {

// Behind the classes of all nodes and memories.
constexpr auto sample_class = static_cast<std::uint8_t>(sim::Engine::max_classes - 1);

}  // namespace

IntervalSampler::IntervalSampler(const Intervals* intervals, sim::Engine& engine, node::NodeArray& nodes,
                                 ResultSoFar result_so_far)
    : intervals_(intervals), engine_(engine), nodes_(nodes), result_so_far_(std::move(result_so_far)) {
  sim::ensure(intervals == nullptr || intervals->length > 0, "an interval has no length");
}

void IntervalSampler::run(std::uint64_t start_seed) {
  if (intervals_ == nullptr) {
    nodes_.start(start_seed);
    nodes_.run_all(engine_);
    return;
  }
  look(0);
  engine_.attach(sample_class, *this);
  nodes_.start(start_seed);
  post();
  // Not run_all(), in which all events are the nodes'.
  engine_.run(std::numeric_limits<std::uint64_t>::max());
}

void IntervalSampler::finish() {
  while (intervals_ != nullptr && end_ <= nodes_.end()) {
    look(end_);
  }
}

void IntervalSampler::handle(const sim::Event& /*event*/) {
  ++events_;
  if (engine_.has_events()) {
    nodes_.settle();
    look(end_);
    post();
  }
}

void IntervalSampler::look(sim::Ticks time) {
  intervals_->counted(result_so_far_(time));
  end_ = time > std::numeric_limits<sim::Ticks>::max() - intervals_->length
             ? std::numeric_limits<sim::Ticks>::max()
             : time + intervals_->length;
}

void IntervalSampler::post() {
  if (end_ != std::numeric_limits<sim::Ticks>::max()) {
    engine_.post(sim::Event::make(end_ - 1, sample_class, 0));
  }
}

}  // namespace marti::processors::replay
