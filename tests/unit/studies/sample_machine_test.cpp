// Samples of packets: which are drawn, what is estimated from them, and whether the intervals hold.
#include "studies/estimate/sample_machine.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <random>
#include <vector>

#include "bench/estimates/allowances.h"
#include "plain_machine.h"
#include "processors/node/packet_schedule.h"
#include "processors/passes/pixel_figures.h"
#include "processors/replay/replay.h"
#include "sim/mix.h"
#include "studies/estimate/sampled_frame.h"
#include "tests/support/random_machine.h"

namespace marti::studies {

using namespace estimate;

namespace {

using processors::machine::MachineConfig;
using processors::machine::PacketList;
using processors::program::Frame;
using processors::program::PixelSet;
using processors::program::WorkLog;

RC_GTEST_PROP(Strata, CoverAllUnitsAndDrawTwoOfEach, (std::uint64_t seed)) {
  test::Random random(seed);
  const auto units = static_cast<std::uint64_t>(test::pick(random, 1, 300));
  const auto count = static_cast<std::uint64_t>(test::pick(random, 1, static_cast<std::int64_t>(units)));
  std::uint64_t next = 0;
  for (const Stratum& stratum : draw_strata(units, count, seed)) {
    RC_ASSERT(stratum.first == next);
    next = stratum.end;
    RC_ASSERT(stratum.chosen.size() == std::min<std::uint64_t>(2, stratum.size()));
    for (std::size_t i = 0; i < stratum.chosen.size(); ++i) {
      RC_ASSERT(stratum.chosen[i] >= stratum.first);
      RC_ASSERT(stratum.chosen[i] < stratum.end);
      if (i != 0) {
        RC_ASSERT(stratum.chosen[i - 1] < stratum.chosen[i]);
      }
    }
    RC_ASSERT(stratum.size() >= units / count);
    RC_ASSERT(stratum.size() <= units / count + 1);
  }
  RC_ASSERT(next == units);
}

RC_GTEST_PROP(Strata, TwiceAsManyKeepAllThatWereDrawn, (std::uint64_t seed)) {
  test::Random random(seed);
  const auto count = static_cast<std::uint64_t>(test::pick(random, 1, 40));
  const auto units =
      static_cast<std::uint64_t>(test::pick(random, static_cast<std::int64_t>(2 * count), 400));
  std::vector<std::uint64_t> some;
  std::vector<std::uint64_t> more;
  for (const Stratum& stratum : draw_strata(units, count, seed)) {
    some.insert(some.end(), stratum.chosen.begin(), stratum.chosen.end());
  }
  for (const Stratum& stratum : draw_strata(units, 2 * count, seed)) {
    more.insert(more.end(), stratum.chosen.begin(), stratum.chosen.end());
  }
  RC_ASSERT(std::includes(more.begin(), more.end(), some.begin(), some.end()));
}

TEST(Strata, DrawEachUnitEquallyOften) {
  constexpr int trials = 3000;
  std::vector<int> drawn(20);
  for (int seed = 0; seed < trials; ++seed) {
    for (const Stratum& stratum : draw_strata(drawn.size(), 2, static_cast<std::uint64_t>(seed))) {
      for (const std::uint64_t unit : stratum.chosen) {
        ++drawn[unit];
      }
    }
  }
  for (const int count : drawn) {
    EXPECT_NEAR(count, trials * 2 / 10, 100);  // some four standard deviations
  }
}

// What a renderer would give of a log: the words of some pixels.
Frame part_of(const WorkLog& log, const PixelSet& only, const Frame* before) {
  auto part = std::make_shared<WorkLog>(log);
  for (std::uint32_t y = 0; y < log.height; ++y) {
    processors::program::LogRow& row = part->rows[y];
    row = {};
    for (std::uint32_t x = 0; x < log.width; ++x) {
      row.begin.push_back(static_cast<std::uint32_t>(row.words.size()));
      const bool traced = only.has(x, y);
      EXPECT_FALSE(traced && before != nullptr && !before->log->pixel(x, y).empty()) << "traced twice";
      if (traced || (before != nullptr && !before->log->pixel(x, y).empty())) {
        const auto words = log.pixel(x, y);
        row.words.insert(row.words.end(), words.begin(), words.end());
      }
    }
    row.begin.push_back(static_cast<std::uint32_t>(row.words.size()));
  }
  Frame frame;
  frame.log = part;
  return frame;
}

SampledFrame sampled_frame(const WorkLog& log) {
  return SampledFrame(log.width, log.height, [&log](const PixelSet& only, const Frame* before) {
    return part_of(log, only, before);
  });
}

RC_GTEST_PROP(Windows, AreCutOfAllPackets, (std::uint64_t seed)) {
  test::Random random(seed);
  const PacketList packets(static_cast<std::uint32_t>(test::pick(random, 1, 60)),
                           static_cast<std::uint32_t>(test::pick(random, 1, 60)), {2, 3});
  const auto length = static_cast<std::uint64_t>(test::pick(random, 1, 100));
  const PacketWindows windows(packets, length, static_cast<std::uint64_t>(test::pick(random, 1, 50)), seed);
  RC_ASSERT(windows.first(0) == 0U);
  RC_ASSERT(windows.end(windows.windows() - 1) == packets.size());
  for (std::uint64_t window = 1; window < windows.windows(); ++window) {
    RC_ASSERT(windows.first(window) == windows.end(window - 1));
    RC_ASSERT(windows.first(window) - windows.first(window - 1) == std::min(length, packets.size()));
  }
  const std::vector<std::uint64_t> chosen = windows.chosen();
  RC_ASSERT(std::is_sorted(chosen.begin(), chosen.end()));
  RC_ASSERT(windows.has_all() == (chosen.size() == packets.size()));
}

// The one of the places that is nearest to `at`, among those that are marked.
std::uint32_t nearest(std::uint32_t at, const std::vector<bool>& marked) {
  std::optional<std::uint32_t> best;
  const auto distance = [at](std::uint32_t place) { return place > at ? place - at : at - place; };
  for (std::uint32_t place = 0; place < marked.size(); ++place) {
    if (marked[place] && (!best || distance(place) < distance(*best))) {
      best = place;
    }
  }
  return *best;
}

RC_GTEST_PROP(Lattice, ExpectsTheTimeOfThePixelNextToEach, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::random_log(random, static_cast<std::uint32_t>(test::pick(random, 1, 30)),
                                       static_cast<std::uint32_t>(test::pick(random, 1, 30)));
  const PixelLattice lattice(log.width, log.height);
  PixelSet set(log.width, log.height);
  lattice.add_to(set);
  std::vector<bool> columns(log.width);
  std::vector<bool> rows(log.height);
  std::vector<double> of_image(std::size_t{log.width} * log.height);
  std::vector<double> times;
  double words_of_lattice = 0.0;
  for (const processors::walk::PixelPlace& pixel : lattice.pixels()) {
    RC_ASSERT(set.has(pixel.x, pixel.y));
    columns[pixel.x] = true;
    rows[pixel.y] = true;
    words_of_lattice += static_cast<double>(log.pixel(pixel.x, pixel.y).size());
    times.push_back(static_cast<double>(test::pick(random, 0, 1000)));
    of_image[std::size_t{pixel.y} * log.width + pixel.x] = times.back();
  }
  RC_ASSERT(set.count() == times.size());
  RC_ASSERT(set.count() == static_cast<std::uint64_t>(std::count(columns.begin(), columns.end(), true) *
                                                      std::count(rows.begin(), rows.end(), true)));
  const PacketList packets(log.width, log.height, {1, 1});
  for (std::uint64_t packet = 0; packet < packets.size(); ++packet) {
    const processors::machine::Packet at = packets[packet];
    // A cell's first column, and row, is as far from the pixel of the cell before.
    if (at.x0 % 8 != 0 && at.y0 % 8 != 0) {
      const std::size_t next = std::size_t{nearest(at.y0, rows)} * log.width + nearest(at.x0, columns);
      RC_ASSERT(times[lattice.next_to(at.x0, at.y0)] == of_image[next]);
    }
  }
  const double words = words_of_lattice / static_cast<double>(set.count()) * log.width * log.height;
  SampledFrame frame = sampled_frame(log);
  (void)frame.with_lattice();
  const double bytes = 4.0 * (words + log.width * log.height);
  RC_ASSERT(std::abs(frame.traced().log_bytes - bytes) <= 1e-9 * bytes);
}

// Images of patches of random sizes, times and places, with noise: the lattice's mean and the image's.
TEST(Lattice, ItsIntervalCoversTheMeanOfTheImage) {
  std::mt19937_64 random(3);
  constexpr std::uint32_t side = 160;
  const PixelLattice lattice(side, side);
  int covered = 0;
  double widest = 0.0;
  constexpr int trials = 200;
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<sim::Ticks> image(side * side);
    double sum = 0.0;
    const std::uint32_t patch = 1 + static_cast<std::uint32_t>(random() % 60);
    const std::uint64_t shift = random() % 60;
    const std::uint64_t salt = random();
    for (std::uint32_t y = 0; y < side; ++y) {
      for (std::uint32_t x = 0; x < side; ++x) {
        const std::uint64_t cell = (x + shift) / patch * 1000 + (y + 2 * shift) / patch;
        const auto time = static_cast<sim::Ticks>(sim::mix(cell ^ salt) % 900 + random() % 300);
        image[y * side + x] = time;
        sum += static_cast<double>(time);
      }
    }
    std::vector<double> times;
    double of_lattice = 0.0;
    for (const processors::walk::PixelPlace& pixel : lattice.pixels()) {
      times.push_back(static_cast<double>(image[pixel.y * side + pixel.x]));
      of_lattice += times.back();
    }
    const double estimate = of_lattice / static_cast<double>(times.size()) * side * side;
    const double half_width = lattice.half_width(times) / estimate;
    covered += std::abs(estimate / sum - 1.0) <= half_width ? 1 : 0;
    widest = std::max(widest, half_width);
  }
  EXPECT_GE(covered, trials * 93 / 100);
  EXPECT_LT(widest, 0.06);  // without patches the spread of 400 pixels would give some 0.045
  EXPECT_TRUE(std::isinf(PixelLattice(3, 3).half_width(std::vector<double>{5.0})));
}

// The log with each pixel twice, side by side.
WorkLog doubled(const WorkLog& log) {
  WorkLog twice = log;
  twice.width = 2 * log.width;
  for (std::uint32_t y = 0; y < log.height; ++y) {
    processors::program::LogRow& row = twice.rows[y];
    row = {};
    for (std::uint32_t x = 0; x < twice.width; ++x) {
      row.begin.push_back(static_cast<std::uint32_t>(row.words.size()));
      const auto words = log.pixel(x / 2, y);
      row.words.insert(row.words.end(), words.begin(), words.end());
    }
    row.begin.push_back(static_cast<std::uint32_t>(row.words.size()));
  }
  return twice;
}

// A machine of one node that traces a frame in which each pixel comes twice, pixel by pixel, has the same
// misses; and its packets' times, without their waits and misses, are those of hits alone.
RC_GTEST_PROP(PixelFigures, AreThoseOfPacketsOfOnePixel, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::random_log(random, 14, 11);
  MachineConfig machine = processors::machine::one_node_of(test::plain_machine(random));
  machine.packets = {1, 1, processors::machine::PacketOrder::scanline};
  const WorkLog twice = doubled(log);
  std::vector<std::uint64_t> all(PacketList(twice.width, twice.height, machine.packets).size());
  std::iota(all.begin(), all.end(), std::uint64_t{0});
  const processors::walk::PacketSample sample(all, all.size(), 0);
  const std::vector<processors::walk::PacketFigures> packets =
      processors::replay::replay(twice, machine, {.sample = &sample}).packet_figures;
  std::vector<processors::walk::PixelPlace> pixels;
  for (std::uint32_t y = 0; y < log.height; ++y) {
    for (std::uint32_t x = 0; x < log.width; ++x) {
      pixels.push_back({x, y});
    }
  }
  const sim::Ticks hit = machine.clock.cycles(machine.cache.hit_cycles);
  processors::walk::KeptVisits visits;
  const std::vector<processors::passes::PixelFigures> figures =
      processors::passes::pixel_figures(log, machine, pixels, visits);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    RC_ASSERT(figures[i].misses == packets[2 * i].misses);
    RC_ASSERT(figures[i].misses_again == packets[2 * i + 1].misses);
    RC_ASSERT(figures[i].hit_time == packets[2 * i].busy + packets[2 * i].misses * hit);
  }
}

