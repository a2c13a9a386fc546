// How many nodes of a cluster fetched each line.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "memory/line_bits.h"

namespace marti::memory {

/// Sums over all clusters; a line that two clusters use is two lines.
struct SharingResult {
  std::int64_t fetches = 0;
  std::int64_t distinct = 0;                      ///< lines that at least one node fetched
  std::map<std::uint32_t, std::int64_t> fetched;  ///< lines by the number of nodes that fetched them

  /// Fetches of lines that a node of the same cluster, perhaps the same node, had fetched before.
  [[nodiscard]] std::int64_t duplicates() const { return fetches - distinct; }
  /// Lines that exactly `nodes` nodes fetched.
  [[nodiscard]] std::int64_t by(std::uint32_t nodes) const {
    const auto at = fetched.find(nodes);
    return at == fetched.end() ? 0 : at->second;
  }
};

class LineSharing {
 public:
  LineSharing(std::uint32_t clusters, std::uint32_t nodes)
      : nodes_(nodes), fetched_by_(std::size_t{clusters} * nodes), users_(clusters) {}

  /// Nodes are numbered cluster by cluster.
  void fetch(std::uint32_t node, std::uint32_t line);

  [[nodiscard]] SharingResult result() const;

 private:
  std::uint32_t nodes_;
  std::int64_t fetches_ = 0;
  std::vector<LineBits> fetched_by_;
  std::vector<std::vector<std::uint32_t>> users_;  // for each cluster and line: number of nodes
};

}  // namespace marti::memory
