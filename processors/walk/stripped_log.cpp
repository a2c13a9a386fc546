#include "processors/walk/stripped_log.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <optional>
#include <utility>

#include "memory/policies.h"
#include "memory/recency_lists.h"
#include "processors/machine/packets.h"
#include "processors/walk/kept_visits.h"
#include "processors/walk/log_walker.h"
#include "processors/walk/node_caches.h"
#include "processors/walk/record_places.h"
#include "sim/error.h"

namespace marti::processors::walk {

// Writes a row of packets of the stripped log for caches of so many ways.
class StrippedLog::BandWriter {
 public:
  explicit BandWriter(std::uint32_t ways) : ways_(ways) {}

  void begin_band(Band& band) {
    band_ = &band;
    words_.clear();
    at_end_.clear();
    excess_ = 0;
    bytes_ = 0;
  }

  [[nodiscard]] std::uint32_t ways() const { return ways_; }

  void begin_pixel() { since_ = 0; }
  /// A reference that stays, at `time`, which takes until `end`. Since its line was asked for last, or since
  /// the packet began, the packet has asked for `others` lines of its set.
  [[gnu::always_inline]] void refer(sim::Ticks time, sim::Ticks end, std::uint32_t what,
                                    std::uint32_t others) {
    put(time - since_, ways_ != 0 && others >= ways_ ? what | sure_miss : what);
    since_ = end;
  }
  void end_pixel(sim::Ticks time) { put(time - since_, end_of_pixel); }

  void ask_at_end(std::uint32_t what) { at_end_.push_back(what); }
  void end_packet() {
    excess_ |= (std::uint64_t{words_.size()} | at_end_.size()) >> 32U;
    band_->places.push_back(
        {static_cast<std::uint32_t>(words_.size()), static_cast<std::uint32_t>(at_end_.size())});
  }

  /// Bytes written since the last call.
  [[nodiscard]] std::int64_t take_bytes() {
    const std::size_t bytes = words_.size() * sizeof(words_[0]) + at_end_.size() * sizeof(at_end_[0]);
    return static_cast<std::int64_t>(bytes - std::exchange(bytes_, bytes));
  }
  // The words are written into tables that are kept from band to band, and copied at their exact size.
  // `bands`: the number of all bands of the log.
  void end_band(bool fits, std::size_t bands) {
    band_->fits = fits && excess_ == 0;
    if (band_->fits) {
      band_->words = all_words_.copy(words_, bands);
      band_->at_end = all_at_end_.copy(at_end_, bands);
    }
  }
  /// Gives the log the words of all its bands that were written here.
  void give_words(StrippedLog& log) {
    log.words_.merge(std::move(all_words_));
    log.at_end_.merge(std::move(all_at_end_));
  }

 private:
  [[gnu::always_inline]] void put(sim::Ticks cycles, std::uint32_t what) {
    excess_ |= static_cast<std::uint64_t>(cycles) >> 32U;
    words_.push_back(std::uint64_t{what} << 32U | static_cast<std::uint32_t>(cycles));
  }

  std::uint32_t ways_;
  Band* band_ = nullptr;
  sim::LargeVector<std::uint64_t> words_;  // of this band
  sim::LargeVector<std::uint32_t> at_end_;
  sim::LargeBlocks<std::uint64_t> all_words_;  // of all bands
  sim::LargeBlocks<std::uint32_t> all_at_end_;
  sim::Ticks since_ = 0;      // the end of the last reference that was kept
  std::uint64_t excess_ = 0;  // not 0 once something has not fitted into 32 bits
  std::size_t bytes_ = 0;
};

// In place of one node's caches: the lines that each set was asked for last since the packet began, at least
// as many as the caches with the most ways hold. References that stay in a stripped log go to its writer.
template <std::uint32_t Depth, bool Split>
class StrippedLog::PacketCaches {
 public:
  static constexpr bool present = true;
  static constexpr bool by_kind = Split;
  static constexpr bool records = true;

  /// References to the first `taken_out` lines of a set's list are taken out of all stripped logs.
  PacketCaches(const machine::MachineConfig& config, std::uint32_t taken_out)
      : taken_out_(taken_out), hit_(config.cache.hit_cycles) {
    for (const machine::FirstLevelCache& first : machine::first_level_caches(config.cache)) {
      lists_.emplace_back(memory::shape_of(first.cache).sets);
    }
  }

  class View {
   public:
    explicit View(PacketCaches& all) : all_(all) {}
    [[gnu::always_inline]] bool access(memory::RecordKind kind, std::uint32_t line) const {
      memory::RecencyLists<Depth>& lists = all_.lists_[number_of(kind)];
      if (lists.newest(line)) {
        return true;  // to move it changes nothing
      }
      all_.last_ = lists.touch(line);
      return all_.last_ < all_.taken_out_;
    }

