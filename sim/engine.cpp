#include "sim/engine.h"

#include <string>

namespace marti::sim {

void Engine::fail_in_past() { throw InternalError("an event was posted in the past"); }

void Engine::handle(const Event& event, std::uint64_t& at_this_tick, std::uint64_t limit_per_tick) {
  at_this_tick = event.time == now_ ? at_this_tick + 1 : 1;
  if (at_this_tick > limit_per_tick) [[unlikely]] {
    throw InternalError("no progress: " + std::to_string(at_this_tick) + " events at tick " +
                        std::to_string(now_) + ", the last of class " + std::to_string(event.event_class()) +
                        ", component " + std::to_string(event.component()));
  }
  now_ = event.time;
  ++events_;
  EventHandler* handler = handlers_[event.event_class() % max_classes];
  ensure(handler != nullptr, "an event of a class that no component handles");
  handler->handle(event);
}

void Engine::run(std::uint64_t limit_per_tick) {
  std::uint64_t at_this_tick = 0;
  while (!queue_.empty()) {
    const Event event = queue_.pop();
    look_ahead([this](const Event& next) { return handlers_[next.event_class() % max_classes]; });
    handle(event, at_this_tick, limit_per_tick);
  }
}

}  // namespace marti::sim
