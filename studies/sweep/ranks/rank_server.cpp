#include <algorithm>
#include <chrono>
#include <future>
#include <thread>
#include <utility>
#include <vector>

#include "sim/error.h"
#include "studies/sweep/ranks/rank_sweep.h"

namespace marti::studies::sweep {

namespace {

using Kind = SweepMessage::Kind;

// A task should take much longer than a message, but only a small part of the work that is left.
constexpr std::int64_t longest_task = 250'000'000;  // ns
constexpr std::int64_t tasks_left = 4;              // for each worker, at least

}  // namespace

RankServer::RankServer(Ranks& ranks, const SweepPlan& plan)
    : ranks_(ranks), digest_(digest_of(plan)), clients_(ranks.size()) {}

void RankServer::over(std::size_t frame) {
  const std::lock_guard guard(mutex_);
  over_.push_back(frame);
}

void RankServer::work(SweepSite& site, Coordinator& coordinator, const std::string& configuration,
                      unsigned workers) {
  workers_ = workers;
  for (std::size_t rank = 1; rank < clients_.size(); ++rank) {
    tell(rank, {.kind = Kind::begin, .bytes = configuration});
  }
  std::future<void> here = std::async(std::launch::async, [&] { work_together(site, coordinator, workers); });
  try {
    while (here.valid() || !all_leave()) {
      if (here.valid() && here.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
        here.get();  // throws what the workers have thrown
      }
      if (!step(site, coordinator)) {
        std::this_thread::sleep_for(pause);
      }
    }
  } catch (...) {
    coordinator.stop();
    throw;
  }
  for (std::size_t rank = 1; rank < clients_.size(); ++rank) {
    tell(rank, {.kind = Kind::goodbye});
  }
  ranks_.flush();
}

void RankServer::tell(std::size_t rank, const SweepMessage& message) { ranks_.send(rank, encode(message)); }

bool RankServer::all_leave() const {
  return std::all_of(clients_.begin() + 1, clients_.end(), [](const Client& client) { return client.left; });
}

bool RankServer::step(const SweepSite& site, Coordinator& coordinator) {
  bool busy = forget_logs();
  while (std::optional<Ranks::Message> message = ranks_.receive()) {
    handle(site, coordinator, message->from, decode_sweep_message(message->bytes));
    busy = true;
  }
  return hand_out(coordinator) || busy;
}

bool RankServer::forget_logs() {
  std::vector<std::size_t> frames;
  {
    const std::lock_guard guard(mutex_);
    frames.swap(over_);
  }
  for (const std::size_t frame : frames) {
    for (std::size_t rank = 1; rank < clients_.size(); ++rank) {
      if (clients_[rank].logs.erase(frame) != 0) {
        tell(rank, {.kind = Kind::drop, .number = frame});
      }
    }
  }
  return !frames.empty();
}

bool RankServer::hand_out(Coordinator& coordinator) {
  bool any = false;
  while (!asking_.empty()) {
    const std::int64_t part =
        coordinator.nanoseconds_left() / (tasks_left * static_cast<std::int64_t>(workers_));
    SweepTask task = coordinator.next(asking_.front(), std::min(part, longest_task), false);
    if (task.kind == SweepTask::Kind::wait) {
      break;
    }
    if (task.kind != SweepTask::Kind::end) {
      clients_[asking_.front()].logs.insert(task.frame);
    }
    tell(asking_.front(), {.kind = Kind::task, .task = std::move(task)});
    asking_.pop_front();
    any = true;
  }
  return any;
}

void RankServer::handle(const SweepSite& site, Coordinator& coordinator, std::size_t from,
                        const SweepMessage& message) {
  const std::string who = "rank " + std::to_string(from) + ": ";
  switch (message.kind) {
    case Kind::ready:
      if (message.bytes != digest_) {
        throw sim::UserError(who +
                             "makes other frames or machines of the same configuration: the program and the "
                             "files of scenes must be the same on all computers");
      }
      workers_ += message.number;
      return;
    case Kind::ask:
      asking_.push_back(from);
      return;
    case Kind::traced:
      sim::ensure(message.number < site.plan.frames.size(), "a rank has traced a frame that there is not");
      coordinator.traced(message.number, message.frame, message.nanoseconds);
      return;
    case Kind::timed:
      sim::ensure(message.number < site.plan.machines.size(), "a rank has timed a machine that there is not");
      coordinator.timed(message.number, message.machine, message.nanoseconds);
      return;
    case Kind::leaving:
      clients_[from].left = true;
      return;
    case Kind::failed:
      if (message.number == 0) {
        throw sim::InternalError(who + message.bytes);
      }
      throw sim::UserError(who + message.bytes);
    default:
      throw sim::InternalError(who + "said what only rank 0 says");
  }
}

}  // namespace marti::studies::sweep
