#include "processors/walk/cache_counting.h"
#include "processors/walk/law.h"

#include <string>
#include <string_view>

#include "sim/key_error.h"
#include "sim/units.h"

namespace marti::processors::walk {

namespace {

std::uint64_t lines_of(const machine::FirstLevelCache& first) { return first.cache.size / first.cache.line; }

}  // namespace

std::uint64_t CacheCounting::host_bytes(const machine::MachineConfig& config, std::uint64_t lines) {
  std::uint64_t bytes = 0;
  if (config.count.sharing) {
    // For each node a bit for each line, and for each cluster a number.
    bytes += config.all_nodes() * (lines / 8) + config.clusters * lines * sizeof(std::uint32_t);
  }
  if (config.count.miss_classes) {
    // Two bits for each line, and a fully associative cache as large as the node's: hashed, 28 bytes a line.
    for (const machine::FirstLevelCache& first : machine::first_level_caches(config.cache)) {
      bytes += config.all_nodes() * (lines / 4 + 28 * lines_of(first));
    }
  }
  return bytes;  // at most 2^24 nodes, 2^32 lines of memory and 2^28 of a cache: no overflow
}

CacheCounting::CacheCounting(const machine::MachineConfig& config, std::uint64_t lines) {
  if (host_bytes(config, lines) > most_bytes) {
    throw sim::KeyError(std::string(machine::key_of(config.count)),
                        "[count] would take more than " +
                            sim::print_size(static_cast<std::int64_t>(most_bytes)) +
                            " for so many nodes and so large a database; count on a smaller machine");
  }
  if (config.count.miss_classes) {
    for (const machine::FirstLevelCache& first : machine::first_level_caches(config.cache)) {
      classifiers_.emplace_back(lines_of(first), config.all_nodes());
    }
  }
  if (config.count.sharing) {
    sharing_.emplace(config.clusters, config.nodes);
  }
  if (config.count.attribution) {
    attribution_.emplace();
  }
}

void CacheCounting::refer(std::uint32_t node, std::size_t cache, memory::RecordKind record,
                          std::uint32_t line, Origin origin, bool hit, bool own) {
  if (!classifiers_.empty()) {
    if (hit) {
      classifiers_[cache].hit(node, line);
    } else {
      const memory::MissClass why = classifiers_[cache].miss(node, line);
      ++classes_[static_cast<std::size_t>(record)][static_cast<std::size_t>(why)];
    }
  }
  if (sharing_ && !hit) {
    if (own) {
      ++own_misses_;
    } else {
      sharing_->fetch(node, line);
    }
  }
  if (attribution_) {
    AttributionCounts& counts = attribution_->at(record, origin);
    ++counts.references;
    counts.misses += hit ? 0 : 1;
  }
}

void CacheCounting::bring_in(std::uint32_t node, std::size_t cache, std::uint32_t line) {
  if (!classifiers_.empty()) {
    (void)classifiers_[cache].miss(node, line);
  }
  if (sharing_) {
    sharing_->fetch(node, line);
  }
}

void CacheCounting::written(std::uint32_t node, std::size_t cache, std::uint32_t line, bool held) {
  if (!classifiers_.empty()) {
    classifiers_[cache].written(node, line, held);
  }
}

void CacheCounting::second_level_hit(memory::RecordKind record, Origin origin) {
  if (attribution_) {
    ++attribution_->at(record, origin).second_level_hits;
  }
}

void CacheCounting::wait(memory::RecordKind record, Origin origin, const memory::Service& service) {
  if (attribution_) {
    attribution_->wait(record, origin, service);
  }
}

CacheCountResult CacheCounting::result() const {
  CacheCountResult result;
  if (!classifiers_.empty()) {
    result.miss_classes = classes_;
  }
  if (sharing_) {
    result.sharing = sharing_->result();
    result.own_misses = own_misses_;
  }
  if (attribution_) {
    result.attribution = attribution_->rows();
  }
  return result;
}

void check_counts(const CacheCountResult& counts, const cost::ReferenceCounts& references,
                  std::int64_t prefetches, const cost::TimeSums& time, bool one_by_one) {
  if (counts.miss_classes) {
    for (std::size_t kind = 0; kind < memory::record_kinds; ++kind) {
      std::int64_t misses = 0;
      for (const std::int64_t of_class : (*counts.miss_classes)[kind]) {
        misses += of_class;
      }
      require(misses == references.misses[kind], "every miss has one class");
    }
  }
  if (counts.sharing) {
    require(
        counts.sharing->fetches + counts.own_misses == references.all_misses() + prefetches,
        "every miss and every prefetch fetches a line, one of the node's own or one that others may have");
  }
  if (counts.attribution) {
    cost::ReferenceCounts sum;
    AttributionCounts all;
    for (const AttributionRow& row : *counts.attribution) {
      const auto kind = static_cast<std::size_t>(row.record);
      sum.hits[kind] += row.counts.references - row.counts.misses;
      sum.misses[kind] += row.counts.misses;
      sim::merge(all, row.counts);
    }
    require(sum.hits == references.hits && sum.misses == references.misses,
            "the references attributed are those of the nodes, kind by kind");
    const auto part = [&](cost::Activity activity) { return time[static_cast<std::size_t>(activity)]; };
    require(!one_by_one || (all.interconnect_wait == part(cost::Activity::interconnect_wait) &&
                            all.transfer == part(cost::Activity::transfer) &&
                            all.bank_wait == part(cost::Activity::bank_wait) &&
                            all.bank_access == part(cost::Activity::bank_access)),
            "the waits attributed are those of the nodes");
  }
}

}  // namespace marti::processors::walk
