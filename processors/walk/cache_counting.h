// Counts what a run is asked to count about caches beside hits and misses.
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

namespace marti::processors {

/// What was asked for and found; the rest has no value.
struct CacheCountResult {
  using ByClass = std::array<std::int64_t, memory::miss_classes>;
  std::optional<std::array<ByClass, memory::record_kinds>> miss_classes{};
  std::optional<memory::SharingResult> sharing{};
  std::optional<std::vector<AttributionRow>> attribution{};
};

class CacheCounting {
 public:
  /// `lines` is one past the last line of memory. Throws UserError when the host's memory that the counting
  /// may take is beyond `most_bytes`.
  CacheCounting(const MachineConfig& config, std::uint64_t lines);

  /// A reference of a node to a line of one of its caches (0 unless they are split).
  void refer(std::uint32_t node, std::size_t cache, memory::RecordKind record, std::uint32_t line,
             Origin origin, bool hit);
  void second_level_hit(memory::RecordKind record, Origin origin);
  /// The node waited for a miss.
  void wait(memory::RecordKind record, Origin origin, const memory::Service& service);

  [[nodiscard]] CacheCountResult result() const;

  static constexpr std::uint64_t most_bytes = std::uint64_t{4} << 30U;

 private:
  std::vector<memory::MissClassifier> classifiers_;  // one for each cache of a node
  std::array<CacheCountResult::ByClass, memory::record_kinds> classes_{};
  std::optional<memory::LineSharing> sharing_;
  std::optional<Attribution> attribution_;
};

/// Throws InternalError unless the counts add up to those of the nodes.
void check_counts(const CacheCountResult& counts, const ReferenceCounts& references,
                  const TimeDivision& time);

}  // namespace marti::processors
