#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <new>
#include <thread>
#include <utility>
#include <vector>

#include "sim/error.h"
#include "studies/sweep/ranks/rank_sweep.h"

namespace marti::studies::sweep {

namespace {

using Kind = SweepMessage::Kind;

constexpr auto patience = std::chrono::seconds(30);  // for rank 0 to end the job

/// Between the workers and the main thread: tasks go one way, results the other.
class TaskMailbox final : public TaskSource {
 public:
  // For the workers.
  SweepTask next() override {
    std::unique_lock lock(mutex_);
    news_.wait(lock, [&] { return !tasks_.empty() || ended_; });
    if (tasks_.empty()) {
      return {};
    }
    SweepTask task = std::move(tasks_.front());
    tasks_.pop_front();
    return task;
  }
  void traced(std::size_t frame, const FrameRow& row, std::int64_t cpu_nanoseconds) override {
    put({.kind = Kind::traced, .number = frame, .nanoseconds = cpu_nanoseconds, .frame = row});
  }
  void timed(std::size_t machine, const SweepRow& row, std::int64_t cpu_nanoseconds) override {
    put({.kind = Kind::timed, .number = machine, .nanoseconds = cpu_nanoseconds, .machine = row});
  }
  void stop() override {
    const std::lock_guard guard(mutex_);
    tasks_.clear();
    ended_ = true;
    news_.notify_all();
  }

  // For the main thread.
  void add(SweepTask task) {
    const std::lock_guard guard(mutex_);
    if (ended_) {
      return;
    }
    if (task.kind == SweepTask::Kind::trace) {
      tasks_.push_front(std::move(task));  // other tasks wait for a trace
    } else {
      tasks_.push_back(std::move(task));
    }
    news_.notify_one();
  }
  void end() {
    const std::lock_guard guard(mutex_);
    ended_ = true;
    news_.notify_all();
  }
  void finished() {
    const std::lock_guard guard(mutex_);
    finished_ = true;
    to_send_.notify_one();
  }
  struct State {
    std::vector<SweepMessage> results;
    std::size_t tasks = 0;  // not yet taken
    bool finished = false;  // the workers have ended, and these are their last results
  };
  /// Sleeps for a moment unless there are results.
  State look() {
    std::unique_lock lock(mutex_);
    to_send_.wait_for(lock, pause, [&] { return !results_.empty(); });
    return {std::exchange(results_, {}), tasks_.size(), finished_};
  }

 private:
  void put(SweepMessage result) {
    const std::lock_guard guard(mutex_);
    results_.push_back(std::move(result));
    to_send_.notify_one();
  }

  std::mutex mutex_;
  std::condition_variable news_;
  std::condition_variable to_send_;
  std::deque<SweepTask> tasks_;
  std::vector<SweepMessage> results_;
  bool ended_ = false;
  bool finished_ = false;
};

class RankClient {
 public:
  RankClient(Ranks& ranks, unsigned workers, SweepSite& site)
      : ranks_(ranks), workers_(workers), site_(site) {}

  void run() {
    tell({.kind = Kind::ready, .number = workers_, .bytes = digest_of(site_.plan)});
    std::exception_ptr error;
    const std::jthread workers([&] {
      try {
        work_together(site_, mailbox_, workers_);
      } catch (...) {
        error = std::current_exception();
      }
      mailbox_.finished();
    });
    try {
      bool left = false;
      while (!goodbye_) {
        const TaskMailbox::State state = mailbox_.look();
        for (const SweepMessage& result : state.results) {
          tell(result);
        }
        if (state.finished && error != nullptr) {
          std::rethrow_exception(error);
        }
        // Asks ahead, so that each worker finds its next task when it has done one.
        std::size_t known = state.tasks + asked_;
        for (; !ended_ && known < workers_; ++known, ++asked_) {
          tell({.kind = Kind::ask});
        }
        while (std::optional<Ranks::Message> message = ranks_.receive()) {
          handle(decode_sweep_message(message->bytes));
        }
        if (state.finished && asked_ == 0 && !left) {
          tell({.kind = Kind::leaving});
          left = true;
        }
      }
      ranks_.flush();
    } catch (...) {
      mailbox_.stop();
      throw;
    }
  }

 private:
  void tell(const SweepMessage& message) { ranks_.send(0, encode(message)); }

  void handle(SweepMessage message) {
    switch (message.kind) {
      case Kind::task:
        sim::ensure(asked_ != 0, "a task that was not asked for");
        --asked_;
        take(std::move(message.task));
        return;
      case Kind::drop:
        site_.drop(message.number);
        return;
      case Kind::goodbye:
        goodbye_ = true;
        return;
      default:
        throw sim::InternalError("rank 0 said what only others say");
    }
  }

  void take(SweepTask task) {
    if (task.kind == SweepTask::Kind::end) {
      ended_ = true;
      mailbox_.end();
    } else {
      mailbox_.add(std::move(task));
    }
  }

  Ranks& ranks_;
  unsigned workers_;
  SweepSite& site_;
  TaskMailbox mailbox_;
  std::size_t asked_ = 0;  // tasks under way
  bool ended_ = false;
  bool goodbye_ = false;
};

}  // namespace

void work_for_rank_0(Ranks& ranks, unsigned workers,
                     const std::function<SweepSite&(const std::string& configuration)>& prepare) {
  SweepMessage failure{.kind = Kind::failed};
  std::exception_ptr error;
  try {
    const SweepMessage begin = decode_sweep_message(ranks.wait().bytes);
    sim::ensure(begin.kind == Kind::begin, "rank 0 does not begin with the configuration");
    RankClient(ranks, workers, prepare(begin.bytes)).run();
    return;
  } catch (const sim::UserError& user) {
    failure.number = 1;
    failure.bytes = user.what();
    error = std::current_exception();
  } catch (const std::bad_alloc&) {
    failure.number = 1;
    failure.bytes = "not enough memory for this scene or machine";
    error = std::current_exception();
  } catch (const std::exception& internal) {
    failure.bytes = internal.what();
    error = std::current_exception();
  }
  ranks.send(0, encode(failure));
  const auto end = std::chrono::steady_clock::now() + patience;
  while (std::chrono::steady_clock::now() < end) {
    static_cast<void>(ranks.receive());  // so that the message gets under way
    std::this_thread::sleep_for(pause);
  }
  std::rethrow_exception(error);
}

}  // namespace marti::studies::sweep
