// The references of a node in program order, before its cache, for other cache simulators.
#pragma once

#include <cstdint>
#include <functional>

#include "memory/layout.h"
#include "memory/record_kind.h"
#include "processors/walk/packets_of_nodes.h"

namespace marti::processors::passes {

/// One reference: a read of one line of a record (without a cache: of one interleave unit), at the first byte
/// of the record in that line; or the write of a whole pixel.
struct Reference {
  memory::RecordKind kind = memory::RecordKind::node;
  memory::Address address = 0;
  bool write = false;
};

/// Observes a replay to learn which node traces which packets; afterwards it walks each node's part of the
/// log again (processors/walk/packets_of_nodes.h says for which machines).
class ReferenceTrace final : public walk::PacketsOfNodes {
 public:
  /// Calls `take` for each reference of a node. Call it after the replay, while the log still exists.
  void for_each(std::uint32_t node, const std::function<void(const Reference&)>& take) const;
};

}  // namespace marti::processors::passes
