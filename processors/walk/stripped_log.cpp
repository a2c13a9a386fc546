#include "processors/walk/stripped_log.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <optional>
#include <utility>

#include "memory/set_tags.h"
#include "processors/machine/packets.h"
#include "processors/walk/log_walker.h"
#include "processors/walk/node_caches.h"
#include "processors/walk/record_places.h"
#include "sim/error.h"

namespace marti::processors {

namespace {

// The line that each set of each cache of one node was last asked for since the packet began.
class Filter {
 public:
  static constexpr bool present = true;
  static constexpr bool by_kind = true;

  explicit Filter(const MachineConfig& config)
      : split_(config.cache.organisation == CacheOrganisation::split) {
    memory::CacheConfig cache = config.cache.cache;
    for (std::size_t i = 0; i < (split_ ? split_caches : 1); ++i) {
      cache.size = split_ ? config.cache.split_sizes[i] : cache.size;
      const std::uint32_t sets = memory::shape_of(cache).sets;
      sets_.emplace_back(sets);
      last_.emplace_back(sets);
    }
  }

  class View {
   public:
    explicit View(Filter& filter) : filter_(filter) {}
    bool access(memory::RecordKind kind, std::uint32_t line) const { return filter_.access(kind, line); }

   private:
    Filter& filter_;
  };
  [[nodiscard]] View view(std::uint32_t /*node*/) { return View(*this); }

  void begin_packet() { ++packet_; }

 private:
  bool access(memory::RecordKind kind, std::uint32_t line) {
    const std::size_t cache = split_ ? split_cache_of[static_cast<std::size_t>(kind)] : 0;
    std::uint64_t& last = last_[cache][sets_[cache](line)];
    // The packet's number distinguishes lines of earlier packets.
    const std::uint64_t now = packet_ << 32U | line;
    return std::exchange(last, now) == now;
  }

  bool split_;
  std::uint64_t packet_ = 0;
  std::vector<memory::SetIndex> sets_;
  std::vector<std::vector<std::uint64_t>> last_;
};

}  // namespace

std::string StrippedLog::key_of(const MachineConfig& config) {
  if (config.scheme != Scheme::image || config.build.sharing != Sharing::given ||
      config.cache.organisation == CacheOrganisation::none || config.contexts > 1 || config.prefetch.on() ||
      config.count.any()) {
    return {};
  }
  std::string key;
  const auto add = [&key](auto number) { key += std::to_string(number) + ' '; };
  const memory::LayoutConfig& layout = config.layout;
  for (const std::uint32_t bytes :
       {layout.node_bytes, layout.entry_bytes, layout.primitive_bytes, layout.quadric_bytes,
        layout.material_bytes, layout.texel_bytes, layout.pixel_bytes, layout.record_alignment,
        layout.section_alignment, config.word_bytes, config.cache.cache.line, config.packets.width,
        config.packets.height}) {
    add(bytes);
  }
  add(static_cast<unsigned>(layout.node_order));
  const OperationCycles& cost = config.operations;
  for (const std::int64_t cycles : {cost.add, cost.multiply, cost.divide, cost.square_root, cost.compare,
                                    cost.integer, cost.load, cost.store, config.cache.hit_cycles}) {
    add(cycles);
  }
  memory::CacheConfig cache = config.cache.cache;
  if (config.cache.organisation == CacheOrganisation::unified) {
    add(memory::shape_of(cache).sets);
    return key;
  }
  for (const std::uint64_t size : config.cache.split_sizes) {
    cache.size = size;
    add(memory::shape_of(cache).sets);
  }
  return key;
}

// Walks packets with the filter in place of the caches. Each host thread has one.
class StrippedLog::Stripper {
 public:
  /// `left`: bytes that all threads together may still write.
  Stripper(const ReplayInput& input, std::atomic<std::int64_t>& left)
      : log_(input.log),
        packets_(input.config.packets),
        line_shift_(static_cast<unsigned>(std::countr_zero(input.config.cache.cache.line))),
        walker_(input, Filter(input.config)),
        left_(left) {}

  void strip(std::uint32_t number, Band& band) {
    const std::uint32_t y0 = number * packets_.height;
    const std::uint32_t y1 = std::min(log_.height, y0 + std::min(packets_.height, log_.height - y0));
    band.begin.resize(std::size_t{y1 - y0} * log_.width);
    for (std::uint32_t x0 = 0; x0 < log_.width && band.fits;) {
      const std::uint32_t x1 = x0 + std::min(packets_.width, log_.width - x0);
      NodeStatistics statistics;
      walker_.caches().begin_packet();
      for (std::uint32_t y = y0; y < y1; ++y) {
        for (std::uint32_t x = x0; x < x1; ++x) {
          band.begin[std::size_t{y - y0} * log_.width + x] = static_cast<std::uint32_t>(band.words.size());
          strip(log_.pixel(x, y), statistics, band);
        }
      }
      PacketTotals& totals = band.totals.emplace_back();
      totals.steps = statistics.steps;
      for (std::size_t kind = 0; kind < memory::record_kinds; ++kind) {
        totals.references[kind] = statistics.references.hits[kind] + statistics.references.misses[kind];
      }
      x0 = x1;
    }
    band.words.shrink_to_fit();
  }

