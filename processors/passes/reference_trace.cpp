#include "processors/passes/reference_trace.h"

#include <span>

#include "processors/walk/log_walker.h"

namespace marti::processors::passes {

namespace {

// A cache that never holds a line: the walk stops at every reference.
struct EmptyCaches : walk::NoCaches {
  static constexpr bool present = true;
};

template <class Caches>
void walk_packets(const walk::ReplayInput& input, std::span<const std::uint64_t> packets,
                  const std::function<void(const Reference&)>& take) {
  walk::LogWalker<Caches> walker(input, Caches{});
  cost::NodeStatistics statistics;
  walk::for_each_pixel(input, packets, [&](walk::Cursor& cursor, std::uint32_t x, std::uint32_t y) {
    while (walker.template advance<true>(0, cursor, statistics) == walk::Stop::miss) {
      take({cursor.kind, cursor.at, false});
      walker.pass(cursor);
    }
    const std::uint64_t pixel = std::uint64_t{y} * input.log.width + x;
    take({memory::RecordKind::pixel, input.layout.address(memory::RecordKind::pixel, pixel), true});
  });
}

}  // namespace

void ReferenceTrace::for_each(std::uint32_t node, const std::function<void(const Reference&)>& take) const {
  const walk::ReplayInput walked = input(true);
  if (walked.config.cache.organisation == machine::CacheOrganisation::none) {
    walk_packets<walk::NoCaches>(walked, packets_of(node), take);
  } else {
    walk_packets<EmptyCaches>(walked, packets_of(node), take);
  }
}

}  // namespace marti::processors::passes
