// Who does what next in a sweep: book-keeping without threads, files or clocks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "studies/sweep/plan/sweep_plan.h"

namespace marti::studies::sweep {

/// What a worker is to do.
struct SweepTask {
  enum class Kind : std::uint8_t {
    trace,  ///< make the frame's log and put it into the cache of logs
    time,   ///< time `machines`, all of one frame, whose log is there
    wait,   ///< no task now: ask again when something has been traced
    end     ///< no more tasks
  };
  Kind kind = Kind::end;
  std::size_t frame = 0;
  std::vector<std::size_t> machines{};  ///< indices into SweepPlan::machines
  /// How many machines of this sweep share the pass that strips these machines' log
  /// (processors/walk/stripped_log.h), and for which ways, ascending, it strips the log.
  std::size_t sharing = 0;
  std::vector<std::uint32_t> ways{};
};

/// Machines of a frame whose logs can be stripped in one pass form a batch. A place (a process, with all its
/// threads) is given machines of one batch as long as there are any, then a new batch, then some of the batch
/// with the most work left. One log is traced ahead of the machines that are being timed, so that nobody
/// waits when a frame comes to its end. Costs are measured: the mean time of the batch's machines, or else of
/// all machines, in the proportions that were estimated for their frames.
class Schedule {
 public:
  /// The plan must outlive it. `machines_done` and `frames_done` as SweepStore gives them. A frame whose
  /// machines are all done is traced only if its row is not there. `estimated`: only the proportions of its
  /// figures count.
  Schedule(const SweepPlan& plan, const std::vector<bool>& machines_done,
           const std::vector<bool>& frames_done, FrameCosts estimated = {});

  /// The next task of `place`: machines that take about `nanoseconds` together, at least one, and with it the
  /// others of its timing.
  [[nodiscard]] SweepTask next(std::size_t place, std::int64_t nanoseconds = 0);

  // Both are called when a task is done.
  void traced(std::size_t frame, std::int64_t cpu_nanoseconds);
  /// Returns the machine's frame.
  std::size_t timed(std::size_t machine, std::int64_t cpu_nanoseconds);

  /// Whether all machines of the frame are timed, so that nobody needs its log.
  [[nodiscard]] bool over(std::size_t frame) const;
  /// Whether everything is done.
  [[nodiscard]] bool finished() const;
  [[nodiscard]] std::size_t machines_left() const { return machines_left_; }
  [[nodiscard]] std::size_t frames_left() const { return frames_left_; }
  /// Estimated processor time of what is neither done nor under way; 0 while nothing is known.
  [[nodiscard]] std::int64_t nanoseconds_left() const;
  /// Of what is under way, from its beginning to its end.
  [[nodiscard]] std::int64_t nanoseconds_under_way() const;

 private:
  enum class Trace : std::uint8_t { waiting, under_way, done };
  struct Batch {
    std::size_t frame = 0;
    std::vector<std::size_t> machines;  // to be handed out, the last first
    std::vector<std::uint32_t> ways;    // of the stripped logs of all its machines, ascending
    std::size_t size = 0;               // with those handed out
    std::size_t place = no_place;       // the place that has it
    std::int64_t spent = 0;
    std::int64_t timed = 0;
  };
  struct Frame {
    Trace trace = Trace::waiting;
    std::size_t left = 0;  // machines not timed yet
    std::size_t to_hand_out = 0;
    std::vector<std::size_t> batches;
  };
  static constexpr std::size_t no_place = static_cast<std::size_t>(-1);

  [[nodiscard]] std::int64_t cost_of(const Batch& batch) const;
  [[nodiscard]] std::int64_t tracing_of(Trace state) const;
  [[nodiscard]] std::size_t choose_batch(std::size_t place) const;
  [[nodiscard]] std::size_t frame_to_trace() const;

  // The mean cost of something of a frame, where all that is done has cost `spent`.
  static std::int64_t share_of(const std::vector<double>& estimated, std::size_t frame, std::int64_t spent,
                               double estimated_of_done, std::int64_t done);

  const SweepPlan& plan_;
  FrameCosts estimated_;
  std::vector<Frame> frames_;
  std::vector<Batch> batches_;
  std::vector<std::size_t> batch_of_;  // of each machine
  std::size_t machines_left_ = 0;
  std::size_t frames_left_ = 0;
  std::int64_t timed_ = 0;
  std::int64_t spent_ = 0;
  double estimated_timing_ = 0.0;  // of the machines that are timed
  std::int64_t traced_ = 0;
  std::int64_t spent_tracing_ = 0;
  double estimated_tracing_ = 0.0;  // of the frames that are traced
};

}  // namespace marti::studies::sweep