 private:
  void strip(std::span<const std::uint32_t> words, NodeStatistics& statistics, Band& band) {
    Cursor cursor;
    cursor.word = words.data();
    cursor.word_end = words.data() + words.size();
    sim::Ticks since = 0;
    Stop stop = Stop::miss;
    while (band.fits && (stop = walker_.advance<true>(0, cursor, statistics)) == Stop::miss) {
      const memory::Address line = walker_.missed_address(cursor) >> line_shift_;
      put(cursor.time - since, line,
          static_cast<std::uint32_t>(line) << kind_bits |
              static_cast<std::uint32_t>(walker_.missed_kind(cursor)),
          band);
      walker_.pass(cursor);
      spend(cursor, walker_.ticks().hit, 1);
      since = cursor.time;
    }
    put(cursor.time - since, 0, end_of_pixel, band);
  }

  void put(sim::Ticks cycles, memory::Address line, std::uint32_t what, Band& band) {
    constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
    band.fits = band.fits && static_cast<std::uint64_t>(cycles) <= most && line < most_lines &&
                band.words.size() + 2 <= most;
    band.words.push_back(static_cast<std::uint32_t>(cycles));
    band.words.push_back(what);
    // Once `left_` is negative it stays negative, so the order of the bands does not matter.
    if (band.words.size() % counted_words == 0) {
      left_ -= counted_words * sizeof(std::uint32_t);
      band.fits = band.fits && left_ >= 0;
    }
  }

  // The words of a band are subtracted from `left_` in portions of this size.
  static constexpr std::size_t counted_words = 1U << 14U;

  const WorkLog& log_;
  PacketConfig packets_;
  unsigned line_shift_;
  LogWalker<Filter> walker_;
  std::atomic<std::int64_t>& left_;
};

std::unique_ptr<const StrippedLog> StrippedLog::make(const WorkLog& log, const MachineConfig& config,
                                                     std::uint64_t most_bytes) {
  std::string key = key_of(config);
  if (key.empty()) {
    return nullptr;
  }
  // Times are in cycles, and there is nothing behind the caches.
  MachineConfig plain = config;
  plain.clock = sim::Clock::from_period(1);
  plain.placement = Placement::shared;
  plain.l2 = {};
  std::optional<TreePlan> given;
  try {
    const memory::Layout layout = layout_of(log, plain, given);
    const PacketList packets(log.width, log.height, plain.packets);
    const std::vector<std::uint32_t> rank = node_ranks(log, plain);
    const ReplayInput input = {log, plain, layout, packets, rank};
    std::unique_ptr<StrippedLog> stripped(new StrippedLog(log, std::move(key), plain.packets));
    stripped->bands_.resize(log.height / plain.packets.height +
                            (log.height % plain.packets.height != 0 ? 1 : 0));
    std::atomic<std::int64_t> left = static_cast<std::int64_t>(
        std::min<std::uint64_t>(most_bytes, std::numeric_limits<std::int64_t>::max()));
    tbb::enumerable_thread_specific<Stripper> strippers([&] { return Stripper(input, left); });
    tbb::parallel_for(std::size_t{0}, stripped->bands_.size(), [&](std::size_t number) {
      Band& band = stripped->bands_[number];
      band.fits = left >= 0;
      if (band.fits) {
        strippers.local().strip(static_cast<std::uint32_t>(number), band);
      }
    });
    const bool fits = std::all_of(stripped->bands_.begin(), stripped->bands_.end(),
                                  [](const Band& band) { return band.fits; });
    return fits && stripped->bytes_of_words() <= most_bytes ? std::move(stripped) : nullptr;
  } catch (const sim::UserError&) {
    return nullptr;  // a time overflows; the replay itself reports that, with the machine's clock
  }
}

std::uint64_t StrippedLog::bytes_of_words() const {
  std::uint64_t words = 0;
  for (const Band& band : bands_) {
    words += band.words.size();
  }
  return words * sizeof(std::uint32_t);
}

std::uint64_t StrippedLog::references() const {
  return bytes_of_words() / (2 * sizeof(std::uint32_t)) - std::uint64_t{width_} * height_;
}

}  // namespace marti::processors
