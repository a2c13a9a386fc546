// A sweep on many ranks. Rank 0 holds the store and the schedule, hands out tasks, and works as well. A rank
// that times machines of a frame traced elsewhere traces it again: that takes about as long as timing one.
// Each rank's main thread sends and receives, its worker threads do not.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "studies/sweep/ranks/ranks.h"
#include "studies/sweep/ranks/sweep_message.h"
#include "studies/sweep/work/coordinator.h"
#include "studies/sweep/work/sweep_worker.h"

namespace marti::studies::sweep {

/// Rank 0's part. Made before the Coordinator, whose `over` must call over().
class RankServer {
 public:
  RankServer(Ranks& ranks, const SweepPlan& plan);

  /// Says that nobody needs that frame's log any more. May be called from any thread.
  void over(std::size_t frame);

  /// Gives the other ranks the configuration, works with `workers` threads of its own, and returns when
  /// everything is done and all ranks are ready to leave. Throws the error of any rank; the other ranks are
  /// still at work then, so call end_all_ranks(). UserError when another rank makes another plan of the
  /// configuration.
  void work(SweepSite& site, Coordinator& coordinator, const std::string& configuration, unsigned workers);

 private:
  struct Client {
    bool left = false;
    std::set<std::size_t> logs;  // the frames whose logs it may have
  };

  void tell(std::size_t rank, const SweepMessage& message);
  [[nodiscard]] bool all_leave() const;
  /// Forgets logs, takes the messages that have come, and hands out tasks; returns whether it did any of
  /// that.
  bool step(const SweepSite& site, Coordinator& coordinator);
  bool forget_logs();
  bool hand_out(Coordinator& coordinator);
  void handle(const SweepSite& site, Coordinator& coordinator, std::size_t from, const SweepMessage& message);

  Ranks& ranks_;
  const std::string digest_;
  std::vector<Client> clients_;  // by rank; the first is not used
  std::deque<std::size_t> asking_;
  std::uint64_t workers_ = 0;  // of all ranks that are ready
  std::mutex mutex_;           // of what follows
  std::vector<std::size_t> over_;
};

/// Another rank's part, with so many worker threads: `prepare` makes of the configuration what they need.
/// Returns when rank 0 says so. An error is sent to rank 0, which ends the job; if it does not, the error is
/// thrown after a while.
void work_for_rank_0(Ranks& ranks, unsigned workers,
                     const std::function<SweepSite&(const std::string& configuration)>& prepare);

}  // namespace marti::studies::sweep
