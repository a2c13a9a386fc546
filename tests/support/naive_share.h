// Lanes that trace a ray together, written for plainness from docs/internals/rt-unit.md (Lanes that help each
// other) and accel/bvh_meets.h, which says what a ray meets.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "tests/support/naive_simt_log.h"

namespace marti::test {

/// Distances are ranks.
inline constexpr std::int64_t nothing_hit = std::numeric_limits<std::int64_t>::max();

struct NaiveSharedRay {
  std::span<const std::uint32_t> meets;
  bool shadow = false;
  std::int64_t best = nothing_hit;   ///< hits found in earlier cycles
  std::int64_t found = nothing_hit;  ///< in this cycle, too
  int lanes = 0;                     ///< that have an entry or a test
  std::int64_t began = 0;
};

class NaiveSharedLane {
 public:
  struct Entry {
    std::int64_t rank = 0;
    std::uint32_t node = 0;
    std::size_t at = 0;  ///< in the ray's words
  };

  NaiveSharedLane() = default;
  NaiveSharedLane(std::shared_ptr<NaiveSharedRay> of, const Entry& first)
      : ray(std::move(of)), entries{first} {
    ++ray->lanes;
  }

  std::shared_ptr<NaiveSharedRay> ray;
  std::vector<Entry> entries;  ///< the one that was added first comes first

  /// The test of a record has ended; the next record, or null: the lane has nothing to do.
  std::optional<NaiveVisit> next(const WorkLog& log, const NaiveSimtLog& program) {
    if (visited_ && next_ > 0) {
      end_test(log);
    }
    const std::int64_t limit = std::min(ray->best, own_);
    if (ray->shadow && limit != nothing_hit) {
      visit_.clear();
      entries.clear();
      return std::nullopt;
    }
    while (next_ == visit_.size()) {
      const std::optional<Entry> entry = take(log, program, limit);
      if (!entry) {
        return std::nullopt;
      }
      begin_visit(*entry, log, program);
    }
    return visit_[next_++];
  }

 private:
  void end_test(const WorkLog& log) {
    const Entry& entry = *visited_;
    const accel::TopologyNode& node = log.topology.nodes[entry.node];
    const std::span<const std::uint32_t> words = ray->meets.subspan(entry.at);
    if (!node.leaf) {
      const accel::EnteredChildren met(words[0]);
      std::vector<Entry> entered;
      for (std::uint32_t k = 0; k < met.count(); ++k) {
        if (words[1 + 2 * k] <= std::min(ray->best, own_)) {
          entered.push_back({words[1 + 2 * k], node.first + met[k], words[2 + 2 * k]});
        }
      }
      if (log.order != accel::WalkOrder::breadth_first) {
        std::reverse(entered.begin(), entered.end());
      }
      entries.insert(entries.end(), entered.begin(), entered.end());
    } else if (visit_[next_ - 1].record->kind == memory::RecordKind::primitive) {
      for (std::uint32_t hit = 0; hit < words[0]; ++hit) {
        if (words[1 + 2 * hit] == tested_) {
          own_ = std::min<std::int64_t>(own_, words[2 + 2 * hit]);
          ray->found = std::min(ray->found, own_);
        }
      }
      ++tested_;
    }
  }
  std::optional<Entry> take(const WorkLog& log, const NaiveSimtLog& program, std::int64_t limit) {
    while (!entries.empty()) {
      auto at = log.order == accel::WalkOrder::breadth_first ? entries.begin() : entries.end() - 1;
      if (log.order == accel::WalkOrder::treelet_first && visited_) {
        const auto here = std::find_if(entries.rbegin(), entries.rend(), [&](const Entry& entry) {
          return program.treelet_of(entry.node) == program.treelet_of(visited_->node);
        });
        at = here != entries.rend() ? here.base() - 1 : at;
      }
      const Entry entry = *at;
      entries.erase(at);
      if (entry.rank <= limit) {
        return entry;
      }
    }
    return std::nullopt;
  }
  void begin_visit(const Entry& entry, const WorkLog& log, const NaiveSimtLog& program) {
    const accel::TopologyNode& node = log.topology.nodes[entry.node];
    const std::uint32_t hits = node.leaf ? ray->meets[entry.at] : 0;
    visit_ =
        program.node_visit(entry.node, ray->shadow && hits > 0 ? ray->meets[entry.at + 1] + 1 : node.count);
    const std::uint32_t treelet = program.treelet_of(entry.node);
    for (NaiveVisit& visit : visit_) {
      visit.treelet = treelet;
    }
    if (visited_ && program.treelet_of(visited_->node) != treelet) {
      visit_.front().wishes = program.wishes_for(treelet);
    }
    visited_ = entry;
    next_ = 0;
    tested_ = 0;
  }

  std::int64_t own_ = nothing_hit;  // hits that the lane has found
  std::optional<Entry> visited_;
  std::vector<NaiveVisit> visit_;  // its records
  std::size_t next_ = 0;           // of these
  std::uint32_t tested_ = 0;
};

}  // namespace marti::test
