// Records the critical path of a frame while a replay is observed (docs/internals/model.md, The critical
// path).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "processors/machine/machine_config.h"
#include "processors/path/critical_path.h"
#include "processors/path/memory_course.h"
#include "processors/path/path_pieces.h"
#include "processors/path/ray_courses.h"
#include "processors/walk/cause_observer.h"
#include "processors/walk/observer.h"

namespace marti::processors::path {

/// Throws KeyError, naming record.critical_path, for a machine whose critical path is not recorded.
void check_critical_path(const machine::MachineConfig& config);

/// One object records one replay. The observer of the replay must be this object or pass all calls on to it.
class PathRecorder final : public walk::Observer, public walk::CauseObserver {
 public:
  /// What does not fit the budget ends the replay with a KeyError. `fold_from`: as PathPieces.
  explicit PathRecorder(const sim::MemoryBudget& budget, std::uint32_t fold_from = PathPieces::usual_fold)
      : pieces_(budget, fold_from) {}

  void begin(const walk::ReplayInput& input) override;
  void spent(std::uint32_t node, walk::NodeState state, sim::Ticks from, sim::Ticks to,
             walk::PixelPlace pixel) override;
  void end(sim::Ticks time) override;

  void worked(std::uint32_t node, const cost::NodeStatistics& statistics, walk::LogPlace place) override;
  void granted(std::uint32_t node, std::uint32_t context, sim::Ticks asked, sim::Ticks start) override;
  void prefetched(std::uint32_t node, std::uint32_t slot, sim::Ticks from, sim::Ticks to) override;
  void wait_ended(std::uint32_t node, std::uint32_t context, std::uint32_t slot) override;
  void began_frame(sim::Ticks start_up) override;
  void published(std::uint32_t builder, std::uint32_t waiter) override;
  void sent_camera_ray(std::uint32_t cluster, std::uint32_t to, sim::Ticks now) override;
  void set_aside(std::uint32_t ray, std::uint32_t sender, sim::Ticks now) override;
  void sent(const walk::RayMessage& message) override;
  void took(std::uint32_t node, std::uint32_t ray, sim::Ticks now) override;
  void let_go(std::uint32_t waiter, std::uint32_t by, sim::Ticks now) override;

  /// A transaction that a port, numbered through all clusters, asks for at `now`.
  [[nodiscard]] PathRequest request(std::uint32_t port, const memory::Transaction& transaction, bool write,
                                    sim::Ticks now);
  /// The chain of the port's read, which is known to be done at its end.
  void read_done(std::uint32_t port, PathTip done);
  /// The chain of the oldest write of the port's node that is not reported yet.
  void write_done(std::uint32_t port, PathTip done);
  [[nodiscard]] PathPieces& pieces() { return pieces_; }

  /// After the replay.
  [[nodiscard]] const CriticalPath& path() const { return path_; }
  /// After the replay, with PathPieces::no_fold: calls visit(piece) for the pieces of the path, the last one
  /// first.
  template <class Visit>
  void each_from_the_end(const Visit& visit) const {
    pieces_.each_from_the_end(last_, visit);
  }

 private:
  struct Node {
    PathTip begin;                 // up to the beginning of the frame
    PathTip tip;                   // up to what the node has done, or to where its wait began
    walk::LogPlace place;          // where it was then
    cost::TimeDivision seen{};     // what it had counted when it worked last
    cost::TimeDivision counted{};  // what it has counted now
    sim::Ticks waited = 0;         // transfers and bank accesses that it has waited for since it worked last
    sim::Ticks wait_end = 0;       // of its last wait
    walk::NodeState wait = walk::NodeState::idle;  // what it waited for last
    std::uint32_t context = 0;                     // that could go on when its last wait ended
    std::uint32_t slot = 0;                        // the port that this context had waited for
    std::uint64_t writes = 0;                      // that it has made
    std::uint64_t writes_done = 0;                 // of these, that are known to be done
  };

  // The chain of `node` up to `now`: when it has waited until then, that of what ended the wait.
  const PathTip& tip_at(std::uint32_t node, sim::Ticks now);
  // The chain of what ended the node's last wait.
  [[nodiscard]] const PathTip& end_of_wait(std::uint32_t node) const;
  void add_work(std::uint32_t node, sim::Ticks from, sim::Ticks to);
  // The chain of a node or of the host, up to `now`, at which it sends a ray or sets it aside.
  const PathTip& sending(std::uint32_t sender, sim::Ticks now);
  // The node goes on at `now`. If it has waited, that ended with `cause`.
  void go_on(std::uint32_t node, const PathTip& cause, sim::Ticks now);
  // The first chain that ends at `time`: a node's work, then a write, then a read that no node waits for; of
  // these that of the lowest node. Where rays move: a node's work, then a contribution.
  [[nodiscard]] PathTip first_that_ends_at(sim::Ticks time) const;
  [[nodiscard]] std::size_t entry_of(std::uint32_t node, std::uint64_t write) const {
    return node * write_buffer_ + write % write_buffer_;
  }

  PathPieces pieces_;
  cost::StepTicks ticks_;
  bool builds_ = false;
  bool asks_host_ = false;
  std::size_t contexts_ = 1;
  std::size_t ports_ = 1;  // of each node
  std::size_t write_buffer_ = 1;
  sim::Ticks host_latency_ = 0;
  sim::Ticks host_occupancy_ = 0;
  std::optional<LogLevels> levels_;  // during the replay
  std::vector<Node> nodes_;
  std::vector<PathTip> due_;        // by port: the last read or prefetch, or grant of a packet to a context
  std::vector<PathTip> writes_;     // node by node: the writes in its write buffer
  std::vector<PathTip> releases_;   // by worker: the write that published the branch it waited for last
  PathTip host_;                    // the request that the host has served last
  std::optional<RayCourses> rays_;  // where rays move, during the replay
  PathTip last_;
  CriticalPath path_;
};

}  // namespace marti::processors::path
