#include "memory/dram_config.h"

#include <algorithm>
#include <bit>
#include <string>
#include <utility>

#include "memory/dram_mapping.h"
#include "sim/key_error.h"

namespace marti::memory {

namespace {

constexpr std::array all_times = {
    &DramTiming::bl,        &DramTiming::cl,          &DramTiming::cwl,       &DramTiming::rcd,
    &DramTiming::rcd_write, &DramTiming::rp,          &DramTiming::ras,       &DramTiming::rc,
    &DramTiming::rrd_s,     &DramTiming::rrd_l,       &DramTiming::faw,       &DramTiming::ccd_s,
    &DramTiming::ccd_l,     &DramTiming::ccd_l_write, &DramTiming::ccd_stack, &DramTiming::wr,
    &DramTiming::wtr_s,     &DramTiming::wtr_l,       &DramTiming::rtp,       &DramTiming::ppd,
    &DramTiming::rtw_gap,   &DramTiming::rank_gap,    &DramTiming::refi,      &DramTiming::rfc};
static_assert(sizeof(DramTiming) == all_times.size() * sizeof(std::int64_t));

// Of commands in halves of a cycle.
constexpr DramCommandSteps halves = {.activate = 3, .precharge = 1, .column = 2};

[[noreturn]] void refuse(const char* key, const std::string& reason) { throw sim::KeyError(key, reason); }

void check_counts(const DramConfig& config) {
  const std::array<std::pair<const char*, std::uint32_t>, 8> counts = {
      {{"dram.channels", config.channels},
       {"dram.ranks", config.ranks},
       {"dram.stacks", config.stacks},
       {"dram.bank_groups", config.bank_groups},
       {"dram.banks", config.banks},
       {"dram.rows", config.rows},
       {"dram.row", config.row_bytes},
       {"dram.burst", config.burst_bytes}}};
  for (const auto& [key, count] : counts) {
    if (!std::has_single_bit(count)) {
      refuse(key, "must be a power of two, not " + std::to_string(count));
    }
  }
  constexpr std::uint64_t most_banks = 65536;
  const std::uint64_t banks = std::uint64_t{config.channels} * config.ranks * config.banks_of_rank();
  if (banks > most_banks) {
    refuse("dram.banks", "makes " + std::to_string(banks) + " banks in all channels; at most " +
                             std::to_string(most_banks) + " are simulated");
  }
  if (config.row_bytes < config.burst_bytes) {
    refuse("dram.row", "must be at least one burst, " + std::to_string(config.burst_bytes) + " bytes");
  }
}

void check_timing(const DramConfig& config) {
  const DramTiming& timing = config.timing;
  if (timing.bl == 0) {
    refuse("dram.tbl", "must not be 0");
  }
  // Each rank may have rows to close, and then an access must be possible: from an activation to the next one
  // of the bank.
  const std::int64_t refresh = timing.rfc + std::int64_t{config.ranks} * (timing.rp + 2) + timing.ppd;
  const std::int64_t column = std::max(timing.rtp, std::max(timing.cl, timing.cwl) + timing.bl + timing.wr);
  const std::int64_t access = std::max({timing.rc, timing.ras + timing.rp, timing.faw,
                                        std::max(timing.rcd, timing.rcd_write) + column + timing.rp});
  if (timing.refi > 0 && timing.refi <= refresh + access) {
    refuse("dram.trefi", "must leave time for an access between two refreshes of " +
                             std::to_string(timing.rfc) + " cycles (dram.trfc)");
  }
  if (timing.rrd_l < timing.rrd_s || timing.ccd_l < timing.ccd_s || timing.wtr_l < timing.wtr_s) {
    refuse(timing.rrd_l < timing.rrd_s   ? "dram.trrd_l"
           : timing.ccd_l < timing.ccd_s ? "dram.tccd_l"
                                         : "dram.twtr_l",
           "must not be less than the time for different bank groups");
  }
  if (config.stacks > 1 && timing.ccd_stack < timing.ccd_s) {
    refuse("dram.tccd_stack", "must not be less than the time within a stack");
  }
  if (timing.ccd_s < timing.bl) {
    refuse("dram.tccd_s", "must be at least the " + std::to_string(timing.bl) +
                              " cycles that one burst has the data bus (dram.tbl)");
  }
}

}  // namespace

DramCommandSteps DramConfig::command_steps() const {
  if (!half_cycles) {
    return {activate_cycles, 1, column_cycles};
  }
  const auto whole = [&](std::int64_t length) { return (length + 2 - steps()) / (3 - steps()); };
  return {whole(halves.activate), whole(halves.precharge), whole(halves.column)};
}

DramTiming DramConfig::timing_of_commands() const {
  // In halves of cycles where there are such.
  const std::int64_t parts = half_cycles ? 2 : 1;
  const DramCommandSteps lengths = half_cycles ? halves : DramCommandSteps{activate_cycles, 1, column_cycles};
  DramTiming times = timing;
  times.rc = row_cycle();
  for (const auto member : all_times) {
    times.*member *= parts;
  }
  times.rcd += lengths.activate - lengths.column;
  times.rcd_write += lengths.activate - lengths.column;
  times.rp += lengths.precharge - lengths.activate;
  times.rfc += lengths.precharge - lengths.activate;
  times.ras += lengths.activate - lengths.precharge;
  times.rtp += lengths.column - lengths.precharge;
  times.wr += lengths.column - lengths.precharge;
  for (const auto member : all_times) {
    const std::int64_t part = parts / steps();  // of what a step is
    times.*member = (times.*member + part - 1) / part;
  }
  return times;
}

double DramConfig::peak_bandwidth() const {
  return static_cast<double>(sim::ticks_per_second) * burst_bytes * channels * (pseudo_channels ? ranks : 1) /
         (static_cast<double>(period) * static_cast<double>(timing.bl));
}

void check(const DramConfig& config, std::uint32_t line) {
  check_counts(config);
  check_timing(config);
  const DramMapping mapping(config);
  if (line > mapping.channel_interleave()) {
    refuse("dram.mapping", "one access of " + std::to_string(line) +
                               " bytes must lie in one channel and one row, but these change every " +
                               std::to_string(mapping.channel_interleave()) +
                               " bytes; put column bits below the other fields");
  }
  if (config.queue == 0) {
    refuse("dram.queue", "must not be 0");
  }
}

}  // namespace marti::memory
