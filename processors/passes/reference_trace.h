// The references of a node in program order, before its cache, for other cache simulators.
#pragma once

#include <cstdint>
#include <functional>

#include "memory/layout.h"
#include "memory/record_kind.h"
#include "processors/walk/handed_out.h"

namespace marti::processors {

/// One reference: a read of one line of a record (of one interleave unit without a cache), from the first
/// byte of the record in it on; or the write of a pixel, whole.
struct Reference {
  memory::RecordKind kind = memory::RecordKind::node;
  memory::Address address = 0;
  bool write = false;
};

/// Watches a replay to learn which node traces which packets; afterwards it goes through each node's part of
/// the log again (processors/walk/handed_out.h says for which machines).
class ReferenceTrace final : public HandedOut {
 public:
  /// Calls `take` for each reference of a node. The log must still be there; the replay is over.
  void for_each(std::uint32_t node, const std::function<void(const Reference&)>& take) const;
};

}  // namespace marti::processors
