#include "processors/walk/left_out.h"

#include <algorithm>

#include "memory/line_set.h"

namespace marti::processors::walk {

const char* why_other_nodes(const machine::MachineConfig& config) {
  if (config.scheme != machine::Scheme::image) {
    return "rays move between nodes";
  }
  if (config.build.sharing != machine::Sharing::given) {
    return "the tree is built during the frame";
  }
  if (config.contexts > 1 || config.prefetch.on() || config.kind == machine::NodeKind::simt) {
    return "a node has several reads under way";
  }
  if (config.count.any()) {
    return "each reference is counted by what it is for";
  }
  return nullptr;
}

std::uint64_t lines_of(const memory::Layout& layout, std::uint32_t line_bytes) {
  memory::Address end = 0;
  for (std::size_t i = 0; i < memory::record_kinds; ++i) {
    const auto kind = static_cast<memory::RecordKind>(i);
    if (kind != memory::RecordKind::pixel) {  // pixels do not go through the caches
      end = std::max(end, layout.base(kind) + layout.section_bytes(kind));
    }
  }
  return (end + line_bytes - 1) / line_bytes;
}

const char* why_lookups(const machine::MachineConfig& config, const memory::Layout& layout) {
  if (const char* why = why_other_nodes(config)) {
    return why;
  }
  if (config.cache.organisation == machine::CacheOrganisation::none) {
    return "there is no cache";
  }
  if (config.cache.organisation == machine::CacheOrganisation::split) {
    return "each of the split caches sees a part of the lines only";
  }
  const memory::CacheShape shape = memory::shape_of(config.cache.cache);
  return memory::holds_all(shape, lines_of(layout, config.cache.cache.line))
             ? nullptr
             : "the database is larger than the cache or than the ways of a set";
}

const char* why_read_events(const machine::MachineConfig& config) {
  if (const char* why = why_other_nodes(config)) {
    return why;
  }
  if (config.placement != machine::Placement::shared) {
    return "the database is not in a shared memory";
  }
  if (config.l2.sharing != machine::SecondLevel::none) {
    return "there is a second level of caches";
  }
  return config.interconnect.kind == memory::InterconnectKind::ideal
             ? nullptr
             : "reads and posted writes may wait for each other";
}

}  // namespace marti::processors::walk