// The frame time of a host that hands out packets, and the replay's.
RC_GTEST_PROP(Schedule, OfIndependentPacketsIsTheReplay, (std::uint64_t seed)) {
  test::Random random(seed);
  const processors::program::WorkLog log = test::random_log(random, 12, 10);
  MachineConfig machine = test::plain_machine(random);
  machine.host.occupancy_cycles = test::pick(random, 0, 50);
  machine.interconnect.kind = memory::InterconnectKind::ideal;
  const std::uint64_t packets = processors::machine::PacketList(12, 10, machine.packets).size();
  std::vector<std::uint64_t> all(packets);
  std::iota(all.begin(), all.end(), 0);
  const processors::walk::PacketSample sample(all, packets, 0);
  const processors::replay::MachineResult result =
      processors::replay::replay(log, machine, {.sample = &sample});
  std::vector<sim::Ticks> times;
  for (const processors::walk::PacketFigures& figures : result.packet_figures) {
    times.push_back(figures.time);
  }
  sim::Ticks finish = 0;
  for (const processors::cost::NodeStatistics& node : result.nodes) {
    finish = std::max(finish, node.finish);
  }
  RC_ASSERT(processors::node::schedule_packets(machine.host, machine.nodes, times) == finish);
}

SampledRun estimate_by_sample(const WorkLog& log, const MachineConfig& machine, const PacketWindows& windows,
                              const PixelLattice& lattice) {
  processors::walk::KeptVisits visits;
  const LatticeWork work(log, machine, lattice, windows.packets(), visits);
  return with_one_node(sample_machine(log, machine, windows, work, visits), log, machine, windows, work,
                       visits);
}

