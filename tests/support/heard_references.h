// What the nodes of a machine refer to, and which pixels they write, node by node.
#pragma once

#include <algorithm>
#include <vector>

#include "processors/walk/packets_of_nodes.h"

namespace marti::test {

struct HeardReference : processors::walk::Request {
  memory::RecordKind kind = memory::RecordKind::pixel;
  bool hit = false;
};

/// Knows also which packets each node traces.
class HeardReferences final : public processors::walk::PacketsOfNodes {
 public:
  [[nodiscard]] bool hears_requests() const override { return true; }
  [[nodiscard]] bool hears_references() const override { return true; }
  void requested(const processors::walk::Request& request) override {
    if (request.write) {
      add({request, memory::RecordKind::pixel, false});
    }
  }
  void referred(const processors::walk::Request& reference, memory::RecordKind kind, bool hit) override {
    add({reference, kind, hit});
  }

  /// Calls `take` for each of a node's, in the order in which they were told.
  template <class Take>
  void for_each(std::uint32_t node, const Take& take) const {
    if (node < of_node_.size()) {
      for (const HeardReference& reference : of_node_[node]) {
        take(reference);
      }
    }
  }

 private:
  void add(const HeardReference& reference) {
    of_node_.resize(std::max<std::size_t>(of_node_.size(), reference.node + 1));
    of_node_[reference.node].push_back(reference);
  }

  std::vector<std::vector<HeardReference>> of_node_;
};

}  // namespace marti::test
