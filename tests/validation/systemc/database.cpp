#include "tests/validation/systemc/database.h"

#include <algorithm>

namespace marti::oracle {

namespace {

std::uint64_t round_up(std::uint64_t value, std::uint64_t multiple) {
  return (value + multiple - 1) / multiple * multiple;
}

}  // namespace

Database::Database(const memory::LayoutConfig& config, const processors::program::WorkLog& log)
    : config_(config),
      log_(log),
      record_of_(log.topology.nodes.size()),
      placed_(record_of_.size()),
      reached_(record_of_.size()) {
  std::uint64_t first = place(0);
  switch (config.node_order) {
    case memory::NodeOrder::breadth_first:
      for (std::uint32_t number = 1; number < record_of_.size(); ++number) {
        place(number);
      }
      break;
    case memory::NodeOrder::depth_first:
      place_below(0);
      break;
    case memory::NodeOrder::treelets:
      // The first treelet has the root's record, too.
      const std::uint64_t apart = round_up(config.node_bytes, config.record_alignment);
      const std::uint64_t most = std::max<std::uint64_t>(1, config.treelet_bytes / apart);
      place_treelet(0, most, first);
      break;
  }
  const std::uint64_t record = config.record_alignment;
  const std::uint64_t section = config.section_alignment;
  const std::uint64_t texels = log.texture_begin.empty() ? 0 : log.texture_begin.back();
  transforms_ = round_up(records_ * round_up(config.node_bytes, record), section);
  lists_ = round_up(transforms_ + instances_ * round_up(config.transform_bytes, record), section);
  triangles_ = round_up(lists_ + log.topology.entries.size() * config.entry_bytes, section);
  quadrics_ = triangles_ + log.triangles() * round_up(config.primitive_bytes, record);
  materials_ = round_up(quadrics_ + log.quadrics.size() * round_up(config.quadric_bytes, record), section);
  texels_ = round_up(materials_ + log.materials * round_up(config.material_bytes, record), section);
  pixels_ = round_up(texels_ + texels * config.texel_bytes, section);
}

bool Database::has_record(std::uint32_t number) const {
  return !(accel::walks_bvh(log_.traversal) && log_.topology.nodes[number].leaf);
}

// Gives the node the next record if it has one and none yet; returns how many records among nodes that are.
std::uint64_t Database::place(std::uint32_t number) {
  if (!has_record(number) || placed_[number]) {
    return 0;
  }
  placed_[number] = true;
  if (log_.topology.nodes[number].instance) {
    record_of_[number] = instances_++;
    return 0;
  }
  record_of_[number] = records_++;
  return 1;
}

void Database::place_children(std::uint32_t branch) {
  const accel::TopologyNode& node = log_.topology.nodes[branch];
  for (std::uint32_t child = 0; child < node.count; ++child) {
    place(node.first + child);
  }
}

// Depth-first: a branch's children in a row, then what is below the first of them, and so on.
void Database::place_below(std::uint32_t branch) {
  const accel::TopologyNode& node = log_.topology.nodes[branch];
  if (node.leaf) {
    return;
  }
  place_children(branch);
  for (std::uint32_t child = 0; child < node.count; ++child) {
    place_below(node.first + child);
  }
}

// What is below `top`, breadth-first, as far as it fits; then so from each branch whose children did not fit.
void Database::place_treelet(std::uint32_t top, std::uint64_t most, std::uint64_t used) {
  std::vector<std::uint32_t> treelet = {top};
  std::size_t next = 0;
  for (; next < treelet.size(); ++next) {
    const accel::TopologyNode& node = log_.topology.nodes[treelet[next]];
    if (node.leaf) {
      continue;
    }
    std::uint64_t records = 0;
    for (std::uint32_t child = 0; child < node.count; ++child) {
      const std::uint32_t number = node.first + child;
      records += has_record(number) && !log_.topology.nodes[number].instance && !placed_[number] ? 1 : 0;
    }
    if (used > 0 && used + records > most) {
      break;
    }
    used += records;
    place_children(treelet[next]);
    for (std::uint32_t child = 0; child < node.count; ++child) {
      if (const std::uint32_t number = node.first + child; !reached_[number]) {
        reached_[number] = true;
        treelet.push_back(number);
      }
    }
  }
  for (; next < treelet.size(); ++next) {
    if (!log_.topology.nodes[treelet[next]].leaf) {
      place_treelet(treelet[next], most, 0);
    }
  }
}

Extent Database::node(std::uint32_t number) const {
  return {record_of_[number] * round_up(config_.node_bytes, config_.record_alignment),
          has_record(number) ? config_.node_bytes : 0};
}

Extent Database::transform(std::uint32_t instance) const {
  return {transforms_ + record_of_[instance] * round_up(config_.transform_bytes, config_.record_alignment),
          config_.transform_bytes};
}

Extent Database::list(const accel::TopologyNode& leaf, std::uint32_t count) const {
  return {lists_ + std::uint64_t{leaf.first} * config_.entry_bytes,
          std::uint64_t{count} * config_.entry_bytes};
}

Extent Database::primitive(std::uint32_t id) const {
  if (id < log_.triangles()) {
    return {triangles_ + id * round_up(config_.primitive_bytes, config_.record_alignment),
            config_.primitive_bytes};
  }
  return {quadrics_ + (id - log_.triangles()) * round_up(config_.quadric_bytes, config_.record_alignment),
          config_.quadric_bytes};
}

Extent Database::material(std::uint32_t number) const {
  return {materials_ + number * round_up(config_.material_bytes, config_.record_alignment),
          config_.material_bytes};
}

Extent Database::texel(std::uint32_t texture, std::uint32_t texel) const {
  return {texels_ + (log_.texture_begin[texture] + texel) * config_.texel_bytes, config_.texel_bytes};
}

Extent Database::pixel(std::uint32_t x, std::uint32_t y) const {
  return {pixels_ + (std::uint64_t{y} * log_.width + x) * config_.pixel_bytes, config_.pixel_bytes};
}

}  // namespace marti::oracle