RC_GTEST_PROP(Sample, OfEverythingIsExact, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::random_log(random, 12, 10);
  const MachineConfig machine = test::plain_machine(random);
  const MachineFigures exact = figures_of(machine, processors::replay::replay(log, machine));
  const PacketList packets(log.width, log.height, machine.packets);
  const MachineConfig one = processors::machine::one_node_of(machine);
  const double alone = figures_of(one, processors::replay::replay(log, one))[Figure::end];
  for (const std::uint64_t length : {packets.size(), (packets.size() + 1) / 2}) {
    const PacketWindows windows(packets, length, 1, seed);
    const SampledRun run = estimate_by_sample(log, machine, windows, PixelLattice(log.width, log.height));
    for (const Figure figure : {Figure::end, Figure::misses, Figure::use, Figure::wait}) {
      RC_ASSERT(run.machine.value[figure] == exact[figure]);
    }
    RC_ASSERT(run.machine.value[Figure::speed_up] == alone / exact[Figure::end]);
    RC_ASSERT(run.machine.half_width == MachineFigures());
  }
}

// Samples that grow trace each pixel once, and have the words of the pixels that they traced and no others.
RC_GTEST_PROP(Sample, TracesWhatItNeedsOnce, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::random_log(random, 40, 24, 10);
  const PacketList packets(log.width, log.height, {2, 2});
  SampledFrame frame = sampled_frame(log);
  PixelSet wanted(log.width, log.height);
  frame.lattice().add_to(wanted);
  for (const std::uint64_t strata : {2, 4, 8}) {
    const PacketWindows windows(packets, 8, strata, seed);
    windows.add_to(wanted);
    const double share = frame.share_with(windows);
    const WorkLog& part = frame.with(windows);
    RC_ASSERT(frame.traced().pixels == share);
    RC_ASSERT(share == static_cast<double>(wanted.count()) / (40.0 * 24.0));
    for (std::uint32_t y = 0; y < log.height; ++y) {
      for (std::uint32_t x = 0; x < log.width; ++x) {
        RC_ASSERT(part.pixel(x, y).size() == (wanted.has(x, y) ? log.pixel(x, y).size() : 0U));
      }
    }
  }
  const Frame whole = std::move(frame).whole();
  for (std::size_t y = 0; y < log.rows.size(); ++y) {
    RC_ASSERT(whole.log->rows[y].words == log.rows[y].words);
  }
}

