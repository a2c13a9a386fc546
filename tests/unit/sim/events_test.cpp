// Time and the event kernel: total order, checked arithmetic, no progress in the past.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "sim/engine.h"
#include "sim/error.h"
#include "sim/event_queue.h"
#include "sim/number_set.h"
#include "sim/time.h"

namespace marti::sim {
namespace {

std::vector<Event> some_events(std::mt19937_64& random, std::size_t count) {
  std::vector<Event> events;
  for (std::size_t i = 0; i < count; ++i) {
    events.push_back(Event::make(static_cast<Ticks>(random() % 20), static_cast<std::uint8_t>(random() % 4),
                                 static_cast<std::uint32_t>(random() % 5), static_cast<std::uint32_t>(i)));
  }
  return events;
}

// Pops and pushes interleaved, as in a simulation, against a sorted list.
RC_GTEST_PROP(EventQueue, AgreesWithASortedListWhenPopsAndPushesMix, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  EventQueue queue;
  std::vector<Event> list;
  for (const Event& event : some_events(random, 400)) {
    queue.push(event);
    list.insert(std::upper_bound(list.begin(), list.end(), event), event);
    while (!list.empty() && random() % 3 == 0) {
      const Event popped = queue.pop();
      RC_ASSERT(popped.time == list.front().time);
      RC_ASSERT(popped.order == list.front().order);
      list.erase(list.begin());
    }
    RC_ASSERT(queue.size() == list.size());
    RC_ASSERT(queue.empty() == list.empty());
  }
}

// Long runs with events at many distances, so that the calendar is tuned, crowded and left behind.
RC_GTEST_PROP(EventQueue, AgreesWithASetWhileDistancesChange, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  EventQueue queue;
  queue.reserve(random() % 3 == 0 ? 10'000 : 10);
  std::set<std::pair<Ticks, std::uint64_t>> set;
  Ticks now = 0;
  std::uint32_t number = 0;
  for (int phase = 0; phase < 4; ++phase) {
    const Ticks distance = Ticks{1} << (random() % 40);
    const std::size_t pending = 1 + random() % 300;
    const std::uint64_t in_order = random() % 5;  // quarters of the events
    for (int step = 0; step < 3000; ++step) {
      while (set.size() < pending) {
        const Ticks ahead = random() % 8 == 0 ? 0 : static_cast<Ticks>(random()) & (2 * distance - 1);
        const Event event = Event::make(now + ahead, static_cast<std::uint8_t>(random() % 4), number++);
        if (random() % 4 < in_order) {
          queue.push_in_order(event);
        } else {
          queue.push(event);
        }
        set.emplace(event.time, event.order);
      }
      RC_ASSERT(queue.size() == set.size());
      const Event popped = queue.pop();
      RC_ASSERT(popped.time == set.begin()->first);
      RC_ASSERT(popped.order == set.begin()->second);
      now = popped.time;
      set.erase(set.begin());
    }
  }
}

// A few components, as in a small machine, most of which have one event at a time.
RC_GTEST_PROP(EventQueue, AgreesWithASetWhereComponentsAreFew, (std::uint64_t seed)) {
  std::mt19937_64 random(seed);
  const auto components = static_cast<std::uint32_t>(1 + random() % (EventTree::most + 1));
  EventQueue queue;
  queue.reserve_for(components);
  RC_ASSERT(queue.has_tree() == (components <= EventTree::most));
  std::set<std::pair<Ticks, std::uint64_t>> set;
  Ticks now = 0;
  std::uint32_t number = 0;
  for (int step = 0; step < 3000; ++step) {
    // At most five events together, some of them of one component, or of one that has no place of its own.
    while (set.empty() || (set.size() < 5 && random() % 2 == 0)) {
      const Event event =
          Event::make(now + static_cast<Ticks>(random() % 50), static_cast<std::uint8_t>(random() % 4),
                      static_cast<std::uint32_t>(random() % (components + 1)), number++);
      random() % 2 == 0 ? queue.push_in_order(event) : queue.push(event);
      set.emplace(event.time, event.order);
    }
    RC_ASSERT(queue.size() == set.size());
    const Event popped = queue.pop();
    RC_ASSERT(popped.time == set.begin()->first);
    RC_ASSERT(popped.order == set.begin()->second);
    now = popped.time;
    set.erase(set.begin());
    RC_ASSERT(queue.empty() == set.empty());
  }
}

TEST(EventQueue, KeepsEventsOfTheLastTick) {
  constexpr Ticks last = std::numeric_limits<Ticks>::max();
  EventQueue queue;
  queue.push(Event::make(last, 1, 2));
  queue.push(Event::make(last, 1, 1));
  queue.push_in_order(Event::make(last, 1, 0));
  for (const std::uint32_t component : {0U, 1U, 2U}) {
    EXPECT_EQ(queue.pop().component(), component);
  }
  EXPECT_TRUE(queue.empty());
}

// Replies of a queue with several servers come nearly in order; all of them, whatever the order, must be
// popped as if they had been pushed like others.
TEST(EventLane, TakesWhatIsNearlyInOrderAndRefusesTheRest) {
  std::mt19937_64 random(7);
  EventLane lane;
  std::vector<Event> sorted;
  int refused = 0;
  for (std::uint32_t number = 0; number < 5000; ++number) {
    const Event event = Event::make(number * 10 + static_cast<Ticks>(random() % 1600), 0, number);
    const auto place = std::upper_bound(sorted.begin(), sorted.end(), event);
    const bool near = sorted.end() - place <= 64;
    ASSERT_EQ(lane.push(event), near);
    refused += near ? 0 : 1;
    if (near) {
      sorted.insert(place, event);
    }
    if (random() % 3 != 0 && !sorted.empty()) {
      ASSERT_EQ(lane.front().order, sorted.front().order);
      ASSERT_EQ(lane.pop().order, sorted.front().order);
      sorted.erase(sorted.begin());
    }
    ASSERT_EQ(lane.size(), sorted.size());
  }
  EXPECT_GT(refused, 100);
  EXPECT_LT(refused, 1000);
}

TEST(NumberSet, FindsTheNextMember) {
  std::mt19937_64 random(1);
  for (const std::uint32_t size : {1U, 64U, 65U, 4000U, NumberSet::most}) {
    NumberSet set;
    std::set<std::uint32_t> plain;
    for (int step = 0; step < 2000; ++step) {
      const auto number = static_cast<std::uint32_t>(random() % size);
      if (random() % 3 != 0) {
        set.insert(number);
        plain.insert(number);
      } else {
        set.erase(number);
        plain.erase(number);
      }
      if (!plain.empty()) {
        const auto from = static_cast<std::uint32_t>(random() % size);
        const auto found = plain.lower_bound(from);
        ASSERT_EQ(set.next(from), found == plain.end() ? *plain.begin() : *found);
      }
    }
  }
}

TEST(Event, KeepsItsFields) {
  const Event event = Event::make(77, 200, 0xfffffffeU, 0xabcdef);
  EXPECT_EQ(event.time, 77);
  EXPECT_EQ(event.event_class(), 200);
  EXPECT_EQ(event.component(), 0xfffffffeU);
  EXPECT_EQ(event.sequence(), 0xabcdefU);
}

TEST(Event, OrdersByTimeThenClassThenComponentThenSequence) {
  const std::vector<Event> ascending = {Event::make(1, 9, 9, 9), Event::make(2, 0, 9, 9),
                                        Event::make(2, 1, 0, 9), Event::make(2, 1, 1, 0),
                                        Event::make(2, 1, 1, 1)};
  for (std::size_t i = 1; i < ascending.size(); ++i) {
    EXPECT_TRUE(ascending[i - 1] < ascending[i]);
    EXPECT_FALSE(ascending[i] < ascending[i - 1]);
  }
}

// Posts two events for each one that it handles, until `left` have been posted, at random distances and in
// either way, which depend on the event alone.
class Spreader final : public EventHandler {
 public:
  Spreader(Engine& engine, int left) : engine_(engine), left_(left) {
    engine_.attach(0, *this);
    engine_.attach(1, *this);
  }
  void handle(const Event& event) override {
    handled.emplace_back(event.time, event.order);
    std::mt19937_64 random(event.order * 31 + static_cast<std::uint64_t>(event.time));
    for (int i = 0; i < 2 && left_ > 0; ++i, --left_) {
      const auto ahead = static_cast<Ticks>(random() % (random() % 3 == 0 ? 100'000 : 50));
      const auto component = static_cast<std::uint32_t>(left_);
      if (random() % 2 == 0) {
        engine_.post(Event::make(event.time + ahead, 0, component));
      } else {
        engine_.post_in_order(Event::make(event.time + ahead, 1, component));
      }
    }
  }
  void handle_in_order(const Event& event) {
    EXPECT_EQ(event.event_class(), 1);
    ++in_order;
    handle(event);
  }
  std::vector<std::pair<Ticks, std::uint64_t>> handled;
  int in_order = 0;

 private:
  Engine& engine_;
  int left_;
};

TEST(Engine, HandlesTheSameWithOneHandlerAsWithHandlersByClass) {
  constexpr int events = 20'000;  // many are pending at a time
  Engine by_class;
  Spreader first(by_class, events);
  by_class.post(Event::make(0, 0, 0));
  by_class.run(events);
  Engine all;
  Spreader second(all, events);
  all.post(Event::make(0, 0, 0));
  all.run_all(second);
  EXPECT_EQ(first.handled, second.handled);
  EXPECT_EQ(first.handled.size(), std::size_t{events} + 1);
  EXPECT_EQ(by_class.events(), all.events());
  EXPECT_GT(second.in_order, 100);
  const auto earlier = [](const auto& a, const auto& b) { return a.first < b.first; };
  EXPECT_TRUE(std::is_sorted(first.handled.begin(), first.handled.end(), earlier));
}

// Each of many components posts its next event at a random distance, in either way. Counts the events before
// which both prepare() and, later, prepare_more() were called.
class Prepared final : public EventHandler {
 public:
  Prepared(Engine& engine, std::uint32_t components, bool in_order) : engine_(engine), in_order_(in_order) {
    engine_.attach(0, *this);
    for (std::uint32_t component = 0; component < components; ++component) {
      post(component, component);
    }
  }
  void handle(const Event& event) override {
    prepared += steps_[event.component()] == 2 ? 1 : 0;
    steps_[event.component()] = 0;
    if (++handled < 50'000) {
      post(event.component(), event.time + 4'000 + static_cast<Ticks>(random_() % (in_order_ ? 4 : 4'000)));
    }
  }
  void handle_in_order(const Event& event) { handle(event); }
  void prepare(const Event& event) override { steps_[event.component()] = 1; }
  void prepare_more(const Event& event) override {
    steps_[event.component()] += steps_[event.component()] == 1 ? 1 : 0;
  }
  int handled = 0;
  int prepared = 0;

 private:
  void post(std::uint32_t component, Ticks time) {
    const Event event = Event::make(time, 0, component);
    in_order_ ? engine_.post_in_order(event) : engine_.post(event);
  }

  Engine& engine_;
  bool in_order_;
  std::mt19937_64 random_{7};
  std::map<std::uint32_t, int> steps_;
};

TEST(Engine, PreparesForWhatComesNextWhereManyArePending) {
  for (const bool in_order : {true, false}) {
    for (const std::uint32_t components : {4096U, 64U}) {
      Engine engine;
      engine.reserve_for(components);
      Prepared handler(engine, components, in_order);
      engine.run_all(handler);
      EXPECT_GE(handler.handled, 50'000);
      if (components == 64) {
        EXPECT_EQ(handler.prepared, 0);
      } else {
        EXPECT_GT(handler.prepared, 45'000) << "in order: " << in_order;
      }
    }
  }
}

// A component that posts its next event `delay` ticks later, `left` times.
class Ticker final : public EventHandler {
 public:
  Ticker(Engine& engine, Ticks delay, int left) : engine_(engine), delay_(delay), left_(left) {}
  void handle(const Event& event) override {
    times.push_back(event.time);
    if (--left_ > 0) {
      engine_.post(Event::make(event.time + delay_, event.event_class(), event.component()));
    }
  }
  std::vector<Ticks> times;

 private:
  Engine& engine_;
  Ticks delay_;
  int left_;
};

TEST(Engine, HandsEventsOutInTimeAndCountsThem) {
  Engine engine;
  Ticker slow(engine, 5, 3);
  Ticker fast(engine, 2, 4);
  engine.attach(0, slow);
  engine.attach(1, fast);
  engine.post(Event::make(0, 0, 0));
  engine.post(Event::make(1, 1, 0));
  engine.run(10);
  EXPECT_EQ(slow.times, (std::vector<Ticks>{0, 5, 10}));
  EXPECT_EQ(fast.times, (std::vector<Ticks>{1, 3, 5, 7}));
  EXPECT_EQ(engine.events(), 7U);
  EXPECT_EQ(engine.now(), 10);
}

TEST(Engine, RefusesThePastAndUnknownClasses) {
  Engine engine;
  Ticker backwards(engine, -1, 2);
  engine.attach(0, backwards);
  engine.post(Event::make(3, 0, 0));
  EXPECT_THROW(engine.run(10), InternalError);
  Engine deaf;
  deaf.post(Event::make(0, 5, 0));
  EXPECT_THROW(deaf.run(10), InternalError);
}

TEST(Time, ArithmeticIsChecked) {
  constexpr Ticks most = std::numeric_limits<Ticks>::max();
  EXPECT_EQ(add_ticks(most - 5, 5), most);
  EXPECT_THROW(add_ticks(most - 5, 6), UserError);
  EXPECT_THROW(multiply_ticks(most / 2, 3), UserError);
  EXPECT_EQ(multiply_ticks(1'000'000, 1'000'000), 1'000'000'000'000);
}

TEST(Time, ClocksTurnIntoWholePeriodsOnce) {
  EXPECT_EQ(Clock::from_hertz(33e6).period(), 30303);
  EXPECT_EQ(Clock::from_hertz(1e12).period(), 1);
  EXPECT_EQ(Clock::from_hertz(1.0).cycles(2), 2 * ticks_per_second);
  EXPECT_THROW(Clock::from_hertz(0.5), UserError);
  EXPECT_THROW(Clock::from_hertz(2e12), UserError);
  EXPECT_THROW(Clock::from_hertz(std::numeric_limits<double>::quiet_NaN()), UserError);
  EXPECT_THROW(Clock::from_period(0), UserError);
}

}  // namespace
}  // namespace marti::sim
