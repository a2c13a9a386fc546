// The second-level caches as the rest of a machine sees them.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "memory/bank.h"
#include "memory/cache.h"
#include "memory/tag_array.h"
#include "processors/cost/accounting.h"
#include "processors/machine/machine_config.h"
#include "processors/machine/second_level_config.h"
#include "sim/time.h"

namespace marti::processors::walk {

/// The configuration of a cluster's banks, with the shared cache before them if the machine has one.
[[nodiscard]] memory::BankConfig banks_of(const machine::MachineConfig& config);

/// What the second level counted: an entry for each node (private) or each cluster (shared).
struct SecondLevelResult {
  std::vector<memory::CacheCounters> caches;
  std::vector<memory::WaitStatistics> waits;  ///< shared only

  [[nodiscard]] memory::CacheCounters counters() const;
};

/// The private second-level caches of all nodes. A cache is looked up only where the first level missed; if
/// it misses too, the line is brought into both levels. Neither level depends on what the other holds: the
/// second is neither inclusive nor exclusive.
class PrivateSecondLevel {
 public:
  /// Not present unless the machine has private second-level caches.
  explicit PrivateSecondLevel(const machine::MachineConfig& config);

  [[nodiscard]] bool present() const { return tags_.has_value(); }

  /// Looks up a line that `node`'s first level does not hold. True when the second level holds it: the
  /// time of a hit is then added to `time` and to the division. False also where there is no second
  /// level.
  bool access(std::uint32_t node, std::uint32_t line, sim::Ticks& time, cost::TimeDivision& division) {
    if (!look_up(node, line)) {
      return false;
    }
    division[static_cast<std::size_t>(cost::Activity::cache_access)] += hit_ticks_;
    time = sim::add_ticks(time, hit_ticks_);
    return true;
  }
  /// As access(), but the node does not wait: for a prefetch. The time of a hit; nothing where access() is
  /// false.
  std::optional<sim::Ticks> hit(std::uint32_t node, std::uint32_t line) {
    return look_up(node, line) ? std::optional(hit_ticks_) : std::nullopt;
  }
  /// Removes a line; returns how many copies there were.
  std::int64_t remove(std::uint32_t node, std::uint32_t line) {
    return tags_ && tags_->remove(node, line) ? 1 : 0;
  }

  [[nodiscard]] SecondLevelResult result() const { return {counters_, {}}; }

 private:
  bool look_up(std::uint32_t node, std::uint32_t line) {
    if (!tags_) {
      return false;
    }
    const bool hit = tags_->access(node, line);
    ++(hit ? counters_[node].hits : counters_[node].misses);
    return hit;
  }

  sim::Ticks hit_ticks_ = 0;
  std::optional<memory::TagArray> tags_;
  std::vector<memory::CacheCounters> counters_;
};

}  // namespace marti::processors::walk
