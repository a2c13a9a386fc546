// Lines that a node prefetches when it has nothing else to look up, and what became of them
// (docs/internals/rt-unit.md, Prefetching into the unit).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>

#include "memory/record_kind.h"
#include "processors/simt/line_registers.h"
#include "processors/walk/context_result.h"
#include "processors/walk/lines_under_way.h"

namespace marti::processors::simt {

class PrefetchQueue {
 public:
  struct Line {
    LineRegisters::Key key = 0;
    std::uint32_t unit = 0;
    memory::RecordKind kind = memory::RecordKind::node;
  };

  /// `room`: the most lines that wait.
  explicit PrefetchQueue(std::size_t room) : room_(room) {}

  /// Puts a line in, unless it waits already.
  void put(const Line& line) {
    if (std::any_of(lines_.begin(), lines_.end(), [&](const Line& other) { return other.key == line.key; })) {
      return;
    }
    if (lines_.size() == room_) {
      ++counts_.dropped;
    } else {
      lines_.push_back(line);
    }
  }
  [[nodiscard]] bool empty() const { return lines_.empty(); }
  /// Takes the first line out.
  Line take() {
    const Line first = lines_.front();
    lines_.pop_front();
    return first;
  }

  /// The line that was taken out finds no register.
  void drop() { ++counts_.dropped; }
  /// It is asked for.
  void ask(LineRegisters::Key key) {
    ++counts_.issued;
    counts_.useless += asked_.mark(key) ? 1 : 0;
  }
  /// A line is looked up that is in the cache or under way (`there`), or is not.
  void look_up(LineRegisters::Key key, bool there, bool under_way) {
    if (asked_.unmark(key)) {
      ++(there ? counts_.useful : counts_.useless);
      counts_.late += under_way ? 1 : 0;
    }
  }
  /// Lines that nobody has looked up since are useless.
  [[nodiscard]] walk::ContextCounts counts() const {
    walk::ContextCounts counts = counts_;
    counts.useless += static_cast<std::int64_t>(asked_.unasked());
    return counts;
  }

 private:
  std::size_t room_;
  std::deque<Line> lines_;
  walk::LinesUnderWay asked_;  // keeps which lines were prefetched and not looked up since
  walk::ContextCounts counts_;
};

}  // namespace marti::processors::simt
