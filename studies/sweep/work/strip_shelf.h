// The stripped logs of a sweep: each made once, by the first machine of its batch.
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <string>

#include "processors/walk/stripped_log.h"

namespace marti::studies {

/// Thread-safe. Keeps those used last.
class StripShelf {
 public:
  /// `most_bytes`: of all stripped logs together, except those still in use when others are made.
  explicit StripShelf(std::uint64_t most_bytes) : most_bytes_(most_bytes) {}

  /// The log stripped for the machine; null where that is impossible, takes too much memory, or does not pay
  /// because only `sharing` machines use it. Other threads that ask for the same one wait.
  [[nodiscard]] std::shared_ptr<const processors::StrippedLog> get(
      std::size_t frame, const std::shared_ptr<const processors::WorkLog>& log,
      const processors::MachineConfig& machine, std::size_t sharing);

  /// Says that nobody will ask for this frame's stripped logs again.
  void drop(std::size_t frame);

  /// Stripping a log takes about as long as it saves for this many machines.
  static constexpr std::size_t fewest_machines = 4;
  /// This many are kept, each of at most its part of the memory.
  static constexpr std::size_t most_kept = 2;

 private:
  struct Entry {
    std::size_t frame = 0;
    std::string key;
    std::mutex making;
    bool made = false;
    std::shared_ptr<const processors::StrippedLog> log;
  };

  std::uint64_t most_bytes_;
  std::mutex mutex_;
  std::list<std::shared_ptr<Entry>> entries_;  // those used last are first
};

}  // namespace marti::studies
