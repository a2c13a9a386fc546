#include "processors/walk/node_order.h"

#include <algorithm>

namespace marti::processors::walk {

std::uint32_t treelet_records(const memory::LayoutConfig& layout) {
  return std::max(1U, static_cast<std::uint32_t>(layout.treelet_bytes / layout.node_stride()));
}

std::vector<std::uint32_t> node_rank(const accel::Topology& topology, bool leaf_records,
                                     const memory::LayoutConfig& layout) {
  switch (layout.node_order) {
    case memory::NodeOrder::breadth_first:
      return leaf_records ? std::vector<std::uint32_t>{} : accel::breadth_first_rank(topology, leaf_records);
    case memory::NodeOrder::depth_first:
      return accel::depth_first_rank(topology, leaf_records);
    case memory::NodeOrder::treelets:
      break;
  }
  return accel::treelets_of(topology, leaf_records, treelet_records(layout)).rank;
}

}  // namespace marti::processors::walk
