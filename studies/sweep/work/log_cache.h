// The work logs of a sweep: kept in memory while there is room, and traced again when there was none.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>

#include "processors/program/work_log.h"
#include "studies/sweep/plan/sweep_row.h"

namespace marti::studies::sweep {

/// A functional run as a sweep keeps it: no image.
struct FrameLog {
  std::shared_ptr<const processors::program::WorkLog> log;
  FrameRow row;
};

/// Bytes of memory that a log takes, with what its vectors have in reserve.
[[nodiscard]] std::uint64_t memory_of(const processors::program::WorkLog& log);

/// Holds the logs of the frames a sweep works on, by the frame's index. Thread-safe.
///
/// What take() returns is in use until the last copy of that pointer is gone; the log inside must not be held
/// longer than it. Logs in use stay in memory; others make room, those first that were used longest ago.
class LogCache {
 public:
  /// Makes the log of one frame; each call must give an equal log.
  using Trace = std::function<FrameLog()>;

  /// `memory_limit`: bytes of all logs together; one log may always be there.
  explicit LogCache(std::uint64_t memory_limit);
  ~LogCache();
  LogCache(const LogCache&) = delete;
  LogCache& operator=(const LogCache&) = delete;

  /// Puts a new log into the cache; it is dropped if it does not fit beside those in use. A log that is
  /// already there stays. Never waits for room.
  void put(std::size_t frame, FrameLog log);
  /// The log of that frame: the one in the cache, or else what `trace` makes, one call at a time for each
  /// frame. If the log would exceed the limit, waits until other threads release theirs, so the calling
  /// thread must not hold a log. Throws what `trace` throws.
  [[nodiscard]] std::shared_ptr<const FrameLog> take(std::size_t frame, const Trace& trace);

  /// Bytes of the logs in memory and of those being traced again.
  [[nodiscard]] std::uint64_t in_memory() const;

 private:
  class Entries;
  std::shared_ptr<Entries> table_;  ///< shared with what is in use
};

}  // namespace marti::studies::sweep