   private:
    PacketCaches& all_;
  };
  [[nodiscard]] View view(std::uint32_t /*node*/) { return View(*this); }

  /// Writes the reference for which access() has just returned false; returns its end. Not inlined, because
  /// with four ways and more it is rare, and the loop that calls it would be slower.
  [[gnu::noinline]] sim::Ticks record(sim::Ticks time, memory::RecordKind kind, std::uint32_t line) {
    const bool again = last_ < Depth;
    const std::uint32_t others = again ? last_ : lists_[number_of(kind)].lines_before();
    const sim::Ticks end = sim::add_ticks(time, hit_);
    for (BandWriter& writer : writers) {
      if (again && others < writer.ways()) {
        break;  // a hit for these ways and for more
      }
      writer.refer(time, end, line << what_bits | static_cast<std::uint32_t>(kind), others);
    }
    return end;
  }

  /// While a packet was walked, each set's list got a line at its first reference. At the packet's end a
  /// cache's tags must be in the order of last references. So where a set has several lines, those that the
  /// caches still hold are referred to once more in that order.
  void end_packet() {
    for (std::size_t number = 0; number < caches; ++number) {
      const auto* const kind = std::find(split_cache_of.begin(), split_cache_of.end(), number);
      const auto what = static_cast<std::uint32_t>(kind - split_cache_of.begin());
      lists_[number].for_each_touched(
          [&](const std::uint32_t* lines, std::uint32_t held, std::uint32_t inserted) {
            for (BandWriter& writer : writers) {
              for (std::uint32_t place = inserted == 1 ? 0 : std::min(held, writer.ways()); place-- > 0;) {
                writer.ask_at_end(lines[place] << what_bits | what);
              }
            }
          });
      lists_[number].clear();
    }
    for (BandWriter& writer : writers) {
      writer.end_packet();
    }
  }

  std::vector<BandWriter> writers;  ///< one for each stripped log, in ascending order of their ways

 private:
  static constexpr std::size_t caches = Split ? machine::split_caches : 1;

  static std::size_t number_of(memory::RecordKind kind) {
    return Split ? split_cache_of[static_cast<std::size_t>(kind)] : 0;
  }

  std::uint32_t taken_out_;
  sim::Ticks hit_;
  // Place in its set's list of the line that was asked for last without being its set's newest.
  std::uint32_t last_ = 0;
  std::vector<memory::RecencyLists<Depth>> lists_;
};

std::string StrippedLog::key_of(const machine::MachineConfig& config) {
  if (config.scheme != machine::Scheme::image || config.build.sharing != machine::Sharing::given ||
      config.cache.organisation == machine::CacheOrganisation::none || config.contexts > 1 ||
      config.prefetch.on() || config.kind == machine::NodeKind::simt || config.count.any()) {
    return {};
  }
  // A stripped log leaves out that a line is asked for twice in a row.
  if (config.cache.cache.ways != 1 &&
      memory::with_policy(config.cache.cache.replacement, []<memory::Replacement Policy>() {
        return memory::VictimsOf<Policy>::counts_repeats;
      })) {
    return {};
  }
  std::string key;
  const auto add = [&key](auto number) { key += std::to_string(number) + ' '; };
  const memory::LayoutConfig& layout = config.layout;
  for (const std::uint32_t bytes :
       {layout.node_bytes, layout.entry_bytes, layout.primitive_bytes, layout.quadric_bytes,
        layout.material_bytes, layout.texel_bytes, layout.pixel_bytes, layout.transform_bytes,
        layout.record_alignment, layout.section_alignment, config.word_bytes, config.cache.cache.line,
        config.packets.width, config.packets.height}) {
    add(bytes);
  }
  add(static_cast<unsigned>(layout.node_order));
  if (layout.node_order == memory::NodeOrder::treelets) {
    add(layout.treelet_bytes);
  }
  const machine::OperationCycles& cost = config.operations;
  for (const std::int64_t cycles : {cost.add, cost.multiply, cost.divide, cost.square_root, cost.compare,
                                    cost.integer, cost.load, cost.store, config.cache.hit_cycles}) {
    add(cycles);
  }
  for (const machine::FirstLevelCache& first : machine::first_level_caches(config.cache)) {
    add(memory::shape_of(first.cache).sets);
  }
  return key;
}

std::uint32_t StrippedLog::ways_of(const machine::MachineConfig& config) {
  const memory::CacheConfig& cache = config.cache.cache;
  if (cache.ways == memory::full_ways || cache.ways > most_ways) {
    return 0;
  }
  // With one way all replacements do the same.
  return cache.replacement == memory::Replacement::lru || cache.ways == 1 ? cache.ways : 0;
}

// Walks packets with PacketCaches in place of a node's caches. Each host thread has one.
template <class Caches>
class StrippedLog::Stripper {
 public:
  /// Writes `logs`, which are in ascending order of their ways. `left`: bytes that all threads together may
  /// still write.
  Stripper(const ReplayInput& input, std::span<const std::shared_ptr<StrippedLog>> logs,
           std::atomic<std::int64_t>& left, sim::WorkMeter* meter)
      : log_(input.log),
        packets_(input.config.packets),
        walker_(input, Caches(input.config, std::max(1U, logs.front()->ways_))),
        logs_(logs),
        left_(left),
        meter_(meter) {
    for (const auto& each : logs) {
      walker_.caches().writers.emplace_back(each->ways_);
    }
  }

