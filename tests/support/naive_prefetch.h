// What a SIMT node prefetches and what becomes of it, written for plainness from docs/internals/rt-unit.md.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <optional>
#include <set>
#include <utility>

#include "memory/record_kind.h"
#include "processors/walk/context_result.h"

namespace marti::test {

/// A line of one of a node's caches.
using NaiveLine = std::pair<std::size_t, std::uint64_t>;

class NaivePrefetch {
 public:
  struct Waiting {
    memory::RecordKind kind;
    NaiveLine line;
  };

  explicit NaivePrefetch(std::size_t room) : room_(room) {}

  void wish(memory::RecordKind kind, const NaiveLine& line) {
    const bool waits = std::any_of(queue_.begin(), queue_.end(),
                                   [&](const Waiting& waiting) { return waiting.line == line; });
    if (!waits && queue_.size() < room_) {
      queue_.push_back({kind, line});
    } else if (!waits) {
      ++counts_.dropped;
    }
  }
  [[nodiscard]] std::optional<Waiting> next() {
    if (queue_.empty()) {
      return std::nullopt;
    }
    const Waiting first = queue_.front();
    queue_.pop_front();
    return first;
  }
  void no_register() { ++counts_.dropped; }
  void issued(const NaiveLine& line) {
    ++counts_.issued;
    issued_.insert(line);
  }

  enum class Found { hit, joined, missed };
  void looked_up(const NaiveLine& line, Found found) {
    if (issued_.erase(line) > 0) {
      counts_.useful += found == Found::missed ? 0 : 1;
      counts_.late += found == Found::joined ? 1 : 0;
    }
  }

  [[nodiscard]] processors::walk::ContextCounts counts() const {
    processors::walk::ContextCounts counts = counts_;
    counts.useless = counts.issued - counts.useful;
    return counts;
  }

 private:
  std::size_t room_;
  std::deque<Waiting> queue_;
  std::set<NaiveLine> issued_;  // and not looked up since
  processors::walk::ContextCounts counts_;
};

}  // namespace marti::test
