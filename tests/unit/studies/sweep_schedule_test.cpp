// The order of a sweep's tasks: random plans, workers that end in random orders, and a plain account of the
// tasks that each was given.
#include "studies/sweep/work/schedule.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <vector>

#include "processors/walk/stripped_log.h"
#include "sim/error.h"

namespace marti::studies {

using namespace sweep;

namespace {

using Random = std::mt19937_64;
using Kind = SweepTask::Kind;

std::size_t below(Random& random, std::size_t end) { return static_cast<std::size_t>(random() % end); }

std::pair<std::size_t, std::string> batch_key(const SweepMachine& machine) {
  return {machine.frame, processors::walk::StrippedLog::key_of(machine.config)};
}

// Machines of one batch have the same line; one without a cache shares nothing with others than such. Some
// machines of a batch have equal timings.
SweepPlan random_sweep(Random& random) {
  SweepPlan plan;
  plan.frames.resize(1 + below(random, 6));
  for (std::size_t frame = 0; frame < plan.frames.size(); ++frame) {
    for (std::size_t left = below(random, 4) == 0 ? 0 : below(random, 25); left > 0; --left) {
      SweepMachine& machine = plan.machines.emplace_back();
      machine.frame = frame;
      machine.config.cache.cache.line = 16U << below(random, 4);
      machine.config.nodes = 1 + static_cast<std::uint32_t>(below(random, 9));
      if (below(random, 8) == 0) {
        machine.config.cache.organisation = processors::machine::CacheOrganisation::none;
      }
    }
  }
  std::shuffle(plan.machines.begin(), plan.machines.end(), random);
  std::stable_sort(plan.machines.begin(), plan.machines.end(),
                   [](const SweepMachine& a, const SweepMachine& b) { return a.frame < b.frame; });
  for (std::size_t i = 0; i < plan.machines.size(); ++i) {
    const std::size_t other = below(random, i + 1);
    const bool alike = batch_key(plan.machines[other]) == batch_key(plan.machines[i]);
    plan.machines[i].timing = other != i && alike ? plan.machines[other].timing : i;
  }
  return plan;
}

// The state of a batch as seen from outside.
struct Batch {
  std::set<std::size_t> waiting;
  std::size_t size = 0;
  std::optional<std::size_t> place;
  std::int64_t spent = 0;
  std::int64_t timed = 0;
};

class Account {
 public:
  Account(SweepPlan plan, std::vector<bool> machines_done, std::vector<bool> frames_done)
      : plan_(std::move(plan)), schedule_(plan_, machines_done, frames_done) {
    left_.resize(plan_.frames.size());
    for (std::size_t machine = 0; machine < plan_.machines.size(); ++machine) {
      if (!machines_done[machine]) {
        Batch& batch = batch_of(machine);
        batch.waiting.insert(machine);
        ++batch.size;
        ++left_[plan_.machines[machine].frame];
        ++machines_left_;
      }
    }
    for (std::size_t frame = 0; frame < plan_.frames.size(); ++frame) {
      if (left_[frame] != 0 || !frames_done[frame]) {
        to_trace_.insert(frame);
      }
    }
  }

  // Asks for a task and checks that it may be given. A free function's assertions would not name the rule.
  SweepTask next(std::size_t place, std::int64_t nanoseconds) {
    const std::vector<const Batch*> offered = offered_batches();
    const std::size_t ahead = logs_ahead();
    const SweepTask task = schedule_.next(place, nanoseconds);
    switch (task.kind) {
      case Kind::trace:
        RC_ASSERT(!to_trace_.empty());
        RC_ASSERT(task.frame == *to_trace_.begin());  // in order, each once
        RC_ASSERT(ahead == 0 || (ahead == 1 && offered.empty()));
        to_trace_.erase(task.frame);
        tracing_.insert(task.frame);
        RC_ASSERT(logs_ahead() <= 2);
        break;
      case Kind::time:
        take(task, place, nanoseconds, offered);
        break;
      case Kind::wait:
        RC_ASSERT(offered.empty());
        RC_ASSERT(to_trace_.empty() || ahead >= 2);
        break;
      case Kind::end:
        RC_ASSERT(schedule_.finished());
        RC_ASSERT(machines_left_ == 0);
        RC_ASSERT(to_trace_.empty() && tracing_.empty());
        break;
    }
    return task;
  }

