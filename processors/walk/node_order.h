// In which order the node records of a log's tree lie in memory.
#pragma once

#include <cstdint>
#include <vector>

#include "accel/record_order.h"
#include "memory/layout.h"

namespace marti::processors::walk {

using accel::no_record;

/// The most node records of a treelet.
[[nodiscard]] std::uint32_t treelet_records(const memory::LayoutConfig& layout);

/// The record number of each node by the layout; empty when it is the node number.
[[nodiscard]] std::vector<std::uint32_t> node_rank(const accel::Topology& topology, bool leaf_records,
                                                   const memory::LayoutConfig& layout);

}  // namespace marti::processors::walk