  /// Strips row `number` of packets.
  void strip(std::uint32_t number, std::vector<PacketTotals>& totals) {
    Caches& caches = walker_.caches();
    for (std::size_t i = 0; i < logs_.size(); ++i) {
      caches.writers[i].begin_band(logs_[i]->bands_[number]);
    }
    totals.reserve((log_.width - 1) / packets_.width + 1);
    const std::uint32_t y0 = number * packets_.height;
    const std::uint32_t y1 = y0 + std::min(packets_.height, log_.height - y0);
    bool fits = true;
    for (std::uint32_t x0 = 0; x0 < log_.width && fits;) {
      const std::uint32_t x1 = x0 + std::min(packets_.width, log_.width - x0);
      cost::NodeStatistics statistics;
      Cursor cursor;
      for (cursor.y = y0; cursor.y < y1 && fits; ++cursor.y) {
        for (cursor.x = x0; cursor.x < x1 && fits; ++cursor.x) {
          fits = strip_pixel(caches, cursor, statistics);
        }
      }
      PacketTotals& sum = totals.emplace_back();
      sum.steps = statistics.steps;
      for (std::size_t kind = 0; kind < memory::record_kinds; ++kind) {
        sum.references[kind] = statistics.references.hits[kind] + statistics.references.misses[kind];
      }
      caches.end_packet();
      count_step(meter_);
      x0 = x1;
    }
    for (BandWriter& writer : caches.writers) {
      writer.end_band(fits, logs_[0]->bands_.size());
    }
  }

  /// Gives the logs the words that were written here.
  void give_words() {
    for (std::size_t i = 0; i < logs_.size(); ++i) {
      walker_.caches().writers[i].give_words(*logs_[i]);
    }
  }

 private:
  // False when the memory is used up.
  bool strip_pixel(Caches& caches, Cursor& cursor, cost::NodeStatistics& statistics) {
    for (BandWriter& writer : caches.writers) {
      writer.begin_pixel();
    }
    cursor.time = 0;
    walker_.begin_pixel(cursor);
    (void)walker_.template advance<true>(0, cursor, statistics);
    std::int64_t bytes = 0;
    for (BandWriter& writer : caches.writers) {
      writer.end_pixel(cursor.time);
      bytes += writer.take_bytes();
    }
    // Once it is negative it stays so: the order of the bands does not matter.
    return (left_ -= bytes) >= 0;
  }

