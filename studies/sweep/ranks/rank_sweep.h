// A sweep on many ranks. Rank 0 holds the store and the schedule, hands out tasks, and works as well. A rank
// that times machines of a frame traced elsewhere traces it again: that takes about as long as timing one.
// Each rank's main thread sends and receives, its worker threads do not.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "studies/sweep/ranks/ranks.h"
#include "studies/sweep/work/coordinator.h"
#include "studies/sweep/work/sweep_worker.h"

namespace marti::studies {

/// Rank 0's part. Made before the Coordinator, whose `over` must call over().
class RankServer {
 public:
  RankServer(Ranks& ranks, const SweepPlan& plan);
  ~RankServer();

  /// Says that nobody needs that frame's log any more. May be called from any thread.
  void over(std::size_t frame);

  /// Gives the other ranks the configuration, works with `workers` threads of its own, and returns when
  /// everything is done and all ranks are ready to leave. Throws the error of any rank; the other ranks are
  /// still at work then, so call end_all_ranks(). UserError when another rank makes another plan of the
  /// configuration.
  void work(const SweepSite& site, Coordinator& coordinator, const std::string& configuration,
            unsigned workers);

 private:
  class Desk;
  std::unique_ptr<Desk> desk_;
};

/// Another rank's part: `prepare` makes of the configuration what is needed, and `over` is told that a
/// frame's log is not needed any more.
struct RankWork {
  std::function<const SweepSite&(const std::string& configuration)> prepare;
  std::function<void(std::size_t frame)> over;
  unsigned workers = 1;
};

/// Returns when rank 0 says so. An error is sent to rank 0, which ends the job; if it does not, the error is
/// thrown after a while.
void work_for_rank_0(Ranks& ranks, const RankWork& work);

}  // namespace marti::studies
