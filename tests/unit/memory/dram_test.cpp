// DRAM channels against a channel that looks at every cycle, against closed forms, and against laws of
// conservation.
#include <gtest/gtest.h>

#include <random>

#include "memory/dram_presets.h"
#include "sim/key_error.h"
#include "tests/support/long_tests.h"
#include "tests/unit/memory/dram_streams.h"
#include "tests/unit/memory/naive_dram.h"

namespace marti::memory {
namespace {

using F = DramField;

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  std::int64_t pick(std::int64_t low, std::int64_t high) {
    return low + static_cast<std::int64_t>(engine_() % static_cast<std::uint64_t>(high - low + 1));
  }

 private:
  std::mt19937_64 engine_;
};

DramTiming random_timing(Random& random) {
  DramTiming t;
  t.bl = random.pick(1, 4);
  t.cl = random.pick(2, 12);
  t.cwl = random.pick(1, t.cl);
  t.rcd = random.pick(1, 12);
  t.rcd_write = random.pick(2, 12);
  t.rp = random.pick(2, 12);
  t.ras = t.rcd + random.pick(0, 12);
  t.rc = t.ras + t.rp + random.pick(-1, 3);
  t.rrd_s = random.pick(1, 6);
  t.rrd_l = t.rrd_s + random.pick(0, 4);
  t.faw = random.pick(4, 40);
  t.ccd_s = t.bl + random.pick(0, 2);
  t.ccd_l = t.ccd_s + random.pick(0, 4);
  t.ccd_l_write = t.ccd_l + random.pick(0, 6);
  t.ccd_stack = t.ccd_s + random.pick(0, 2);
  t.wr = random.pick(1, 12);
  t.wtr_s = random.pick(1, 5);
  t.wtr_l = t.wtr_s + random.pick(0, 5);
  t.rtp = random.pick(1, 8);
  t.ppd = random.pick(1, 4);
  t.rtw_gap = random.pick(0, 3);
  t.rank_gap = random.pick(0, 3);
  t.rfc = random.pick(20, 60);
  t.refi = random.pick(0, 1) == 0 ? 0 : random.pick(200, 600);
  return t;
}

DramConfig random_config(Random& random) {
  DramConfig config;
  config.timing = random_timing(random);
  config.period = random.pick(1, 2000);
  config.ranks = 1U << random.pick(0, 1);
  config.stacks = 1U << random.pick(0, 1);
  config.bank_groups = 1U << random.pick(0, 2);
  config.banks = 1U << random.pick(0, 2);
  config.refresh_after_precharge = random.pick(0, 3) > 0;
  config.rows = 4;
  config.row_bytes = 256;
  config.burst_bytes = 64;
  config.two_command_buses = random.pick(0, 3) == 0;
  config.pseudo_channels = random.pick(0, 3) == 0;
  config.activate_cycles = random.pick(1, 2);
  config.column_cycles = random.pick(1, 2);
  if (config.column_cycles > 1) {
    // A read may take the bus for as long as its data, no longer.
    config.timing.bl = std::max<std::int64_t>(config.timing.bl, 2);
    config.timing.ccd_s = std::max(config.timing.ccd_s, config.timing.bl);
    config.timing.ccd_l = std::max(config.timing.ccd_l, config.timing.ccd_s);
    config.timing.ccd_l_write = std::max(config.timing.ccd_l_write, config.timing.ccd_l);
    config.timing.ccd_stack = std::max(config.timing.ccd_stack, config.timing.ccd_s);
    // Counted from the last cycles of both, an activation comes before its read.
    config.timing.rcd = std::max<std::int64_t>(config.timing.rcd, 2);
  }
  config.policy = random.pick(0, 1) == 0 ? DramPolicy::fcfs : DramPolicy::frfcfs;
  config.page = random.pick(0, 1) == 0 ? DramPage::open : DramPage::closed;
  config.queue = static_cast<std::uint32_t>(random.pick(1, 12));
  config.reorder_cap = static_cast<std::uint32_t>(random.pick(0, 4));
  return config;
}

// Bursts of traffic with pauses. No read is of bytes that wait to be written, which a controller has anyway.
std::vector<test::StreamAccess> random_accesses(Random& random, const DramConfig& config, std::size_t count) {
  const DramMapping mapping(config);
  std::vector<test::StreamAccess> accesses;
  DramCycle now = random.pick(0, 20);
  const std::int64_t pause = random.pick(1, 40);
  const std::int64_t writes = random.pick(0, 5);
  for (std::size_t i = 0; i < count; ++i) {
    test::StreamAccess access;
    access.arrival = now;
    const auto capacity = config.ranks * config.banks_of_rank() * config.rows * config.row_bytes / 128;
    const Address at = static_cast<Address>(random.pick(0, capacity - 1)) * 128;
    access.place = mapping.place(at);
    access.write = random.pick(0, 9) < writes;
    access.address = Address{i} << 20U;
    accesses.push_back(access);
    now += random.pick(0, 2) > 0 ? 0 : random.pick(0, 30) == 0 ? random.pick(0, 1500) : random.pick(0, pause);
  }
  return accesses;
}

void expect_a_look_at_every_cycle(const DramConfig& config, const std::vector<test::StreamAccess>& accesses,
                                  std::int64_t bursts) {
  test::NaiveDram naive(config, accesses, bursts);
  const std::vector<DramService> expected = naive.run();
  const test::StreamResult result = test::run_stream(config, accesses, bursts);
  ASSERT_EQ(result.counts.activations, naive.activations());
  for (std::size_t i = 0; i < accesses.size(); ++i) {
    ASSERT_EQ(result.services[i].first, expected[i].first) << "access " << i;
    ASSERT_EQ(result.services[i].end, expected[i].end) << "access " << i;
  }
  const test::NaiveDram::BusCycles buses = naive.bus_cycles();
  EXPECT_EQ(result.counts.data_busy, buses.data * config.period);
  EXPECT_EQ(result.counts.bus_no_request, buses.no_request * config.period);
  EXPECT_EQ(result.counts.bus_refresh, buses.refresh * config.period);
  EXPECT_EQ(result.counts.bus_rows, buses.rows * config.period);
  EXPECT_EQ(result.counts.bus_turn, buses.turn * config.period);
}

TEST(Dram, AgreesWithALookAtEveryCycle) {
  for (std::uint64_t seed = 0; seed < marti::test::cases(400U) && !HasFailure(); ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const DramConfig config = random_config(random);
    const std::int64_t bursts = random.pick(1, 2);
    expect_a_look_at_every_cycle(config, random_accesses(random, config, 60), bursts);
  }
}

// Between a precharge and its activation a refresh may come, also in a channel that was idle until then. With
// a precharge of no time it comes a cycle later all the same.
TEST(Dram, RefreshesAfterAPrechargeAgreeToo) {
  for (std::uint64_t seed = 4000; seed < 4000 + marti::test::cases(400U) && !HasFailure(); ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    DramConfig config = random_config(random);
    config.policy = DramPolicy::fcfs;
    config.bank_groups = config.banks = 1;
    config.timing.rp = random.pick(0, 1) == 0 ? 0 : random.pick(10, 20);
    config.timing.rc = config.timing.ras + config.timing.rp;
    config.timing.refi = random.pick(150, 250);
    std::vector<test::StreamAccess> accesses = random_accesses(random, config, 60);
    DramCycle later = 0;
    for (test::StreamAccess& access : accesses) {
      later += random.pick(0, 150);
      access.arrival += later;
    }
    expect_a_look_at_every_cycle(config, accesses, 1);
  }
}

TEST(Dram, CountsEveryBurstOnce) {
  for (std::uint64_t seed = 1000; seed < 1000 + marti::test::cases(100U); ++seed) {
    Random random(seed);
    const DramConfig config = random_config(random);
    const std::int64_t bursts = random.pick(1, 2);
    const std::vector<test::StreamAccess> accesses = random_accesses(random, config, 200);
    const test::StreamResult result = test::run_stream(config, accesses, bursts);
    const DramStatistics& counts = result.counts;
    const auto all = static_cast<std::int64_t>(accesses.size()) * bursts;
    EXPECT_EQ(counts.read_bursts + counts.write_bursts, all);
    EXPECT_EQ(counts.row_hits + counts.row_misses + counts.row_conflicts, all);
    EXPECT_EQ(counts.bytes, all * config.burst_bytes);
    EXPECT_EQ(counts.data_busy, all * config.timing.bl * config.period);
    // Little's law as an identity: the time in the queue is what is left of the time until the last data.
    sim::Ticks queued = 0;
    DramCycle last = 0;
    for (std::size_t i = 0; i < accesses.size(); ++i) {
      const DramCycle data = (accesses[i].write ? config.timing.cwl : config.timing.cl) + config.timing.bl;
      EXPECT_GT(result.services[i].first, accesses[i].arrival);
      queued += config.period * (result.services[i].end - data - accesses[i].arrival);
      last = std::max(last, result.services[i].end);
    }
    EXPECT_EQ(counts.queued, queued);
    EXPECT_EQ(
        counts.data_busy + counts.bus_no_request + counts.bus_refresh + counts.bus_rows + counts.bus_turn,
        counts.data_buses * last * config.period);
    EXPECT_LE(counts.refresh_stall, last * config.period);
    EXPECT_EQ(counts.refreshes == 0, config.timing.refi == 0 || last <= config.timing.refi);
  }
}

// A channel that is told when the next access arrives serves what meets no other at once: with the times and
// counts of one that decides command by command.
TEST(Dram, AccessesThatMeetNoOtherAreServedAsAllAre) {
  for (std::uint64_t seed = 2000; seed < 2000 + marti::test::cases(300U); ++seed) {
    Random random(seed);
    DramConfig config = random_config(random);
    config.policy = DramPolicy::frfcfs;
    std::vector<test::StreamAccess> accesses = random_accesses(random, config, 200);
    DramCycle later = 0;
    for (test::StreamAccess& access : accesses) {
      later += random.pick(0, 3) == 0 ? 0 : random.pick(0, 300);
      access.arrival += later;
    }
    const test::StreamResult told = test::run_queued(config, accesses, 1);
    const test::StreamResult step_by_step = test::run_queued(config, accesses, 1, false);
    for (std::size_t i = 0; i < accesses.size(); ++i) {
      ASSERT_EQ(told.services[i].first, step_by_step.services[i].first)
          << "seed " << seed << ", access " << i;
      ASSERT_EQ(told.services[i].end, step_by_step.services[i].end) << "seed " << seed << ", access " << i;
    }
    for (const auto& counter : DramStatistics::counters()) {
      EXPECT_TRUE(counter.value(told.counts) == counter.value(step_by_step.counts))
          << counter.name << ", seed " << seed;
    }
  }
}

// The latency of one access to row 0 of bank 0, after one to this row that was long ago.
DramCycle idle_latency(const DramConfig& config, std::int64_t row_before) {
  std::vector<test::StreamAccess> accesses(row_before < 0 ? 1 : 2);
  if (row_before >= 0) {
    accesses.front().place.row = static_cast<std::uint32_t>(row_before);
  }
  accesses.back().arrival = 1000;
  return test::run_stream(config, accesses).services.back().end - 1000;
}

TEST(Dram, IdleLatenciesAreClosedForms) {
  for (std::size_t preset = 0; preset < dram_preset_names.size(); ++preset) {
    for (const DramPolicy policy : {DramPolicy::fcfs, DramPolicy::frfcfs}) {
      DramConfig config = dram_preset(preset);
      config.policy = policy;
      // From one whole cycle to the next that may have the command.
      const auto cycles = [&](std::int64_t steps) { return (steps + config.steps() - 1) / config.steps(); };
      const DramTiming t = config.timing_of_commands();
      const bool starts_the_clock = policy == DramPolicy::frfcfs && config.data_clock_tail > 0;
      const DramCycle hit = 1 + (starts_the_clock ? 1 : 0) + cycles(t.cl) + cycles(t.bl);
      EXPECT_EQ(idle_latency(config, 0), hit);
      EXPECT_EQ(idle_latency(config, -1), hit + cycles(t.rcd));
      EXPECT_EQ(idle_latency(config, 1), hit + cycles(t.rp) + cycles(t.rcd));
      // An access alone waits for its row and for the command that starts the data clock.
      std::vector<test::StreamAccess> alone(1);
      alone.front().arrival = 1000;
      const DramStatistics counts = test::run_stream(config, alone).counts;
      EXPECT_EQ(counts.bus_rows, cycles(t.rcd) * config.period);
      EXPECT_EQ(counts.bus_turn, starts_the_clock ? config.period : 0);
      EXPECT_EQ(counts.bus_refresh, 0);
      config.page = DramPage::closed;
      // What starts the data clock leaves its row open.
      EXPECT_EQ(idle_latency(config, 0), hit + (starts_the_clock ? 0 : cycles(t.rcd)));
      EXPECT_EQ(idle_latency(config, 1), hit + (starts_the_clock ? cycles(t.rp) : 0) + cycles(t.rcd));
    }
  }
}

double bytes_per_cycle(const DramConfig& config, const std::vector<test::StreamAccess>& accesses) {
  return static_cast<double>(accesses.size()) * config.burst_bytes /
         static_cast<double>(test::run_stream(config, accesses).last_read);
}

TEST(Dram, StreamingReachesThePeakLessRefresh) {
  DramConfig config = dram_preset(0);
  config.mapping = {{F::bank_group}, {F::column}, {F::channel}, {F::rank}, {F::bank}, {F::row}};
  for (const DramPolicy policy : {DramPolicy::fcfs, DramPolicy::frfcfs}) {
    config.policy = policy;
    const double peak = static_cast<double>(config.burst_bytes) / static_cast<double>(config.timing.bl);
    const double refresh = static_cast<double>(config.timing.rfc) / static_cast<double>(config.timing.refi);
    const double reached = bytes_per_cycle(config, test::make_stream(config, {"seq", 0.0, 50000}));
    EXPECT_LE(reached, peak * (1.0 - refresh));
    EXPECT_GE(reached, peak * (1.0 - refresh) * 0.97);  // each row change of all banks leaves a gap
  }
}

TEST(Dram, RandomRowsOfOneBankTakeTheRowCycle) {
  for (std::size_t preset = 0; preset < dram_preset_names.size(); ++preset) {
    DramConfig config = dram_preset(preset);
    config.timing.refi = 0;
    // With closed pages too a row stays open for tRAS, here also where that is the longest time of all.
    const std::int64_t usual = config.timing.ras;
    for (const auto& [page, ras] : {std::pair(DramPage::open, usual), std::pair(DramPage::closed, usual),
                                    std::pair(DramPage::closed, std::int64_t{200})}) {
      config.page = page;
      config.timing.ras = ras;
      std::vector<test::StreamAccess> accesses(1000);
      for (std::size_t i = 0; i < accesses.size(); ++i) {
        accesses[i].place.row = static_cast<std::uint32_t>(i);
      }
      const DramTiming t = config.timing_of_commands();
      const DramCycle cycle = page == DramPage::closed ? t.rc : std::max(t.rc, t.ras + t.rp);
      EXPECT_EQ(test::run_stream(config, accesses).last_read, 999 * cycle + 1 + t.rcd + t.cl + t.bl);
    }
  }
}

TEST(Dram, FourActivationsBindOnlyWhereTheyAreTheNarrowestPart) {
  DramConfig config = dram_preset(0);
  config.timing.refi = 0;
  config.policy = DramPolicy::frfcfs;
  config.page = DramPage::closed;
  // One access to each bank in turn, bank groups by turns, each to a row of its own.
  std::vector<test::StreamAccess> accesses(4000);
  for (std::size_t i = 0; i < accesses.size(); ++i) {
    accesses[i].place.group = i % 4;
    accesses[i].place.bank = static_cast<std::uint32_t>(i % 4 * 4 + i / 4 % 4);
    accesses[i].place.row = static_cast<std::uint32_t>(i);
    accesses[i].address = Address{i} << 20U;
  }
  const auto cycles_of_four = [&](std::int64_t faw) {
    config.timing.faw = faw;
    return static_cast<double>(test::run_stream(config, accesses).last_read) / 1000.0;
  };
  EXPECT_NEAR(cycles_of_four(26), 26.0, 0.1);
  EXPECT_NEAR(cycles_of_four(60), 60.0, 0.1);
  // Then the spacing of activations and of data binds, four times four cycles; and one more, because a read
  // and an activation that fall on one cycle go one after the other.
  EXPECT_NEAR(cycles_of_four(4), 17.0, 0.1);
}

TEST(Dram, ACapBoundsWhatAnAccessWaitsForOthers) {
  DramConfig config = dram_preset(0);
  config.timing.refi = 0;
  config.policy = DramPolicy::frfcfs;
  // A stream of hits in row 0 and, after its first access, one access to row 1 of the same bank.
  std::vector<test::StreamAccess> accesses(400);
  for (std::size_t i = 0; i < accesses.size(); ++i) {
    accesses[i].arrival = static_cast<DramCycle>(i);
    accesses[i].address = Address{i} << 20U;
  }
  accesses[2].place.row = 1;
  config.queue = 64;
  const auto waited = [&](std::uint32_t cap) {
    config.reorder_cap = cap;
    return test::run_stream(config, accesses).services[2].end;
  };
  const DramCycle uncapped = waited(0);
  DramCycle last = 0;
  for (const std::uint32_t cap : {1, 2, 4, 8, 16, 32}) {
    const DramCycle end = waited(cap);
    EXPECT_GE(end, last);
    EXPECT_LE(end, uncapped);
    last = end;
  }
  EXPECT_LT(waited(1), uncapped);
}

TEST(Dram, MappingsPutEveryBitInItsField) {
  DramConfig config = dram_preset(0);
  config.channels = 2;
  config.ranks = 2;
  config.mapping = {{F::column, 2}, {F::channel}, {F::bank_group, 1}, {F::column}, {F::row, 3},
                    {F::rank},      {F::bank},    {F::bank_group},    {F::row}};
  const DramMapping mapping(config);
  EXPECT_EQ(mapping.channel_interleave(), 4U * 64U);
  EXPECT_EQ(mapping.place(Address{1} << 8U).channel, 1U);
  EXPECT_EQ(mapping.place(Address{1} << 9U).group, 1U);
  // Six bits of the burst, two columns, a channel, a bank group, five columns, three rows.
  EXPECT_EQ(mapping.place(Address{7} << 15U).row, 7U);
  EXPECT_EQ(mapping.place(Address{1} << 18U).rank, 1U);
  EXPECT_EQ(mapping.place(Address{1} << 18U).group, 4U);
  EXPECT_EQ(mapping.place(Address{2} << 19U).bank, 2U);
  EXPECT_EQ(mapping.place(Address{1} << 21U).group, 2U);
  EXPECT_EQ(mapping.place(Address{1} << 22U).row, 8U);
}

TEST(Dram, MappingsAreReadAndRefused) {
  EXPECT_EQ(parse_dram_field("bank_group").field, F::bank_group);
  EXPECT_EQ(parse_dram_field("column:3").bits, 3U);
  for (const char* text :
       {"", "columns", "column:", "column:0", "column:33", "column:x", "column:3 ", ":3"}) {
    EXPECT_THROW((void)parse_dram_field(text), sim::UserError) << text;
  }
  const DramConfig good = dram_preset(0);
  EXPECT_NO_THROW(check(good, 64));
  EXPECT_NO_THROW(check(good, 8192));
  const auto refused = [&](const char* key, const auto& change) {
    DramConfig config = good;
    change(config);
    try {
      check(config, 64);
      ADD_FAILURE() << key;
    } catch (const sim::KeyError& error) {
      EXPECT_EQ(error.key(), key) << error.what();
    }
  };
  refused("dram.mapping", [](DramConfig& c) { c.mapping.pop_back(); });
  refused("dram.mapping", [](DramConfig& c) { c.mapping.push_back({F::row, 0}); });
  refused("dram.mapping", [](DramConfig& c) { c.mapping.push_back({F::bank, 3}); });
  refused("dram.mapping", [](DramConfig& c) {
    c.channels = 2;
    c.burst_bytes = 32;
    c.mapping = {{F::channel}, {F::column}, {F::rank}, {F::bank_group}, {F::bank}, {F::row}};
  });
  refused("dram.channels", [](DramConfig& c) { c.channels = 3; });
  refused("dram.row", [](DramConfig& c) { c.row_bytes = 32; });
  refused("dram.trefi", [](DramConfig& c) { c.timing.refi = 433; });
  refused("dram.trefi", [](DramConfig& c) { c.timing.ras = 10'000; });
  refused("dram.trefi", [](DramConfig& c) { c.timing.rcd = 10'000; });
  refused("dram.tccd_l", [](DramConfig& c) { c.timing.ccd_l = 3; });
  refused("dram.tccd_s", [](DramConfig& c) { c.timing.ccd_s = 3; });
  refused("dram.queue", [](DramConfig& c) { c.queue = 0; });
}

TEST(Dram, ALongPauseCostsNoTime) {
  for (const DramPolicy policy : {DramPolicy::fcfs, DramPolicy::frfcfs}) {
    DramConfig config = dram_preset(0);
    config.policy = policy;
    constexpr DramCycle long_pause = DramCycle{1} << 50U;
    std::vector<test::StreamAccess> accesses(2);
    accesses[1].arrival = long_pause;
    accesses[1].address = 64;
    const test::StreamResult result = test::run_stream(config, accesses);
    EXPECT_EQ(result.counts.refreshes, long_pause / config.timing.refi);
    EXPECT_LE(result.services[1].end - long_pause, config.timing.rfc + 37);
  }
}

TEST(Dram, AReadOfWhatWaitsToBeWrittenIsServedFromTheQueue) {
  DramConfig config = dram_preset(0);
  config.policy = DramPolicy::frfcfs;
  std::vector<test::StreamAccess> accesses(2);
  accesses[0].write = true;
  const test::StreamResult result = test::run_stream(config, accesses);
  EXPECT_EQ(result.counts.forwarded, 1);
  EXPECT_EQ(result.services[1].end, 1);
  EXPECT_EQ(result.counts.read_bursts, 0);
}

}  // namespace
}  // namespace marti::memory
