#include "processors/passes/pixel_figures.h"

#include <optional>
#include <utility>

#include "processors/walk/log_walker.h"
#include "processors/walk/node_caches.h"
#include "processors/walk/record_places.h"
#include "sim/error.h"

namespace marti::processors::passes {

namespace {

// Walks one pixel to its end and returns the time that its steps and hits take.
template <class Walker>
sim::Ticks walk(Walker& walker, const walk::PixelPlace& pixel, cost::NodeStatistics& statistics) {
  walk::Cursor cursor;
  cursor.x = pixel.x;
  cursor.y = pixel.y;
  walker.begin_pixel(cursor);
  while (walker.template advance<true>(0, cursor, statistics) != walk::Stop::end) {
    walker.pass(cursor);
  }
  walker.finish_pixel(0, cursor, statistics);
  return cursor.time;
}

template <class Caches>
std::vector<PixelFigures> walk_all(const walk::ReplayInput& input, Caches caches,
                                   std::span<const walk::PixelPlace> pixels) {
  walk::LogWalker<Caches> walker(input, std::move(caches));
  const sim::Ticks hit = walker.ticks().hit;
  std::vector<PixelFigures> figures;
  figures.reserve(pixels.size());
  for (const walk::PixelPlace& pixel : pixels) {
    cost::NodeStatistics first;
    cost::NodeStatistics again;
    const sim::Ticks time = walk(walker, pixel, first);
    (void)walk(walker, pixel, again);
    const std::int64_t misses = first.references.all_misses();
    figures.push_back(
        {sim::add_ticks(time, sim::multiply_ticks(hit, misses)), misses, again.references.all_misses()});
  }
  return figures;
}

}  // namespace

std::vector<PixelFigures> pixel_figures(const program::WorkLog& log, const machine::MachineConfig& config,
                                        std::span<const walk::PixelPlace> pixels, walk::KeptVisits& visits) {
  std::optional<walk::TreePlan> given;
  const machine::MachineConfig one_node = machine::one_node_of(config);
  const memory::Layout layout = walk::layout_of(log, one_node, given);
  sim::ensure(!given, "pixels are walked alone through a given tree");
  const machine::PacketList packets(log.width, log.height, config.packets);
  const std::vector<std::uint32_t> rank = walk::node_ranks(log, one_node);
  walk::ReplayInput input = {log, one_node, layout, packets, rank};
  input.visits = &visits;
  return config.cache.organisation == machine::CacheOrganisation::none
             ? walk_all(input, walk::NoCaches(), pixels)
             : walk_all(input, walk::AnyCaches(one_node), pixels);
}

}  // namespace marti::processors::passes
