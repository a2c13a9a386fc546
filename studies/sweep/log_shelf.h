// The work logs of a sweep: in memory while they are used, on disk where memory is short or where they are
// kept for the next sweep.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "studies/sweep/log_file.h"

namespace marti::studies {

/// Holds the logs of the frames a sweep works on. Thread-safe. Keys are 32 hexadecimal digits.
///
/// What find_kept() and take() return is in use until the last copy of that pointer is gone; the log inside
/// must not be held longer than it. Logs in use stay in memory; others make room, those first that were used
/// longest ago.
///
/// Waiting: where a log would exceed the limit, the caller waits until others let go of theirs. So that this
/// ends, whoever asks for a log while holding another one must have taken that one itself, in the same
/// thread. A thread then never waits for itself or in a circle: when all that hold logs are waiting, the
/// last of them gets its log all the same, beyond the limit.
class LogShelf {
 public:
  struct Options {
    std::uint64_t memory_limit = 0;  ///< bytes of logs in memory; one log may always be there
    std::filesystem::path spill;  ///< an existing directory for logs that do not fit; files are removed again
    std::filesystem::path cache;  ///< a directory where logs are kept for the next sweep; empty: none
  };
  /// Makes the cache directory if need be. In both directories it removes what killed programs have left.
  explicit LogShelf(Options options);
  ~LogShelf();
  LogShelf(const LogShelf&) = delete;
  LogShelf& operator=(const LogShelf&) = delete;

  /// The log kept under `key` by an earlier sweep, if there is a whole one of this program's version; it is
  /// on the shelf then, as if by put(). Null if there is none. A file that is damaged or of another version
  /// is as none; `note` says so, and is empty otherwise. Waits as take() does. find_kept() and put() of one
  /// key are not to be called at the same time.
  [[nodiscard]] std::shared_ptr<const FrameLog> find_kept(const std::string& key, std::string& note);
  /// Puts a new log on the shelf, and into the cache directory if there is one. Where it does not fit beside
  /// those in use, it goes to disk. One that is there already stays. Never waits for room. Throws UserError
  /// when it had to go to disk and cannot; it is not on the shelf then. Nobody else may hold the log.
  void put(const std::string& key, FrameLog log);
  /// The log of that key, read back from disk if need be, when there is room for it: waits for it. Throws
  /// UserError when it cannot be read back, or when another one had to make room for it and cannot be
  /// written, InternalError when no such log is on the shelf.
  [[nodiscard]] std::shared_ptr<const FrameLog> take(const std::string& key);
  /// Nobody will take it again: its memory and its spilled file are free when the last user lets go.
  void drop(const std::string& key);

  /// What went wrong since the last call without harm to the results: the cache directory cannot be written,
  /// or a log in it cannot be used.
  [[nodiscard]] std::vector<std::string> notes();

  /// Bytes of the logs in memory.
  [[nodiscard]] std::uint64_t in_memory() const;

 private:
  class Book;
  std::shared_ptr<Book> book_;  ///< shared with what is in use
};

}  // namespace marti::studies
