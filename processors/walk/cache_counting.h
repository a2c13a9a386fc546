// Counts of the caches beyond hits and misses, as far as the configuration asks for them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "memory/line_sharing.h"
#include "memory/miss_classes.h"
#include "processors/cost/accounting.h"
#include "processors/machine/machine_config.h"
#include "processors/walk/attribution.h"

namespace marti::processors::walk {

/// The counts that were asked for; the others have no value.
struct CacheCountResult {
  using ByClass = std::array<std::int64_t, memory::miss_classes>;
  std::optional<std::array<ByClass, memory::record_kinds>> miss_classes{};
  std::optional<memory::SharingResult> sharing{};
  std::int64_t own_misses =
      0;  ///< with `sharing`: misses of lines that no other node can have, no case of it
  std::optional<std::vector<AttributionRow>> attribution{};
};

class CacheCounting {
 public:
  /// Bytes of the host's memory that counting may take. `lines` is one past the last line of memory.
  [[nodiscard]] static std::uint64_t host_bytes(const machine::MachineConfig& config, std::uint64_t lines);

  /// Throws KeyError when the counting may take more than `most_bytes` of the host's memory.
  CacheCounting(const machine::MachineConfig& config, std::uint64_t lines);

  /// Counts a reference of a node to a line of its cache number `cache` (0 unless the caches are split).
  /// `own`: no other node has this line, not even a copy, so it is no case of sharing.
  void refer(std::uint32_t node, std::size_t cache, memory::RecordKind record, std::uint32_t line,
             Origin origin, bool hit, bool own = false);
  /// Counts a prefetch of a line that the cache did not hold. It is a fetch; later misses are classed as if
  /// the line had been in the cache since.
  void bring_in(std::uint32_t node, std::size_t cache, std::uint32_t line);
  /// Another node has written the line. `held`: the cache had it, and the write has removed it.
  void written(std::uint32_t node, std::size_t cache, std::uint32_t line, bool held);
  void second_level_hit(memory::RecordKind record, Origin origin);
  /// Counts the time that a node waited for a miss.
  void wait(memory::RecordKind record, Origin origin, const memory::Service& service);

  [[nodiscard]] CacheCountResult result() const;

  static constexpr std::uint64_t most_bytes = std::uint64_t{4} << 30U;

 private:
  std::vector<memory::MissClassifier> classifiers_;  // one for each cache of a node
  std::array<CacheCountResult::ByClass, memory::record_kinds> classes_{};
  std::optional<memory::LineSharing> sharing_;
  std::int64_t own_misses_ = 0;  // where sharing is counted
  std::optional<Attribution> attribution_;
};

/// Throws InternalError unless the counts add up to those of the nodes, which have asked for `prefetches`
/// lines beside their misses. `one_by_one`: a node waits for one read at a time, so that its waits are those
/// of its reads.
void check_counts(const CacheCountResult& counts, const cost::ReferenceCounts& references,
                  std::int64_t prefetches, const cost::TimeSums& time, bool one_by_one = true);

}  // namespace marti::processors::walk
