#include "tests/validation/systemc/database.h"

#include <numeric>

namespace marti::oracle {

namespace {

std::uint64_t round_up(std::uint64_t value, std::uint64_t multiple) {
  return (value + multiple - 1) / multiple * multiple;
}

}  // namespace

Database::Database(const memory::LayoutConfig& config, const processors::WorkLog& log)
    : config_(config), log_(log), record_of_(log.topology.nodes.size()) {
  std::iota(record_of_.begin(), record_of_.end(), 0U);
  if (config.node_order == memory::NodeOrder::depth_first) {
    std::uint32_t next = 1;
    place_children(0, next);
  }
  const std::uint64_t record = config.record_alignment;
  const std::uint64_t section = config.section_alignment;
  const std::uint64_t texels = log.texture_begin.empty() ? 0 : log.texture_begin.back();
  lists_ = round_up(log.topology.nodes.size() * round_up(config.node_bytes, record), section);
  triangles_ = round_up(lists_ + log.topology.entries.size() * config.entry_bytes, section);
  quadrics_ = triangles_ + log.triangles() * round_up(config.primitive_bytes, record);
  materials_ = round_up(quadrics_ + log.quadrics.size() * round_up(config.quadric_bytes, record), section);
  texels_ = round_up(materials_ + log.materials * round_up(config.material_bytes, record), section);
  pixels_ = round_up(texels_ + texels * config.texel_bytes, section);
}

// Depth-first: a branch's children in a row, then what is below the first of them, and so on.
void Database::place_children(std::uint32_t branch, std::uint32_t& next) {
  const accel::TopologyNode& node = log_.topology.nodes[branch];
  if (node.leaf) {
    return;
  }
  for (std::uint32_t child = 0; child < node.count; ++child) {
    record_of_[node.first + child] = next++;
  }
  for (std::uint32_t child = 0; child < node.count; ++child) {
    place_children(node.first + child, next);
  }
}

Extent Database::node(std::uint32_t number) const {
  return {record_of_[number] * round_up(config_.node_bytes, config_.record_alignment), config_.node_bytes};
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