// Of half of the packets the machine's time and misses depend on those and on the lattice alone.
RC_GTEST_PROP(Sample, DoesNotLookAtOtherPixels, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::random_log(random, 40, 24, 10);
  MachineConfig machine = test::plain_machine(random);
  machine.packets = {2, 2};
  const PacketWindows windows(PacketList(log.width, log.height, machine.packets), 8, 4, seed);
  SampledFrame frame = sampled_frame(log);
  const SampledRun run = estimate_by_sample(frame.with(windows), machine, windows, frame.lattice());
  // Words anywhere else change what caches are warmed with, but not what the windows do.
  const SampledRun whole = estimate_by_sample(log, machine, windows, frame.lattice());
  RC_ASSERT(run.machine.references == whole.machine.references);
  RC_ASSERT(std::isfinite(run.machine.value[Figure::end]));
}

// One node: only the error of sampling is left, which the interval covers.
TEST(Sample, IntervalsOfManySeedsCoverTheTruth) {
  test::Random random(5);
  const WorkLog log = test::random_log(random, 64, 64, 20);
  MachineConfig machine = test::plain_machine(random);
  machine.packets = {2, 2, processors::machine::PacketOrder::scanline};
  machine.nodes = 1;
  const MachineFigures exact = figures_of(machine, processors::replay::replay(log, machine));
  const PacketList packets(log.width, log.height, machine.packets);
  for (const std::uint64_t strata : {8, 16}) {
    int times = 0;
    int misses = 0;
    constexpr int trials = 100;
    for (int seed = 0; seed < trials; ++seed) {
      const PacketWindows windows(packets, 16, strata, static_cast<std::uint64_t>(seed));
      SampledFrame frame = sampled_frame(log);
      const Estimate estimate =
          estimate_by_sample(frame.with(windows), machine, windows, frame.lattice()).machine;
      const auto holds = [&](Figure figure) {
        return std::abs(bench::error_of(figure, estimate.value[figure], exact[figure])) <=
               estimate.half_width[figure];
      };
      times += holds(Figure::end) ? 1 : 0;
      misses += holds(Figure::misses) ? 1 : 0;
    }
    EXPECT_GE(times, 90) << strata;
    EXPECT_GE(misses, 90) << strata;
  }
}

}  // namespace
}  // namespace marti::studies
