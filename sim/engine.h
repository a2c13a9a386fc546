// The event kernel: hands each pending event, in total order, to the handler of its class.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "sim/event_queue.h"
#include "sim/time.h"

namespace marti::sim {

/// Receives events. Handlers do not own the engine and outlive its run.
class EventHandler {
 public:
  virtual ~EventHandler() = default;
  /// `event.time` is the engine's current time. New events may be posted from here.
  virtual void handle(const Event& event) = 0;
  /// `event` will probably be handled soon, so the data of its component may be prefetched into the host's
  /// caches. Called only when so many events are pending that their data do not all fit there.
  virtual void prepare(const Event& /*event*/) {}
  /// prepare() was called for `event` a while ago, in most cases, and it may be the next: what the
  /// component's data point to may be prefetched.
  virtual void prepare_more(const Event& /*event*/) {}
};

/// Runs a simulation. Not shared between threads: each simulated machine has its own engine.
class Engine {
 public:
  static constexpr std::size_t max_classes = 16;

  /// All events of `event_class` (below max_classes) go to `handler`. Lower classes come first at equal
  /// times.
  void attach(std::uint8_t event_class, EventHandler& handler) { handlers_.at(event_class) = &handler; }

  /// `event` must not lie in the past; that is a fault of the simulator, never of its input.
  [[gnu::always_inline]] void post(Event event) {
    if (event.time < now_) [[unlikely]] {
      fail_in_past();
    }
    queue_.push(event);
  }
  /// post() for an event that is likely to be later than those that were posted in this way before. It is
  /// handled when a posted one would be, and cheaper if that is so.
  [[gnu::always_inline]] void post_in_order(Event event) {
    if (event.time < now_) [[unlikely]] {
      fail_in_past();
    }
    queue_.push_in_order(event);
  }

  /// Handles events until none is left. Throws InternalError when more than `limit_per_tick` events are
  /// handled at one tick, which only a machine that makes no progress can cause.
  void run(std::uint64_t limit_per_tick);

  /// run() where all events go to one handler, whose class is known to the compiler, and without a limit.
  /// `handler` has handle_in_order(event) beside the members of EventHandler: handle() for an event of
  /// post_in_order().
  template <class Handler>
  void run_all(Handler& handler);

  /// run_all() for the events before `end` alone.
  template <class Handler>
  void run_before(Handler& handler, Ticks end);
  /// The time of the earliest event that is pending; the largest time if no event is.
  [[nodiscard]] Ticks next_time() { return queue_.front().time; }
  /// The place, among all events of a simulation, of what is done in the event that run_before() handles now.
  /// Where an event has had others of its own time posted that come before it in order, these are handled
  /// after it all the same, so what counts is the latest in order that was handled at this time.
  [[nodiscard]] Event turn() const { return {now_, latest_}; }

  [[nodiscard]] Ticks now() const { return now_; }
  /// Whether an event is pending.
  [[nodiscard]] bool has_events() const { return !queue_.empty(); }
  [[nodiscard]] std::uint64_t events() const { return events_; }
  void reserve(std::size_t events) { queue_.reserve(events); }
  /// reserve() for events of components below `components` that seldom have more than one each.
  void reserve_for(std::size_t components) { queue_.reserve_for(components); }

 private:
  [[noreturn]] static void fail_in_past();
  // Has handlers prepare for the events that are likely to be next, if many are pending. handler_of(event)
  // is null or a handler.
  template <class HandlerOf>
  void look_ahead(const HandlerOf& handler_of) const {
    if (queue_.many_pending()) [[unlikely]] {
      look_far_ahead(handler_of);
    }
  }
  // Not inlined, so that simulations with few pending events need no registers for it.
  template <class HandlerOf>
  [[gnu::noinline]] void look_far_ahead(const HandlerOf& handler_of) const {
    queue_.look_ahead(
        [&handler_of](const Event& later) {
          if (auto* const handler = handler_of(later)) {
            handler->prepare(later);
          }
        },
        [&handler_of](const Event& soon) {
          if (auto* const handler = handler_of(soon)) {
            handler->prepare_more(soon);
          }
        });
  }
  // Passes one event to its handler.
  void handle(const Event& event, std::uint64_t& at_this_tick, std::uint64_t limit_per_tick);

  EventQueue queue_;
  std::array<EventHandler*, max_classes> handlers_{};
  Ticks now_ = 0;
  std::uint64_t latest_ = 0;  // of run_before(): the largest order of the events handled at now_
  std::uint64_t events_ = 0;
};

template <class Handler>
void Engine::run_all(Handler& handler) {
  std::uint64_t events = 0;
  if (queue_.has_tree()) {
    for (; !queue_.empty(); ++events) {
      const Event event = queue_.pop();
      now_ = event.time;
      handler.handle(event);
    }
  }
  const auto handler_of = [&handler](const Event& /*event*/) { return &handler; };
  for (;; ++events) {
    // The two kinds are handled apart, because which comes next is not predictable and costs a branch here.
    if (queue_.next_is_in_order()) {
      const Event event = queue_.pop_in_order();
      now_ = event.time;
      look_ahead(handler_of);
      handler.handle_in_order(event);
    } else if (queue_.has_no_other()) [[unlikely]] {
      break;
    } else {
      const Event event = queue_.pop_other();
      now_ = event.time;
      look_ahead(handler_of);
      handler.handle(event);
    }
  }
  events_ += events;
}

template <class Handler>
void Engine::run_before(Handler& handler, Ticks end) {
  std::uint64_t events = 0;
  const auto handler_of = [&handler](const Event& /*event*/) { return &handler; };
  for (; queue_.front().time < end; ++events) {
    const Event event = queue_.pop();
    latest_ = event.time == now_ ? std::max(latest_, event.order) : event.order;
    now_ = event.time;
    look_ahead(handler_of);
    handler.handle(event);
  }
  events_ += events;
}

}  // namespace marti::sim
