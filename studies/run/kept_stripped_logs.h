// Stripped logs of one frame, kept for the machines that are timed on it next.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "processors/walk/stripped_log.h"

namespace marti::studies::run {

/// Thread-safe.
class KeptStrippedLogs {
 public:
  /// That which suits the machine; null if none is kept.
  [[nodiscard]] std::shared_ptr<const processors::walk::StrippedLog> find(
      const processors::machine::MachineConfig& machine) {
    const std::lock_guard lock(mutex_);
    const auto found = std::ranges::find_if(logs_, [&](const auto& log) { return log->suits(machine); });
    if (found == logs_.end()) {
      return nullptr;
    }
    std::rotate(logs_.begin(), found, found + 1);
    return logs_.front();
  }
  /// Keeps this one, and of the others those used last.
  void keep(std::shared_ptr<const processors::walk::StrippedLog> log) {
    const std::lock_guard lock(mutex_);
    logs_.insert(logs_.begin(), std::move(log));
    logs_.resize(std::min(logs_.size(), most_kept));
  }

 private:
  static constexpr std::size_t most_kept = 2;

  std::mutex mutex_;
  std::vector<std::shared_ptr<const processors::walk::StrippedLog>> logs_;  // those used last are first
};

}  // namespace marti::studies::run
