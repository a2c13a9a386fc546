#include "processors/passes/hit_times.h"

#include <optional>

#include "processors/walk/log_walker.h"
#include "processors/walk/record_places.h"
#include "sim/error.h"

namespace marti::processors {

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

}  // namespace

std::vector<sim::Ticks> hit_times(const WorkLog& log, const MachineConfig& config,
                                  std::span<const PixelPlace> pixels) {
  std::optional<TreePlan> given;
  const memory::Layout layout = layout_of(log, config, given);
  sim::ensure(!given, "the times of hits are those of a given tree");
  const PacketList packets(log.width, log.height, config.packets);
  const std::vector<std::uint32_t> rank = node_ranks(log, config);
  const ReplayInput input = {log, config, layout, packets, rank};
  LogWalker<HitCaches> walker(input, HitCaches());
  std::vector<sim::Ticks> times;
  times.reserve(pixels.size());
  NodeStatistics statistics;
  for (const PixelPlace& pixel : pixels) {
    Cursor cursor;
    cursor.x = pixel.x;
    cursor.y = pixel.y;
    walker.begin_pixel(cursor);
    (void)walker.advance<true>(0, cursor, statistics);
    walker.finish_pixel(0, cursor, statistics);
    times.push_back(cursor.time);
  }
  return times;
}

}  // namespace marti::processors