  void traced(std::size_t frame, std::int64_t nanoseconds) {
    RC_ASSERT(!schedule_.over(frame));
    schedule_.traced(frame, nanoseconds);
    tracing_.erase(frame);
    there_.insert(frame);
    RC_ASSERT(schedule_.over(frame) == (left_[frame] == 0));
  }

  void timed(std::size_t machine, std::int64_t nanoseconds) {
    const std::size_t frame = plan_.machines[machine].frame;
    RC_ASSERT(!schedule_.over(frame));
    RC_ASSERT(schedule_.timed(machine, nanoseconds) == frame);
    Batch& batch = batch_of(machine);
    batch.spent += nanoseconds;
    ++batch.timed;
    spent_ += nanoseconds;
    ++timed_;
    --left_[frame];
    --machines_left_;
    RC_ASSERT(schedule_.over(frame) == (left_[frame] == 0));
    RC_ASSERT(schedule_.machines_left() == machines_left_);
  }

  [[nodiscard]] const Schedule& schedule() const { return schedule_; }

 private:
  Batch& batch_of(std::size_t machine) { return batches_[batch_key(plan_.machines[machine])]; }

  [[nodiscard]] std::vector<const Batch*> offered_batches() const {
    std::vector<const Batch*> offered;
    for (const auto& [key, batch] : batches_) {
      if (!batch.waiting.empty() && there_.contains(key.first)) {
        offered.push_back(&batch);
      }
    }
    return offered;
  }

  // Frames being traced, or traced with machines that no worker has taken.
  [[nodiscard]] std::size_t logs_ahead() const {
    std::set<std::size_t> frames = tracing_;
    for (const auto& [key, batch] : batches_) {
      if (!batch.waiting.empty() && there_.contains(key.first)) {
        frames.insert(key.first);
      }
    }
    return frames.size();
  }

  [[nodiscard]] std::int64_t cost(const Batch& batch) const {
    return batch.timed != 0 ? batch.spent / batch.timed : timed_ != 0 ? spent_ / timed_ : 0;
  }

  void take(const SweepTask& task, std::size_t place, std::int64_t nanoseconds,
            const std::vector<const Batch*>& offered) {
    RC_ASSERT(!task.machines.empty());
    RC_ASSERT(there_.contains(task.frame));
    Batch& batch = batch_of(task.machines.front());
    RC_ASSERT(std::find(offered.begin(), offered.end(), &batch) != offered.end());
    RC_ASSERT(task.sharing == batch.size);
    const auto any = [&](const auto& holds) {
      return std::any_of(offered.begin(), offered.end(), [&](const Batch* other) { return holds(*other); });
    };
    if (batch.place != place) {
      RC_ASSERT(!any([&](const Batch& other) { return other.place == place; }));
      if (batch.place.has_value()) {
        RC_ASSERT(!any([](const Batch& other) { return !other.place.has_value(); }));
        const auto work = [&](const Batch& one) {
          return static_cast<std::int64_t>(one.waiting.size()) * (cost(one) + 1);
        };
        RC_ASSERT(!any([&](const Batch& other) { return work(other) > work(batch); }));
      } else {
        batch.place = place;
      }
    }
    const std::int64_t each = std::max<std::int64_t>(1, cost(batch));
    for (const std::size_t machine : task.machines) {
      RC_ASSERT(&batch_of(machine) == &batch);
      RC_ASSERT(batch.waiting.erase(machine) == 1);
    }
    const auto timing = [&](std::size_t machine) { return plan_.machines[machine].timing; };
    std::set<std::size_t> complete;  // timings of which all machines were given
    for (std::size_t i = 0; i < task.machines.size(); ++i) {
      const std::size_t one = timing(task.machines[i]);
      RC_ASSERT(!complete.contains(one));
      RC_ASSERT(std::none_of(batch.waiting.begin(), batch.waiting.end(),
                             [&](std::size_t machine) { return timing(machine) == one; }));
      if (i + 1 < task.machines.size() && timing(task.machines[i + 1]) != one) {
        complete.insert(one);
      }
    }
    // As many machines as fit in the time, at least one, and one while no time of the batch is known; and all
    // others of the last one's timing.
    const auto given = static_cast<std::int64_t>(task.machines.size());
    const auto before = std::count_if(task.machines.begin(), task.machines.end(), [&](std::size_t machine) {
      return timing(machine) != timing(task.machines.back());
    });
    RC_ASSERT(before == 0 || (batch.timed != 0 && (before + 1) * each <= nanoseconds));
    RC_ASSERT(batch.waiting.empty() || batch.timed == 0 || (given + 1) * each > nanoseconds);
  }

