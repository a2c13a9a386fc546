#include "processors/passes/pixel_figures.h"

#include <optional>
#include <utility>

#include "processors/walk/log_walker.h"
#include "processors/walk/node_caches.h"
#include "processors/walk/record_places.h"
#include "sim/error.h"

namespace marti::processors::passes {

namespace {

struct HitCaches {
  static constexpr bool present = true;
  static constexpr bool by_kind = false;
  struct View {
    [[gnu::always_inline]] static bool access(memory::RecordKind /*kind*/, std::uint32_t /*line*/) {
      return true;
    }
  };
  [[nodiscard]] static View view(std::uint32_t /*node*/) { return {}; }
};

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
void count_misses(const walk::ReplayInput& input, Caches caches, std::span<const walk::PixelPlace> pixels,
                  std::vector<PixelFigures>& figures) {
  walk::LogWalker<Caches> walker(input, std::move(caches));
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    for (std::int64_t PixelFigures::*const misses : {&PixelFigures::misses, &PixelFigures::misses_again}) {
      cost::NodeStatistics statistics;
      (void)walk(walker, pixels[i], statistics);
      figures[i].*misses = statistics.references.all_misses();
    }
  }
}

}  // namespace

std::vector<PixelFigures> pixel_figures(const program::WorkLog& log, const machine::MachineConfig& config,
                                        std::span<const walk::PixelPlace> pixels) {
  std::optional<walk::TreePlan> given;
  const machine::MachineConfig one_node = machine::one_node_of(config);
  const memory::Layout layout = walk::layout_of(log, one_node, given);
  sim::ensure(!given, "pixels are walked alone through a given tree");
  const machine::PacketList packets(log.width, log.height, config.packets);
  const std::vector<std::uint32_t> rank = walk::node_ranks(log, one_node);
  // Few pixels are walked, so planning all visits of the tree would take longer than walking without a plan.
  constexpr bool step_by_step = true;
  const walk::ReplayInput input = {log, one_node, layout, packets, rank, step_by_step};
  std::vector<PixelFigures> figures(pixels.size());
  walk::LogWalker<HitCaches> walker(input, HitCaches());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    cost::NodeStatistics unused;
    figures[i].hit_time = walk(walker, pixels[i], unused);
  }
  if (config.cache.organisation == machine::CacheOrganisation::none) {
    count_misses(input, walk::NoCaches(), pixels, figures);
  } else {
    count_misses(input, walk::AnyCaches(one_node), pixels, figures);
  }
  return figures;
}

}  // namespace marti::processors::passes