  const program::WorkLog& log_;
  machine::PacketConfig packets_;
  LogWalker<Caches> walker_;
  std::span<const std::shared_ptr<StrippedLog>> logs_;
  std::atomic<std::int64_t>& left_;
  sim::WorkMeter* meter_;
};

// A word of the log may stand for many references: that a ray visits a leaf, for those of all its primitives.
// Where hardly any of them are taken out, the words of one stripped log take more than this, and it saves too
// little time for its memory. One for 1 KiB of direct-mapped caches takes 3.5 times the log of an octree.
static std::uint64_t most_that_pay(const program::WorkLog& log) {
  constexpr std::uint64_t few = std::uint64_t{64} << 20U;
  constexpr std::uint64_t times = 8;
  std::uint64_t words = 0;
  for (const program::LogRow& row : log.rows) {
    words += row.words.size();
  }
  return few + times * words * sizeof(std::uint32_t);
}

std::vector<std::shared_ptr<const StrippedLog>> StrippedLog::make(const program::WorkLog& log,
                                                                  const machine::MachineConfig& config,
                                                                  std::span<const std::uint32_t> ways,
                                                                  std::uint64_t most_bytes,
                                                                  sim::WorkMeter* meter) {
  sim::ensure(!ways.empty() && *std::max_element(ways.begin(), ways.end()) <= most_ways,
              "a log is stripped for no ways, or for too many");
  std::vector<std::shared_ptr<const StrippedLog>> made(ways.size());
  const std::string key = key_of(config);
  if (key.empty()) {
    return made;
  }
  // Times are in cycles, and there is nothing behind the caches.
  machine::MachineConfig plain = config;
  plain.clock = sim::Clock::from_period(1);
  plain.placement = machine::Placement::shared;
  plain.l2 = {};
  std::optional<TreePlan> given;
  try {
    const memory::Layout layout = layout_of(log, plain, given);
    const machine::PacketList packets(log.width, log.height, plain.packets);
    if (layout.end() / plain.cache.cache.line >= most_lines) {
      return made;
    }
    const std::uint64_t fixed = packets.size() * (sizeof(PacketTotals) + ways.size() * sizeof(Place));
    if (fixed > most_bytes) {
      return made;
    }
    most_bytes -= fixed;
    const std::vector<std::uint32_t> rank = node_ranks(log, plain);
    ReplayInput input = {log, plain, layout, packets, rank};
    KeptVisits visits;
    (void)visits.of(input);  // before threads ask for them
    input.visits = &visits;
    const std::size_t bands =
        log.height / plain.packets.height + (log.height % plain.packets.height != 0 ? 1 : 0);
    std::vector<std::shared_ptr<StrippedLog>> logs;
    for (const std::uint32_t each : ways) {
      logs.emplace_back(new StrippedLog(log, key, each, plain.packets))->bands_.resize(bands);
    }
    std::vector<std::shared_ptr<StrippedLog>> ascending = logs;
    std::ranges::stable_sort(ascending, {}, [](const auto& each) { return each->ways_; });
    const auto totals = std::make_shared<Totals>(bands);
    most_bytes = std::min(most_bytes, ways.size() * most_that_pay(log));
    std::atomic<std::int64_t> left = static_cast<std::int64_t>(
        std::min<std::uint64_t>(most_bytes, std::numeric_limits<std::int64_t>::max()));
    const auto strip_with = [&]<class Caches>() {
      tbb::enumerable_thread_specific<Stripper<Caches>> strippers(
          [&] { return Stripper<Caches>(input, ascending, left, meter); });
      tbb::parallel_for(std::size_t{0}, bands, [&](std::size_t number) {
        const bool fits = left >= 0;
        for (const std::shared_ptr<StrippedLog>& each : logs) {
          each->bands_[number].fits = fits;
        }
        if (fits) {
          strippers.local().strip(static_cast<std::uint32_t>(number), (*totals)[number]);
        }
      });
      for (Stripper<Caches>& stripper : strippers) {
        stripper.give_words();
      }
    };
    const std::uint32_t deepest = *std::max_element(ways.begin(), ways.end());
    if (config.cache.organisation == machine::CacheOrganisation::split) {
      strip_with.operator()<PacketCaches<most_ways, true>>();
    } else if (deepest <= 4) {
      strip_with.operator()<PacketCaches<4, false>>();
    } else if (deepest <= 8) {
      strip_with.operator()<PacketCaches<8, false>>();
    } else {
      strip_with.operator()<PacketCaches<most_ways, false>>();
    }
    std::uint64_t bytes = 0;
    bool fits = true;
    for (const std::shared_ptr<StrippedLog>& each : logs) {
      bytes += each->bytes_of_words();
      fits = fits && std::all_of(each->bands_.begin(), each->bands_.end(),
                                 [](const Band& band) { return band.fits; });
      each->totals_ = totals;
    }
    if (fits && bytes <= most_bytes) {
      std::copy(logs.begin(), logs.end(), made.begin());
    }
  } catch (const sim::UserError&) {
    // The machine cannot be replayed, or a time overflows; the replay itself reports that.
  }
  return made;
}

std::shared_ptr<const StrippedLog> StrippedLog::make(const program::WorkLog& log,
                                                     const machine::MachineConfig& config,
                                                     std::uint64_t most_bytes, sim::WorkMeter* meter) {
  const std::uint32_t ways = ways_of(config);
  return make(log, config, std::span(&ways, 1), most_bytes, meter).front();
}

std::uint64_t StrippedLog::bytes_of_words() const {
  std::uint64_t bytes = 0;
  for (const Band& band : bands_) {
    bytes += band.words.size() * sizeof(band.words[0]) + band.at_end.size() * sizeof(band.at_end[0]);
  }
  return bytes;
}

std::uint64_t StrippedLog::references() const {
  std::uint64_t words = 0;
  for (const Band& band : bands_) {
    words += band.words.size();
  }
  return words - std::uint64_t{width_} * height_;
}

}  // namespace marti::processors::walk