  SweepPlan plan_;
  Schedule schedule_;
  std::map<std::pair<std::size_t, std::string>, Batch> batches_;
  std::vector<std::size_t> left_;  // of each frame
  std::size_t machines_left_ = 0;
  std::set<std::size_t> to_trace_;
  std::set<std::size_t> tracing_;
  std::set<std::size_t> there_;
  std::int64_t spent_ = 0;
  std::int64_t timed_ = 0;
};

struct Worker {
  std::size_t place = 0;
  SweepTask task{Kind::wait, 0, {}, 0};
  bool sleeps = false;  // until a frame has been traced, or all is done
};

// Lets some worker, at random, do its next step until all have ended.
void run(Random& random, Account& account, std::size_t places, std::size_t workers) {
  std::vector<Worker> all(workers);
  for (Worker& worker : all) {
    worker.place = below(random, places);
  }
  const auto wake = [&] {
    for (Worker& worker : all) {
      worker.sleeps = false;
    }
  };
  for (;;) {
    std::vector<Worker*> awake;
    bool all_ended = true;
    for (Worker& worker : all) {
      all_ended = all_ended && worker.task.kind == Kind::end;
      if (!worker.sleeps && worker.task.kind != Kind::end) {
        awake.push_back(&worker);
      }
    }
    if (all_ended) {
      return;
    }
    RC_ASSERT(!awake.empty());  // else all would wait for ever
    Worker& worker = *awake[below(random, awake.size())];
    if (worker.task.kind == Kind::trace) {
      account.traced(worker.task.frame, static_cast<std::int64_t>(below(random, 5000)));
      worker.task.kind = Kind::wait;
      wake();
    } else if (worker.task.kind == Kind::time && !worker.task.machines.empty()) {
      account.timed(worker.task.machines.back(), static_cast<std::int64_t>(below(random, 1000)));
      worker.task.machines.pop_back();
      if (account.schedule().finished()) {
        wake();
      }
    } else {
      worker.task = account.next(worker.place, static_cast<std::int64_t>(below(random, 3000)));
      worker.sleeps = worker.task.kind == Kind::wait;
    }
  }
}

RC_GTEST_PROP(SweepSchedule, HandsOutEveryMachineOnceWhenItsLogIsThere, (std::uint64_t seed)) {
  Random random(seed);
  const SweepPlan plan = random_sweep(random);
  const std::size_t share = below(random, 5);  // of what an earlier run has done
  std::vector<bool> machines_done(plan.machines.size());
  std::vector<bool> frames_done(plan.frames.size());
  for (std::size_t machine = 0; machine < machines_done.size(); ++machine) {
    machines_done[machine] = below(random, 4) < share;
    // No machine is done whose frame is not.
    frames_done[plan.machines[machine].frame] =
        frames_done[plan.machines[machine].frame] || machines_done[machine];
  }
  for (std::size_t frame = 0; frame < frames_done.size(); ++frame) {
    frames_done[frame] = frames_done[frame] || below(random, 4) < share;
  }
  Account account(plan, machines_done, frames_done);
  run(random, account, 1 + below(random, 3), 1 + below(random, 6));
  RC_ASSERT(account.schedule().finished());
  RC_ASSERT(account.schedule().machines_left() == 0U);
  RC_ASSERT(account.schedule().frames_left() == 0U);
  RC_ASSERT(account.schedule().nanoseconds_left() == 0);
}

TEST(SweepSchedule, EstimatesWhatIsLeft) {
  SweepPlan plan;
  plan.frames.resize(2);
  plan.machines.resize(6);
  for (std::size_t i = 0; i < plan.machines.size(); ++i) {
    plan.machines[i].timing = i;
  }
  plan.machines[5].frame = 1;
  plan.machines[3].config.cache.cache.line = plan.machines[4].config.cache.cache.line = 128;
  Schedule schedule(plan, std::vector<bool>(6), std::vector<bool>(2));
  ASSERT_EQ(schedule.next(0).kind, Kind::trace);
  EXPECT_EQ(schedule.nanoseconds_left(), 0) << "nothing is known";
  schedule.traced(0, 1000);
  EXPECT_EQ(schedule.nanoseconds_left(), 1000) << "the other frame";
  const SweepTask first = schedule.next(0);
  ASSERT_EQ(first.machines, std::vector<std::size_t>{0}) << "in the plan's order";
  EXPECT_EQ(first.sharing, 3U);
  schedule.timed(0, 50);
  EXPECT_EQ(schedule.nanoseconds_left(), 1000 + 5 * 50) << "all cost the mean";
  EXPECT_EQ(schedule.next(0, 100).machines, (std::vector<std::size_t>{1, 2}));
  EXPECT_EQ(schedule.nanoseconds_left(), 1000 + 3 * 50) << "without what is under way";
  ASSERT_EQ(schedule.next(1).machines, std::vector<std::size_t>{3});
  schedule.timed(3, 10);
  EXPECT_EQ(schedule.nanoseconds_left(), 1000 + 10 + 30) << "its own batch's mean, and that of all";
}

// Frames of very different sizes: what the first frame has cost says what the second will.
TEST(SweepSchedule, EstimatesWhatIsLeftInProportion) {
  SweepPlan plan;
  plan.frames.resize(2);
  plan.machines.resize(6);
  for (std::size_t i = 0; i < plan.machines.size(); ++i) {
    plan.machines[i].frame = i / 3;
    plan.machines[i].timing = i;
  }
  Schedule schedule(plan, std::vector<bool>(6), std::vector<bool>(2), {{0.25, 2.5}, {0.5, 10.0}});
  EXPECT_EQ(schedule.nanoseconds_left(), 0) << "nothing is measured yet";
  ASSERT_EQ(schedule.next(0).kind, Kind::trace);
  schedule.traced(0, 7);
  EXPECT_EQ(schedule.nanoseconds_left(), 70) << "the other frame";
  EXPECT_EQ(schedule.nanoseconds_under_way(), 0);
  const SweepTask first = schedule.next(0);
  const SweepTask second = schedule.next(0);
  ASSERT_EQ(second.machines.size(), 1U);
  EXPECT_EQ(schedule.nanoseconds_under_way(), 0) << "no machine is measured yet";
  schedule.timed(first.machines.front(), 100);
  EXPECT_EQ(schedule.nanoseconds_under_way(), 100);
  EXPECT_EQ(schedule.nanoseconds_left(), 100 + 3 * 2000 + 70);
  schedule.timed(second.machines.front(), 300);
  EXPECT_EQ(schedule.nanoseconds_under_way(), 0);
  EXPECT_EQ(schedule.nanoseconds_left(), 200 + 3 * 4000 + 70);
}

TEST(SweepSchedule, RefusesResultsThatNobodyWasToBring) {
  SweepPlan plan;
  plan.frames.resize(1);
  plan.machines.resize(1);
  Schedule schedule(plan, {false}, {false});
  EXPECT_THROW(schedule.traced(0, 1), sim::InternalError);
  ASSERT_EQ(schedule.next(0).kind, Kind::trace);
  schedule.traced(0, 1);
  ASSERT_EQ(schedule.next(0).kind, Kind::time);
  schedule.timed(0, 1);
  EXPECT_THROW(schedule.timed(0, 1), sim::InternalError);
}

TEST(SweepSchedule, EndsAtOnceWhenAllIsDone) {
  SweepPlan plan;
  plan.frames.resize(1);
  plan.machines.resize(3);
  Schedule schedule(plan, std::vector<bool>(3, true), {true});
  EXPECT_EQ(schedule.next(0).kind, Kind::end);
  // Only its row is missing.
  Schedule row(plan, std::vector<bool>(3, true), {false});
  EXPECT_EQ(row.next(0).kind, Kind::trace);
  EXPECT_EQ(row.next(0).kind, Kind::wait);
  row.traced(0, 1);
  EXPECT_TRUE(row.over(0));
  EXPECT_EQ(row.next(0).kind, Kind::end);
}

}  // namespace
}  // namespace marti::studies
