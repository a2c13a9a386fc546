// The stripped logs of a sweep: each made once, by the first machine of its batch.
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "processors/walk/stripped_log.h"

namespace marti::studies::sweep {

/// Thread-safe. Keeps those used last.
class StrippedLogCache {
 public:
  /// `most_bytes`: of all stripped logs together, except those still in use when others are made.
  explicit StrippedLogCache(std::uint64_t most_bytes) : most_bytes_(most_bytes) {}

  /// The log stripped for the machine; null where that is impossible, takes too much memory, or does not pay
  /// because only `sharing` machines use the pass that strips it. The first that asks makes it together with
  /// those for `ways`, ascending, which must include the machine's; other threads that ask for one of them
  /// wait.
  [[nodiscard]] std::shared_ptr<const processors::walk::StrippedLog> get(
      std::size_t frame, const std::shared_ptr<const processors::program::WorkLog>& log,
      const processors::machine::MachineConfig& machine, std::size_t sharing,
      std::span<const std::uint32_t> ways);

  /// Says that nobody will ask for this frame's stripped logs again.
  void drop(std::size_t frame);

  /// Stripping a log takes less time than it saves for this many machines, some of them with LRU caches.
  static constexpr std::size_t fewest_machines = 2;
  /// The number where only references to the newest line can be taken out.
  static constexpr std::size_t fewest_without_lru = 4;
  /// Whether a pass pays that serves so many machines. `lru`: it strips a log for LRU caches.
  [[nodiscard]] static constexpr bool pays(std::size_t sharing, bool lru) {
    return sharing >= (lru ? fewest_machines : fewest_without_lru);
  }
  /// This many passes are kept, their logs together of at most their part of the memory.
  static constexpr std::size_t most_kept = 2;

 private:
  struct Entry {
    std::size_t frame = 0;
    std::string key;
    std::mutex making;
    bool made = false;
    std::vector<std::uint32_t> ways;
    std::vector<std::shared_ptr<const processors::walk::StrippedLog>> logs;  // one for each of `ways`
  };

  void make(Entry& entry, const processors::program::WorkLog& log,
            const processors::machine::MachineConfig& machine, std::span<const std::uint32_t> ways) const;

  std::uint64_t most_bytes_;
  std::mutex mutex_;
  std::list<std::shared_ptr<Entry>> entries_;  // those used last are first
};

}  // namespace marti::studies::sweep
